//! How the robot moves: a finite set of actions, named by integers, and where each of them leads.
//!
//! Actions that share a direction of travel form a *ray*, and the rays from a pose lie as a *fan*
//! ([`dynamics`]). Four vehicles come with the crate, the paper's [`unicycle`], a [`holonomic`] one, and two
//! that cannot turn on the spot, a [`car`] and a [`boat`]; [`any_vehicle`] is one of them that is known only as the program
//! runs, and [`contract`] checks one of your own. Nothing here knows of the line.

pub mod action;
pub mod any_vehicle;
pub mod boat;
pub mod car;
pub mod contract;
pub mod dynamics;
pub mod holonomic;
pub mod unicycle;
