//! What is told of a mission: text for people, a trace for programs, a figure to look at.

pub mod campaign;
pub mod comparison;
pub mod examples;
pub mod figure;
pub mod legend;
pub mod picture;
pub mod reference;
pub mod style;
pub mod table;
pub mod text;
pub mod trace;
