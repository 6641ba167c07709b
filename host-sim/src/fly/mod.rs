//! A vehicle that speaks `MAVLink` is the robot: the planner runs here, and the vehicle drives and senses.
//!
//! `pilot` holds what is decided, as messages and the time in and messages out: it knows no socket and no clock. A
//! [`Link`](link::Link) carries the messages: a `socket` to a real vehicle, the `ideal` vehicle of a dry run, or a
//! test's own. What autopilots take in guided mode is in `orders`, which of them are known in `autopilot`.

pub mod autopilot;
pub mod failure;
pub mod flight;
pub mod frame;
pub mod ideal;
pub mod label;
pub mod limits;
pub mod link;
pub mod orders;
pub mod pilot;
pub mod requests;
pub mod sent;
pub mod slide;
pub mod socket;
pub mod stage;
mod udp;
pub mod vehicle;

#[cfg(test)]
mod tests;
