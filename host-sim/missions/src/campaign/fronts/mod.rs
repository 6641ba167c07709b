//! Missions along fronts that bend and move: the ensemble, how a mission is flown, and what its map is worth.
//!
//! | module | contains |
//! | --- | --- |
//! | [`true_front`] | a front as it really is |
//! | [`kinds`] | the kinds of fronts, and what a tracker is told of each |
//! | [`following`] | a mission along a front, and what is measured of it |
//! | [`who`] | the planners by name |
//! | [`flight`] | all missions of a campaign on all cores |
//! | [`summary`] | what missions come to |

pub mod flight;
pub mod following;
pub mod kinds;
pub mod summary;
pub mod true_front;
pub mod who;
