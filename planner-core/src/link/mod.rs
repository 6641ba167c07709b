//! A mission whose planner and vehicle are apart: the chip plans, and the vehicle at the other end of a wire moves and
//! senses.
//!
//! | module | contains |
//! | --- | --- |
//! | [`message`] | what the two ends say to each other |
//! | [`frame`] | how a message goes over a wire |
//! | [`delivery`] | how a message is delivered exactly once |
//! | [`station`] | the chip's side of a mission |

#[cfg(feature = "charts")]
mod chart;
pub mod delivery;
pub mod frame;
pub mod message;
mod setup;
pub mod station;
