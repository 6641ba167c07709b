//! What is told of a mission: text for people, a trace for programs, a figure to look at.

pub mod figure;
pub mod legend;
pub mod text;
pub mod trace;
