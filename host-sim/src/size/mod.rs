//! The flash, RAM and time that a planner needs on a chip, from committed measurements.

pub mod configuration;
pub mod measurements;
