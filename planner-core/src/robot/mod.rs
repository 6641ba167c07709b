//! The robot itself: the traits that its drive and its sensor implement ([`hal`]), and the loop that
//! joins them to a planner ([`agent`]).

pub mod agent;
pub mod hal;
