//! One mission in a simulated world, from its first step to its end.

use std::cell::Cell;
use std::rc::Rc;

use planner_core::belief::hypotheses::{Hypotheses, Prior};
use planner_core::belief::version_space::{Refused, VersionSpace};
use planner_core::belief::weight::Reliability;
use planner_core::geometry::line::Line;
use planner_core::motion::dynamics::{Dynamics, Pose};
use planner_core::motion::unicycle::Unicycle;
use planner_core::planner::cfc::{self, Cfc};
use planner_core::planner::config::{Config, Following};
use planner_core::planner::scc::{self, Noise, Policy, Scc, trusted_radius};
use planner_core::planner::{Planner, StopReason};
use planner_core::robot::agent::{Agent, AgentError, Event, Step};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::mission::random_walk::RandomWalk;
use crate::world::truth::{Extent, Flipped, NoiseModel, Probe, Sensor, Vehicle};

/// Samples that a simulated planner can hold, the oracle's included: 64 labels beside its four.
pub const CAPACITY: usize = 68;

/// Hypotheses that a simulated planner can hold: all that 64 labels can come to.
pub const HYPOTHESES: usize = 2081;

/// The hypothesis table of simulated planners.
pub type Table = Hypotheses<CAPACITY, HYPOTHESES>;

/// Who plans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Algorithm {
    /// Algorithm 1, noiseless labels.
    Cfc,
    /// Algorithm 2, noisy labels.
    Scc,
    /// A random walk, for scale.
    Random,
}

impl Algorithm {
    /// What tables call it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Cfc => "Algorithm 1 (cfc)",
            Self::Scc => "Algorithm 2 (scc)",
            Self::Random => "random walk",
        }
    }

    /// How P2 follows the boundary unless one says: in the way that learns the most.
    pub fn following(self) -> Following {
        match self {
            Self::Cfc | Self::Random => cfc::FOLLOWING,
            Self::Scc => scc::FOLLOWING,
        }
    }
}

/// Everything that determines a mission.
#[derive(Clone, Debug)]
pub struct Mission {
    /// Who plans.
    pub algorithm: Algorithm,
    /// Steps at most.
    pub steps: u32,
    /// Seed of whatever is random.
    pub seed: u64,
    /// Area, weight of the control, way of crossing.
    pub config: Config,
    /// Where the agent starts.
    pub start: Pose,
    /// The line to be found.
    pub truth: Line,
    /// What the oracle's points leave open.
    pub space: VersionSpace<CAPACITY>,
    /// How labels are flipped; `None` when they are true.
    pub noise: Option<NoiseModel>,
    /// How hypotheses choose an action together (Algorithm 2).
    pub policy: Policy,
    /// How hypotheses are weighed beforehand (Algorithm 2).
    pub prior: Prior,
}

/// What is known of the line at some stage.
#[derive(Clone, Copy)]
pub enum Known<'a> {
    /// All lines that agree with every label.
    Lines(&'a VersionSpace<CAPACITY>),
    /// All separable sequences of labels with their weights.
    Hypotheses(&'a Table),
}

/// Why a mission ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// All steps were taken.
    Steps,
    /// The planner had no further motion.
    Stopped(StopReason),
}

impl End {
    /// The reason as the trace names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Steps => "steps",
            Self::Stopped(StopReason::Resolution) => "resolution",
            Self::Stopped(StopReason::SamplesFull) => "samples full",
            Self::Stopped(StopReason::OutsideArea) => "outside area",
            Self::Stopped(StopReason::Cornered) => "cornered",
            Self::Stopped(StopReason::Undecided) => "undecided",
        }
    }
}

/// A planner whose knowledge can be read.
pub trait Learner: Planner {
    /// What is known.
    fn known(&self) -> Known<'_>;
}

impl<D: Dynamics> Learner for Cfc<D, CAPACITY> {
    fn known(&self) -> Known<'_> {
        Known::Lines(self.space())
    }
}

impl<D: Dynamics> Learner for Scc<D, CAPACITY, HYPOTHESES> {
    fn known(&self) -> Known<'_> {
        Known::Hypotheses(self.hypotheses())
    }
}

impl<D: Dynamics> Learner for RandomWalk<D, VersionSpace<CAPACITY>> {
    fn known(&self) -> Known<'_> {
        Known::Lines(&self.knowledge)
    }
}

impl<D: Dynamics> Learner for RandomWalk<D, (Table, Noise)> {
    fn known(&self) -> Known<'_> {
        Known::Hypotheses(&self.knowledge.0)
    }
}

impl Mission {
    /// Whether what is known is a distribution over hypotheses.
    pub fn is_noisy(&self) -> bool {
        self.algorithm == Algorithm::Scc
            || (self.algorithm == Algorithm::Random && self.noise.is_some())
    }

    /// What a planner is told of the noise: of a band it can know `p` alone.
    ///
    /// # Panics
    /// Never: a noise model holds a probability and a radius within the lattice.
    pub fn noise_told(&self) -> Noise {
        let (p, radius) = match self.noise {
            None => (1.0, 0.0),
            Some(NoiseModel { p, extent: Extent::OutsideBalls(radius) }) => (p, radius),
            Some(NoiseModel { p, extent: Extent::Band(_) }) => (p, 0.0),
        };
        Noise {
            reliability: Reliability::new(p).expect("a probability"),
            trusted_radius: trusted_radius(radius).expect("a radius"),
        }
    }

    /// The table before the first label.
    ///
    /// # Panics
    /// When more than 15 of the oracle's points bound the line, which scenario files are refused for.
    pub fn table(&self) -> Table {
        Table::new(self.space.samples(), self.prior).expect("15 points bound the line at most")
    }

    /// The planner, with the paper's unicycle, as yet without a label.
    pub fn learner(&self) -> Box<dyn Learner> {
        let (dynamics, config, noise) = (Unicycle::paper(), self.config, self.noise_told());
        let (area, rng) = (config.area, ChaCha8Rng::seed_from_u64(self.seed));
        match self.algorithm {
            Algorithm::Cfc => Box::new(Cfc::new(config, dynamics, self.space.clone())),
            Algorithm::Scc => {
                Box::new(Scc::new(config, noise, self.policy, dynamics, self.table()))
            }
            Algorithm::Random if self.is_noisy() => {
                let knowledge = (self.table(), noise);
                Box::new(RandomWalk { dynamics, area, knowledge, rng })
            }
            Algorithm::Random => {
                let knowledge = self.space.clone();
                Box::new(RandomWalk { dynamics, area, knowledge, rng })
            }
        }
    }

    /// The vehicle at its start, and the sensor it carries.
    pub fn world(&self) -> (Vehicle, Sensor) {
        let pose = Rc::new(Cell::new(self.start));
        let vehicle = Vehicle { pose: pose.clone() };
        let sensor = Probe { truth: self.truth, pose: pose.clone() };
        let Some(model) = self.noise else {
            return (vehicle, Box::new(sensor));
        };
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(1); // the random walk has stream 0
        let (truth, noise) = (self.truth, self.noise_told());
        let given = self.space.samples().to_vec();
        (vehicle, Box::new(Flipped { sensor, model, truth, noise, given, pose, rng }))
    }

    /// Runs the mission; `watch` sees every step and what is known after it.
    ///
    /// # Errors
    /// [`Refused`] when a sample contradicts what is known.
    pub fn run(&self, mut watch: impl FnMut(&Step, Known<'_>)) -> Result<End, Refused> {
        let mut learner = self.learner();
        let (vehicle, mut sensor) = self.world();
        let mut agent = Agent::new(&mut *learner, &mut *sensor, vehicle, self.start);
        for _ in 0..self.steps {
            match agent.step() {
                Ok(Event::Step(step)) => watch(&step, agent.planner.known()),
                Ok(Event::Stopped(reason)) => return Ok(End::Stopped(reason)),
                Err(AgentError::Refused(refused)) => return Err(refused),
                Err(AgentError::Sensor(never) | AgentError::Drive(never)) => match never {},
            }
        }
        Ok(End::Steps)
    }
}
