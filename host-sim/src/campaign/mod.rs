//! Many missions over standard fields, on all cores, and what they come to.

pub mod accuracy;
pub mod calibration;
pub mod ensemble;
pub mod spread;
pub mod standard_field;
