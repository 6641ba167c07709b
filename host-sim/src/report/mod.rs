//! Reports on a mission: text for people, a trace for programs, a figure to look at, and a page to step through.

mod axes;
pub mod bands;
pub mod campaign;
pub mod comparison;
pub mod curves;
mod diagnosis;
pub mod examples;
pub mod flat;
pub(crate) mod front;
pub mod fronts;
pub mod ground;
#[cfg(not(target_family = "wasm"))]
pub mod live;
#[cfg(not(target_family = "wasm"))]
pub mod log;
pub(crate) mod look;
mod map;
pub mod on_map;
pub mod page;
pub mod paper;
pub mod patches;
pub mod picture;
pub mod pieces;
mod placing;
pub mod reference;
mod shapes;
mod sheet;
pub(crate) mod style;
pub mod table;
pub mod text;
