//! Missions that seek a boundary from nothing: a patch inside an area, or a coast across it.
//!
//! | module | contains |
//! | --- | --- |
//! | [`truth`] | boundaries as they really are |
//! | [`kinds`] | the rows of the table: boundary, area, vehicle |
//! | [`flight`] | all missions of a campaign on all cores, and what they come to |

pub mod flight;
pub mod kinds;
pub mod truth;
