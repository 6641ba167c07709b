//! Missions: what determines one (from a scenario file or made), how it is flown in the simulated world, and
//! the record of how it went.

pub mod algorithm;
pub mod allowance;
pub mod asking;
pub mod baseline;
pub mod bounds;
pub mod chords;
pub mod crossings;
pub mod definition;
mod diagnosing;
pub mod diagnosis;
pub mod flight;
pub mod from_nothing;
pub mod front;
pub mod given;
pub mod join;
pub mod lawnmower;
pub mod legs;
mod line_record;
pub mod map;
pub mod margin;
pub mod names;
pub mod planners;
pub mod random_walk;
pub mod read_out;
pub mod recording;
pub mod results;
pub mod scenario;
pub mod seeking;
pub mod sensor;
pub mod steering;
pub mod stop;
pub mod strict;
pub mod terrain;
mod truth;
pub mod vehicle;
