//! The last rung of the recovery ladder: one or two motions of any kind after which a label can be asked.
//!
//! Uncertain ground may be within reach where no action hits it, neither from here nor along the ways that the other rungs
//! follow. So this tries a few motions of each kind, and after each of them, then after each pair of them, whether the
//! problem is feasible. As that is a search of all actions, it covers what two or three motions of these vehicles can do.
//!
//! **It ends**, though it has no state: after the first motion of a pair the second is found again.

use crate::geometry::region::Region;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Side};
use crate::search::circles::Search;
use crate::search::direction_rule::DirectionRule;
use crate::search::objective::{Effort, OPENING};
use crate::search::problem::Problem;

/// The search after a motion, and after a pair, takes so many looks at most.
const LOOKS_A_SEARCH: [u32; 2] = [96, 16];

/// An action and where it leads.
type Leg = (Action, Pose);

struct Wander<'d, 'p, 'a, D, R, G> {
    problem: &'p Problem<'a, R, G>,
    dynamics: &'d D,
    effort: Effort,
}

/// The first of one or two motions after which the problem is feasible. It draws on the looks that the search has left.
pub(crate) fn wander<D: Dynamics, R: DirectionRule, G: Region>(
    problem: &Problem<'_, R, G>,
    search: &mut Search<'_, D, G>,
) -> Option<Leg> {
    let (dynamics, from) = (search.dynamics, search.pose);
    let mut it = Wander { problem, dynamics, effort: search.effort };
    let found = it.one(from, LOOKS_A_SEARCH[0]).or_else(|| it.two(from));
    search.effort = it.effort;
    found
}

impl<D: Dynamics, R: DirectionRule, G: Region> Wander<'_, '_, '_, D, R, G> {
    /// The first motion after which the problem is feasible, in so many looks for each.
    fn one(&mut self, from: Pose, looks: u32) -> Option<Leg> {
        (0..KINDS).find_map(|kind| {
            let leg = self.motion(from, kind)?;
            self.is_feasible(leg.1, looks).then_some(leg)
        })
    }

    /// The first of the first pair of motions after which it is feasible.
    fn two(&mut self, from: Pose) -> Option<Leg> {
        (0..KINDS).find_map(|kind| {
            let leg = self.motion(from, kind)?;
            self.one(leg.1, LOOKS_A_SEARCH[1]).map(|_| leg)
        })
    }

    fn is_feasible(&mut self, pose: Pose, looks: u32) -> bool {
        self.effort.take(OPENING);
        let kept = self.effort.keep_back(looks);
        let mut there = self.problem.search(self.dynamics, pose, self.effort);
        let there = there.open();
        let best = there.best_between([pose.heading; 2], &self.problem.rule);
        self.effort = there.effort;
        self.effort.give_back(kept);
        best.is_some()
    }

    /// A motion of a kind, if there is one that stays inside: turns in place, and drives of three lengths along seven rays.
    fn motion(&mut self, from: Pose, kind: u32) -> Option<Leg> {
        if !self.effort.take(1) {
            return None;
        }
        let (dynamics, grid) = (self.dynamics, self.dynamics.grid());
        let side = if kind.is_multiple_of(2) { Side::Left } else { Side::Right };
        if kind < 2 {
            return dynamics.turn_in_place(from, side);
        }
        let (length, ray) = ((kind - 2) / RAYS, (kind - 2) % RAYS);
        let fastest = grid.speeds().saturating_sub(1);
        let speed =
            [fastest, fastest.div_ceil(2), fastest.div_ceil(5)].get(length as usize).copied()?;
        let [left, right] = dynamics.rays_at(speed).unwrap_or_else(|| {
            let fan = dynamics.fan();
            [fan.left, fan.right]
        });
        let last = if side == Side::Left { left.checked_sub(1)? } else { right };
        // Straight ahead, then a third of the sharpest turn, two thirds and all of it, to either side.
        let number = (u64::from(last) * u64::from(ray.div_ceil(2)) / 3) as u32;
        let ray = dynamics.ray(from, side, number);
        let after = dynamics.arrive(from, &ray, speed).ok()?;
        let area = &self.problem.area;
        self.effort.take_sweep(area, &[from.site, after.site]);
        let stays = area.contains(after.site) && dynamics.keeps_inside(from, after, area);
        stays.then(|| (grid.action(ray.index, speed), after))
    }
}

/// Rays that are tried: straight ahead and three to either side.
const RAYS: u32 = 7;

/// Kinds of motions: two turns, and three lengths along each ray.
const KINDS: u32 = 2 + 3 * RAYS;
