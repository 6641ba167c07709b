//! A planner that moves at random: a baseline that any planner has to beat.

use planner_core::dynamics::{Action, Dynamics, Side};
use planner_core::error::ObservationError;
use planner_core::{
    Belief, Motion, Plan, Planner, Pose, Reading, Site, StopReason, Tolerance, Workspace as _,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::mission::baseline::{motion, take_in};
use crate::mission::terrain::Terrain;

/// Actions that are drawn to find a drive.
const DRAWN: u32 = 1_000;

/// Takes each drive that stays in the area with equal probability. If an error has brought it outside, it also takes
/// drives that lead no further from the area's middle. It reads no label until it is inside. Where it finds no drive, it
/// turns to the left.
pub struct RandomWalk<D, B> {
    /// The action set.
    pub dynamics: D,
    /// Where positions stay.
    pub area: Terrain,
    /// What has been learnt on the way.
    pub belief: B,
    /// The random number generator.
    pub rng: ChaCha8Rng,
}

impl<D: Dynamics, B: Belief> Planner for RandomWalk<D, B> {
    type Belief = B;

    fn plan(&mut self, pose: Pose) -> Plan {
        if self.belief.is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        let is_outside = !self.area.contains(pose.site);
        let to_middle = |site| {
            let way = self.area.area().middle() - site;
            way.dot(way)
        };
        let drive = (0..DRAWN).find_map(|_| {
            let last = self.dynamics.grid().actions() - 1;
            let action = Action(self.rng.random_range(0..=last as u32));
            let target = self.dynamics.target(pose, action).filter(|target| {
                let comes_back = is_outside && to_middle(target.site) <= to_middle(pose.site);
                let stays = comes_back && self.dynamics.stays_inside(pose, *target, &self.area)
                    || self.area.contains(target.site)
                        && self.dynamics.keeps_inside(pose, *target, &self.area, 0);
                stays && target.site != pose.site
            });
            target.map(|target| (action, target))
        });
        let Some((action, target)) =
            drive.or_else(|| self.dynamics.turn_in_place(pose, Side::Left))
        else {
            return Plan::Stop(StopReason::Cornered);
        };
        let wants_label = drive.is_some() && self.area.contains(target.site);
        let motion = motion(&self.dynamics, pose, action, target);
        Plan::Move(Motion { wants_label, ..motion })
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        take_in(&mut self.belief, pose, reading, tolerance)
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        self.belief.observe_on_the_way(site, reading)
    }

    fn belief(&self) -> &B {
        &self.belief
    }
}
