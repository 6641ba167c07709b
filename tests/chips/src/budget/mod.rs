//! Budgets: what programs take of a core, measured, beside what they may take.

pub mod book;
pub mod dearest;
pub mod footprint;
pub mod timing;
pub mod workload;
