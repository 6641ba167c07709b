//! What a planner takes of a chip, from what was measured and committed.

pub mod configuration;
pub mod measurements;
