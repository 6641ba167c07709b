//! The robot itself: the traits that its drive and its sensor implement ([`hal`]), the body that the two
//! are together ([`body`]), and the loop that joins a body to a planner ([`agent`]). [`asynchronous`] is the same for
//! drivers that are awaited; [`threshold`] is a sensor on a quantity that is measured.

pub mod agent;
pub mod asynchronous;
pub mod body;
pub mod hal;
pub mod threshold;
