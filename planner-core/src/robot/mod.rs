//! The robot itself: the traits that its drive and its sensor implement ([`hal`]), the body that the two
//! are together ([`body`]), and the loop that joins a body to a planner ([`agent`]).

pub mod agent;
pub mod body;
pub mod hal;
