//! One mission in a simulated world, from its first step to its end.

use std::cell::Cell;
use std::convert::Infallible;

use planner_core::agent::{Agent, AgentError, Event, Step};
use planner_core::cfc::{Cfc, Config};
use planner_core::dynamics::{Dynamics, Pose};
use planner_core::line::Line;
use planner_core::planner::{Planner, StopReason};
use planner_core::unicycle::Unicycle;
use planner_core::version_space::{Refused, VersionSpace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::random_walk::RandomWalk;
use crate::world::{Probe, Vehicle};

/// Samples that a simulated planner can hold, the oracle's included.
pub const CAPACITY: usize = 64;

/// Who plans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Algorithm {
    /// Algorithm 1, noiseless labels.
    Cfc,
    /// A random walk, for scale.
    Random,
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
        }
    }
}

/// A planner whose knowledge can be read.
trait Learner: Planner {
    fn space(&self) -> &VersionSpace<CAPACITY>;
}

impl<D: Dynamics> Learner for Cfc<D, CAPACITY> {
    fn space(&self) -> &VersionSpace<CAPACITY> {
        self.space()
    }
}

impl<D: Dynamics> Learner for RandomWalk<D> {
    fn space(&self) -> &VersionSpace<CAPACITY> {
        &self.space
    }
}

impl Mission {
    /// Runs the mission with the paper's unicycle; `watch` sees every step and what is known after
    /// it.
    ///
    /// # Errors
    /// [`Refused`] when a sample contradicts what is known.
    pub fn run(&self, watch: impl FnMut(&Step, &VersionSpace<CAPACITY>)) -> Result<End, Refused> {
        let (dynamics, space) = (Unicycle::paper(), self.space.clone());
        match self.algorithm {
            Algorithm::Cfc => self.drive(Cfc::new(self.config, dynamics, space), watch),
            Algorithm::Random => {
                let rng = ChaCha8Rng::seed_from_u64(self.seed);
                self.drive(RandomWalk { dynamics, area: self.config.area, space, rng }, watch)
            }
        }
    }

    fn drive(
        &self,
        planner: impl Learner,
        mut watch: impl FnMut(&Step, &VersionSpace<CAPACITY>),
    ) -> Result<End, Refused> {
        let pose = Cell::new(self.start);
        let probe = Probe { truth: self.truth, pose: &pose };
        let mut agent = Agent::new(planner, probe, Vehicle { pose: &pose }, self.start);
        for _ in 0..self.steps {
            match agent.step() {
                Ok(Event::Step(step)) => watch(&step, agent.planner.space()),
                Ok(Event::Stopped(reason)) => return Ok(End::Stopped(reason)),
                Err(AgentError::Refused(refused)) => return Err(refused),
                Err(AgentError::Sensor(never) | AgentError::Drive(never)) => {
                    let never: Infallible = never;
                    match never {}
                }
            }
        }
        Ok(End::Steps)
    }
}
