//! A planner that moves at random: what any planner has to beat.

use planner_core::action::Action;
use planner_core::area::Area;
use planner_core::dynamics::{Dynamics, Pose};
use planner_core::planner::{Motion, Plan, Planner, StopReason};
use planner_core::sample::{Label, Reading, Sample};
use planner_core::version_space::{Refused, VersionSpace};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::mission::CAPACITY;

/// Takes each action with equal probability among those that stay in the area.
pub struct RandomWalk<D> {
    /// The action set.
    pub dynamics: D,
    /// Where positions stay.
    pub area: Area,
    /// What has been learnt on the way.
    pub space: VersionSpace<CAPACITY>,
    /// The source of chance.
    pub rng: ChaCha8Rng,
}

impl<D: Dynamics> RandomWalk<D> {
    fn target(&self, pose: Pose, action: Action) -> Option<Pose> {
        let (index, speed) = self.dynamics.grid().split(action);
        let ray = self.dynamics.rays(pose).find(|ray| ray.index == index)?;
        ray.arrive(pose.site, speed).ok().filter(|target| self.area.contains(target.site))
    }
}

impl<D: Dynamics> Planner for RandomWalk<D> {
    fn plan(&mut self, pose: Pose) -> Plan {
        if self.space.is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        if !self.area.contains(pose.site) {
            return Plan::Stop(StopReason::OutsideArea);
        }
        loop {
            let actions = self.dynamics.grid().actions();
            let action = Action(self.rng.random_range(0..actions) as u16);
            if let Some(target) = self.target(pose, action) {
                let control = self.dynamics.control(action);
                let motion =
                    Motion { stage: None, recovery: None, action, control, target, examined: 1 };
                return Plan::Move(motion);
            }
        }
    }

    fn observe(&mut self, pose: Pose, reading: Option<Reading>) -> Result<(), Refused> {
        let label = match reading {
            Some(Reading::Side(label)) => label,
            // True of the closed half-plane, as the negative one would be.
            Some(Reading::Boundary) => Label::Positive,
            None => return Ok(()),
        };
        self.space.insert(Sample { site: pose.site, label }).map(|_| ())
    }
}
