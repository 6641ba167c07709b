//! What is really there: the true line, what a place reads, and shapes in metres.

pub mod polygon;
pub mod truth;
