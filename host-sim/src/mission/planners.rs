//! The planner of a mission, whichever belief it has.

use planner_core::belief::Refused;
use planner_core::belief::sample::Reading;
use planner_core::belief::tolerance::Tolerance;
use planner_core::motion::any_vehicle::AnyVehicle;
use planner_core::motion::dynamics::{Dynamics, Pose};
use planner_core::planner::cfc::Cfc;
use planner_core::planner::lookahead::Lookahead;
use planner_core::planner::scc::Scc;
use planner_core::planner::{Plan, Planner};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::margin::Margin;
use crate::mission::random_walk::RandomWalk;
use crate::mission::read_out::ReadOut;

/// Why a planner can be made of a mission's settings.
const FITS: &str = "settings that contradict each other were refused";

/// A planner whose belief can be read out.
pub type AnyPlanner = Box<dyn Planner<Belief = dyn ReadOut>>;

/// A planner, with the type of its belief forgotten.
struct Erased<P>(P);

impl<P: Planner<Belief: ReadOut + Sized + 'static>> Planner for Erased<P> {
    type Belief = dyn ReadOut;

    fn plan(&mut self, pose: Pose) -> Plan {
        self.0.plan(pose)
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), Refused> {
        self.0.observe_within(pose, reading, tolerance)
    }

    fn belief(&self) -> &(dyn ReadOut + 'static) {
        self.0.belief()
    }
}

fn erased(planner: impl Planner<Belief: ReadOut + Sized + 'static> + 'static) -> AnyPlanner {
    Box::new(Erased(planner))
}

impl Mission {
    /// The planner, as yet without a label.
    ///
    /// # Panics
    /// When settings contradict each other, which scenario files and flags are refused for.
    pub fn planner(&self) -> AnyPlanner {
        match self.vehicle {
            AnyVehicle::Unicycle(unicycle) => self.planner_of(unicycle),
            AnyVehicle::Boat(boat) => self.planner_of(boat),
            AnyVehicle::Car(car) => self.planner_of(car),
        }
    }

    fn planner_of(&self, dynamics: impl Dynamics + 'static) -> AnyPlanner {
        let config = self.config;
        let (area, rng) = (config.area, ChaCha8Rng::seed_from_u64(self.seed));
        match self.algorithm {
            Algorithm::Cfc => erased(Cfc::new(config, dynamics, self.lines()).expect(FITS)),
            Algorithm::Scc => {
                erased(Scc::new(config, self.policy, dynamics, self.table()).expect(FITS))
            }
            Algorithm::Lookahead if self.is_noisy() => erased(
                Lookahead::new(config, dynamics, self.forecast()).expect(FITS).until(self.goal),
            ),
            Algorithm::Lookahead => {
                erased(Lookahead::new(config, dynamics, self.lines()).expect(FITS).until(self.goal))
            }
            Algorithm::Margin if self.is_noisy() => {
                erased(Margin { dynamics, area, belief: self.table() })
            }
            Algorithm::Margin => erased(Margin { dynamics, area, belief: self.lines() }),
            Algorithm::Random if self.is_noisy() => {
                erased(RandomWalk { dynamics, area, belief: self.table(), rng })
            }
            Algorithm::Random => erased(RandomWalk { dynamics, area, belief: self.lines(), rng }),
        }
    }
}
