//! What a vehicle sets up: a mission, and who plans it.

use heapless::Vec;
use serde::{Deserialize, Deserializer, Serialize};

use crate::belief::front::{Front, FrontStretch};
use crate::belief::goal::Goal;
use crate::belief::noise::Noise;
use crate::belief::sample::Sample;
use crate::belief::tolerance::Tolerance;
use crate::belief::weight::Prior;
use crate::geometry::area::Area;
use crate::motion::any_vehicle::VehicleShape;
use crate::motion::dynamics::Pose;
use crate::planner::lookahead::DrivingPrice;
use crate::planner::options::{Crossing, Following, Options};
use crate::planner::scc::Policy;
use crate::planner::sight::AnySight;
use crate::search::objective::EffortWeight;

/// Given samples that a setup can hold.
pub const MOST_GIVEN: usize = 16;

/// What a mission fixes beforehand, whichever algorithm flies it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings<G = Area> {
    /// Where positions must stay.
    pub area: G,
    /// The weight of the control in the objective of Algorithms 1 and 2, or look-ahead's price of driving.
    pub weight: EffortWeight,
    /// How P1 looks for the opposite label.
    pub crossing: Crossing,
    /// How P2 follows the boundary.
    pub following: Following,
    /// The largest distance of a position from where it is reported.
    pub tolerance: Tolerance,
}

impl<G> Settings<G> {
    /// What Algorithms 1 and 2 leave open.
    pub const fn options(&self) -> Options {
        Options { weight: self.weight, crossing: self.crossing, following: self.following }
    }

    /// The price of look-ahead.
    pub fn price(&self) -> DrivingPrice {
        self.weight.into()
    }
}

/// A mission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Setup {
    /// [`PROTOCOL`](crate::link::message::PROTOCOL) as the vehicle has it.
    pub protocol: u16,
    /// Who plans.
    pub algorithm: Algorithm,
    /// What the mission fixes beforehand.
    pub config: Settings,
    /// The number of keep-outs, if the area is more than the rectangle of [`Settings::area`]. Then the chip asks for
    /// [outlines](crate::link::message::Request::Outline). It is [`CHARTED`](crate::link::message::CHARTED) more if the area
    /// has a chart. Then the chip asks for that too.
    pub keep_outs: Option<u8>,
    /// The parameters of the vehicle. The [chip](Setup::terms) decides whether it supports such a vehicle. It may
    /// support a single kind.
    pub vehicle: VehicleShape,
    /// The capacity asked for.
    pub capacity: Capacity,
    /// Steps at most.
    pub steps: u16,
    /// Labels at most, if they are limited by themselves.
    pub most_labels: Option<u16>,
    /// Where the vehicle is.
    pub start: Pose,
    /// Who reads labels.
    pub labels: LabelSource,
    /// The given samples, the paper's oracle points.
    pub given: Vec<Sample, MOST_GIVEN, u8>,
}

/// Who plans.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Algorithm {
    /// Algorithm 1, noiseless labels.
    Cfc,
    /// Algorithm 2, noisy labels.
    Scc {
        /// What is known of the noise.
        #[serde(deserialize_with = "once")]
        noise: Noise,
        /// How hypotheses choose an action together.
        policy: Policy,
        /// How they are weighed.
        prior: Prior,
    },
    /// Look-ahead.
    Lookahead {
        /// Ends of motions that a plan evaluates, at most.
        evaluations: u32,
        /// The goal at which the mission ends, if it has one.
        goal: Option<Goal>,
        /// What is known of the noise, and how hypotheses are weighed, if labels may be wrong.
        #[serde(deserialize_with = "maybe")]
        noise: Option<(Noise, Prior)>,
        /// How far labels are sought, at which price, and what they must carry.
        sight: AnySight,
    },
    /// The follower of fronts. It needs no given samples.
    Track {
        /// How tightly the front bends, and how fast it moves in the time of a motion.
        #[serde(deserialize_with = "once")]
        front: Front,
        /// What is known of the noise. No ball is trusted.
        #[serde(deserialize_with = "once")]
        noise: Noise,
        /// Whether the mission ends once the front is closed.
        ends: bool,
    },
    /// The guard of a stretch of a front. It needs no given samples.
    Watch {
        /// As [`Track`](Self::Track) has it.
        #[serde(deserialize_with = "once")]
        front: Front,
        /// As [`Track`](Self::Track) has it.
        #[serde(deserialize_with = "once")]
        noise: Noise,
        /// How much of the front is watched.
        stretch: FrontStretch,
    },
}

/// Reads a value by a function that is compiled once, not with each field that has it.
#[inline(never)]
fn once<'de, D: Deserializer<'de>, T: Deserialize<'de>>(reader: D) -> Result<T, D::Error> {
    T::deserialize(reader)
}

/// Reads the noise of labels that may be wrong, with the prior.
fn maybe<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<(Noise, Prior)>, D::Error> {
    /// Read by the same function.
    #[derive(Deserialize)]
    struct ReadOnce(#[serde(deserialize_with = "once")] Noise);
    let known = Option::<(ReadOnce, Prior)>::deserialize(reader)?;
    Ok(known.map(|(ReadOnce(noise), prior)| (noise, prior)))
}

/// Capacity for a mission's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Capacity {
    /// Samples, the given ones included.
    pub samples: u16,
    /// Hypotheses; 1 where there is but one.
    pub hypotheses: u16,
}

/// Who reads labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LabelSource {
    /// The vehicle: they come with [`Reply::Arrived`](crate::link::message::Reply::Arrived).
    Vehicle,
    /// The chip, from its own sensor, at the end of each motion and wherever the vehicle says on the way. Where a reading
    /// is told, the chip uses that one.
    Chip,
}
