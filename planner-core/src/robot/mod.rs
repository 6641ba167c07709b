//! The robot itself.
//!
//! - [`hal`]: the traits that its drive and its sensor implement.
//! - [`body`]: the two together.
//! - [`agent`]: the loop that joins a body to a planner.
//! - [`asynchronous`]: the same for drivers that are awaited.
//! - [`threshold`]: a sensor on a measured quantity.

pub mod agent;
pub mod asynchronous;
pub mod body;
pub mod hal;
pub mod threshold;
