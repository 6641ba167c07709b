//! A garden as a porter would simulate it: an L-shaped lawn with two trees, a rover whose odometry drifts, and labels
//! that are sometimes wrong. A porter is an engineer who takes the planner to a robot.
//!
//! [`lawn`] draws a mission. [`rover`] moves, drifts and senses. [`flight`] flies a planner and checks how it went.
//! [`chords`] finds the line as one would by hand.

pub mod chords;
pub mod flight;
pub mod lawn;
pub mod rover;
