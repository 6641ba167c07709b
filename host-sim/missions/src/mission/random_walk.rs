//! A planner that moves at random: a baseline that any planner has to beat.

use planner_core::dynamics::{Action, Dynamics, Side};
use planner_core::{Motion, Pose, StopReason, Workspace as _};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::mission::baseline::{Ground, Strategy, motion};

/// Actions that are drawn to find a drive.
const DRAWN: u32 = 1_000;

/// Takes each drive that stays in the area with equal probability. If an error has brought it outside, it also takes
/// drives that lead no further from the area's middle. It reads no label until it is inside. Where it finds no drive, it
/// turns to the left.
pub struct RandomWalk(pub ChaCha8Rng);

impl<D: Dynamics> Strategy<D> for RandomWalk {
    fn choose(&mut self, ground: &Ground<D>, pose: Pose) -> Result<Motion, StopReason> {
        let Ground { dynamics, area, .. } = ground;
        let is_outside = !area.contains(pose.site);
        let to_middle = |site| {
            let way = area.area().middle() - site;
            way.dot(way)
        };
        let drive = (0..DRAWN).find_map(|_| {
            let last = dynamics.grid().actions() - 1;
            let action = Action(self.0.random_range(0..=last as u32));
            let target = dynamics.target(pose, action).filter(|target| {
                let comes_back = is_outside && to_middle(target.site) <= to_middle(pose.site);
                let stays = comes_back && dynamics.stays_inside(pose, *target, area)
                    || area.contains(target.site) && dynamics.keeps_inside(pose, *target, area, 0);
                stays && target.site != pose.site
            });
            target.map(|target| (action, target))
        });
        let leg = drive.or_else(|| dynamics.turn_in_place(pose, Side::Left));
        let (action, target) = leg.ok_or(StopReason::Cornered)?;
        let wants_label = drive.is_some() && area.contains(target.site);
        Ok(Motion { wants_label, ..motion(dynamics, pose, action, target) })
    }
}
