//! What is told of a mission: text for people, a trace for programs, a figure to look at,
//! a page to step through.

pub mod bands;
pub mod campaign;
pub mod comparison;
pub mod examples;
pub mod figure;
pub mod flat;
pub mod ground;
pub mod legend;
pub mod log;
pub mod page;
pub mod picture;
pub mod style;
pub mod table;
pub mod text;
pub mod trace;
