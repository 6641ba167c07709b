//! Reports on a mission: text for people, a trace for programs, a figure to look at, and a page to step through.

mod axes;
pub mod bands;
pub mod campaign;
pub mod comparison;
pub mod curves;
mod diagnosis;
pub mod examples;
pub mod figure;
pub mod flat;
mod front;
pub mod ground;
pub mod log;
mod look;
mod map;
mod numbers;
pub mod page;
pub mod paper;
pub mod picture;
mod placing;
pub mod reference;
pub mod ribbon;
mod shapes;
mod sheet;
mod style;
pub mod table;
pub mod text;
pub mod trace;
