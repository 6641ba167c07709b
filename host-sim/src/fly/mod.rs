//! A vehicle that speaks `MAVLink` is the robot: the planner runs here, and the vehicle drives and senses.
//!
//! `pilot` decides: it takes messages and the time, and returns messages. It knows no socket and no clock. A
//! [`Link`](link::Link) carries the messages: a `socket` to a real vehicle, the `ideal` vehicle of a dry run, or a
//! test's own. `control` joins both to a body, and `by_hand` takes labels while an operator drives. `orders` has the
//! messages that autopilots accept in guided mode, and `autopilot` the autopilots that are known.

pub mod autopilot;
mod by_hand;
pub mod control;
pub mod failure;
pub mod flight;
pub mod frame;
pub mod ideal;
pub mod label;
pub mod limits;
pub mod link;
mod on_the_way;
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
