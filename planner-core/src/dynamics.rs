//! Your own dynamics: which motions there are from a pose.
//!
//! Implement [`Pivots`] for a vehicle that turns on the spot and then drives straight on, and [`Dynamics`] for any other.
//! The search skips motions by what [`Dynamics`] promises, so check yours with [`check`] in a test.

pub use crate::motion::action::{Action, ActionGrid, Control};
pub use crate::motion::contract::check;
pub use crate::motion::dynamics::{Dynamics, Ray, RayFan, Side, TurningCircle, room_for_errors};
pub use crate::motion::pivots::Pivots;
