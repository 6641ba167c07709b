//! Many missions over standard fields, on all cores, and what they come to.

pub mod ensemble;
pub mod noisy;
pub mod standard_field;
