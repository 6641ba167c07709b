//! Budgets: what the planner takes of a chip, measured, beside what it may take.

pub mod footprint;
pub mod hardest;
pub mod readme;
pub mod table;
pub mod timing;
pub mod tolerance;
pub mod workload;
