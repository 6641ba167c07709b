//! Missions: what determines one (from a scenario file or made), how it is flown in the simulated world, and
//! the record of how it went.

pub mod definition;
pub mod names;
pub mod random_walk;
pub mod recording;
pub mod scenario;
pub mod strict;
