//! How the robot moves: a finite set of actions, named by integers, and where each of them leads.
//!
//! Actions that share a direction of travel form a *ray*, and the rays from a pose form a *fan* ([`dynamics`]). The
//! crate has four vehicles. The paper's [`unicycle`] turns on the spot ([`pivots`]). A [`holonomic`] one drives in any
//! direction. A [`car`] and a [`boat`] cannot turn on the spot. [`any_vehicle`] is a vehicle that is chosen while the
//! program runs. [`contract`] checks a vehicle of your own. Nothing here knows of the line.

pub(crate) mod action;
pub(crate) mod any_vehicle;
pub(crate) mod boat;
pub(crate) mod car;
pub(crate) mod contract;
pub(crate) mod dynamics;
pub(crate) mod holonomic;
pub(crate) mod pivots;
pub(crate) mod unicycle;
