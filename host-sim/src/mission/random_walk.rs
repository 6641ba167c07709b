//! A planner that moves at random: what any planner has to beat.

use planner_core::belief::estimate::Estimates;
use planner_core::belief::posterior::Posterior;
use planner_core::belief::sample::{Label, Reading, Sample};
use planner_core::belief::version_space::{Refused, VersionSpace};
use planner_core::geometry::area::Area;
use planner_core::geometry::lattice::Site;
use planner_core::motion::action::Action;
use planner_core::motion::dynamics::{Dynamics, Pose};
use planner_core::planner::scc::Noise;
use planner_core::planner::{Motion, Plan, Planner, StopReason};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::mission::definition::{CAPACITY, Table};

/// What a walk learns from its samples.
pub trait Knowledge {
    /// Whether another sample would be refused for want of room.
    fn is_full(&self) -> bool;

    /// Takes in a reading.
    ///
    /// # Errors
    /// [`Refused`].
    fn learn(&mut self, site: Site, reading: Reading) -> Result<(), Refused>;

    /// The line as far as it is known.
    fn estimates(&self) -> Estimates;
}

impl Knowledge for VersionSpace<CAPACITY> {
    fn is_full(&self) -> bool {
        self.is_full()
    }

    fn learn(&mut self, site: Site, reading: Reading) -> Result<(), Refused> {
        self.observe(site, reading, Label::Positive).map(|_| ())
    }

    fn estimates(&self) -> Estimates {
        Estimates::of(self)
    }
}

/// A table with what is known of the noise.
impl Knowledge for (Table, Noise) {
    fn is_full(&self) -> bool {
        self.0.is_full()
    }

    /// Of hypotheses a reading on the boundary says nothing: see Algorithm 2.
    fn learn(&mut self, site: Site, reading: Reading) -> Result<(), Refused> {
        let Reading::Side(label) = reading else { return Ok(()) };
        self.0.observe(Sample { site, label }, self.1.at(site, self.0.given()))
    }

    fn estimates(&self) -> Estimates {
        Posterior::new(&self.0).estimates()
    }
}

/// Takes each action with equal probability among those that stay in the area.
pub struct RandomWalk<D, K> {
    /// The action set.
    pub dynamics: D,
    /// Where positions stay.
    pub area: Area,
    /// What has been learnt on the way.
    pub knowledge: K,
    /// The source of chance.
    pub rng: ChaCha8Rng,
}

impl<D: Dynamics, K: Knowledge> Planner for RandomWalk<D, K> {
    fn plan(&mut self, pose: Pose) -> Plan {
        if self.knowledge.is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        if !self.area.contains(pose.site) {
            return Plan::Stop(StopReason::OutsideArea);
        }
        loop {
            let actions = self.dynamics.grid().actions();
            let action = Action(self.rng.random_range(0..actions) as u16);
            let target = self.dynamics.target(pose, action);
            if let Some(target) = target.filter(|target| self.area.contains(target.site)) {
                let control = self.dynamics.control(action);
                let (stage, recovery, examined, proven) = (None, None, 1, true);
                return Plan::Move(Motion {
                    stage,
                    recovery,
                    action,
                    control,
                    target,
                    examined,
                    proven,
                });
            }
        }
    }

    fn observe(&mut self, pose: Pose, reading: Option<Reading>) -> Result<(), Refused> {
        reading.map_or(Ok(()), |reading| self.knowledge.learn(pose.site, reading))
    }

    fn estimates(&self) -> Estimates {
        self.knowledge.estimates()
    }
}
