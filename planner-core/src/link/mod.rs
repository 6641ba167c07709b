//! A mission whose planner and vehicle are apart: the chip plans, the vehicle at the other end of a wire
//! moves and senses.
//!
//! What they say to each other is in [`message`], how it goes over a wire in [`frame`], how it is
//! delivered exactly once in [`delivery`], and the chip's side of a mission in [`station`].

pub mod delivery;
pub mod frame;
pub mod message;
pub mod station;
