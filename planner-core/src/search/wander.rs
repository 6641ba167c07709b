//! The last rung of the recovery ladder: motions of any kind, after which a label can be asked.
//!
//! Uncertain ground may be within reach where no action hits it that the other rungs look at: neither from here nor along
//! the ways that they follow. So this tries
//!
//! 1. motions drawn at random, one at a time, then up to six in a row, whether one ends where a label can tell something;
//! 2. a few motions of each kind, and pairs of them, and after each whether the problem is feasible. That is a search of
//!    all actions, so it also hits ground that is too thin to be drawn.
//!
//! What is drawn depends on the pose alone, so a plan is the same on every machine. **It ends**, though a way of several
//! motions may not be found again after the first: [`Silence`](crate::planner::silence::Silence) sees to that.

use crate::geometry::region::Region;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Side};
use crate::search::circles::Search;
use crate::search::direction_rule::DirectionRule;
use crate::search::objective::{Effort, OPENING};
use crate::search::problem::Problem;

/// The search after a motion, and after a pair, takes so many looks at most.
const LOOKS_A_SEARCH: [u32; 2] = [96, 16];

/// Sequences that are drawn, and the most motions of each.
const DRAWN: [(u32, u32); 2] = [(256, 1), (192, 6)];

/// An action and where it leads.
type Leg = (Action, Pose);

struct Wander<'d, 'p, 'a, D, R, G> {
    problem: &'p Problem<'a, R, G>,
    dynamics: &'d D,
    effort: Effort,
    /// What is drawn next.
    state: u64,
}

/// The first motion of a few after which a label can be asked, and whether it is the only one. It draws on the looks that the
/// search has left.
pub(crate) fn wander<D: Dynamics, R: DirectionRule, G: Region>(
    problem: &Problem<'_, R, G>,
    search: &mut Search<'_, D, G>,
) -> Option<(Leg, bool)> {
    let (dynamics, from) = (search.dynamics, search.pose);
    let mut it = Wander { problem, dynamics, effort: search.effort, state: 0 };
    let drawn = DRAWN
        .into_iter()
        .find_map(|(count, motions)| (0..count).find_map(|_| it.draw_way(from, motions)));
    let searched = drawn.or_else(|| {
        let leg = it.one(from, LOOKS_A_SEARCH[0]).or_else(|| it.two(from));
        leg.map(|leg| (leg, false))
    });
    search.effort = it.effort;
    searched
}

impl<D: Dynamics, R: DirectionRule, G: Region> Wander<'_, '_, '_, D, R, G> {
    /// The first of so many motions drawn at random, if one of them ends where a label tells something, and whether it is
    /// that one.
    fn draw_way(&mut self, from: Pose, motions: u32) -> Option<(Leg, bool)> {
        let (mut first, mut at) = (None, from);
        for _ in 0..motions {
            let Some(leg) = self.draw(at) else { continue };
            let is_last = first.is_none();
            let first = *first.get_or_insert(leg);
            if leg.1.site != at.site && self.problem.lines.can_cut(leg.1.site) {
                return Some((first, is_last));
            }
            at = leg.1;
        }
        None
    }

    /// A motion drawn at random, if it stays inside. The sharpest and the straight ones are drawn more often.
    fn draw(&mut self, from: Pose) -> Option<Leg> {
        let (dynamics, grid) = (self.dynamics, self.dynamics.grid());
        let side = if self.below(2) == 0 { Side::Left } else { Side::Right };
        if self.below(3) == 0
            && let Some(turned) = dynamics.turn_in_place(from, side)
        {
            return self.effort.take(1).then_some(turned);
        }
        let speed = 1 + self.below(u32::from(grid.speeds().saturating_sub(1))) as u16;
        let last = self.last_ray(speed, side)?;
        let number = match self.below(4) {
            0 => 0,
            1 => last,
            _ => self.below(last.saturating_add(1)),
        };
        self.drive(from, side, number, speed)
    }

    /// A number below a bound: the high half of a linear congruence (Knuth).
    fn below(&mut self, bound: u32) -> u32 {
        const STEP: [u64; 2] = [6_364_136_223_846_793_005, 1_442_695_040_888_963_407];
        self.state = self.state.wrapping_mul(STEP[0]).wrapping_add(STEP[1]);
        (((self.state >> 32) * u64::from(bound)) >> 32) as u32
    }

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
        let (dynamics, grid) = (self.dynamics, self.dynamics.grid());
        let side = if kind.is_multiple_of(2) { Side::Left } else { Side::Right };
        if kind < 2 {
            let turned = dynamics.turn_in_place(from, side)?;
            return self.effort.take(1).then_some(turned);
        }
        let (length, ray) = ((kind - 2) / RAYS, (kind - 2) % RAYS);
        let fastest = grid.speeds().saturating_sub(1);
        let speed =
            [fastest, fastest.div_ceil(2), fastest.div_ceil(5)].get(length as usize).copied()?;
        let last = self.last_ray(speed, side)?;
        // Straight ahead, then a third of the sharpest turn, two thirds and all of it, to either side.
        let number = (u64::from(last) * u64::from(ray.div_ceil(2)) / 3) as u32;
        self.drive(from, side, number, speed)
    }

    /// The number of the last ray to a side, at a speed.
    fn last_ray(&self, speed: u16, side: Side) -> Option<u32> {
        let [left, right] = self.dynamics.rays_at(speed).unwrap_or_else(|| {
            let fan = self.dynamics.fan();
            [fan.left, fan.right]
        });
        if side == Side::Left { left.checked_sub(1) } else { Some(right) }
    }

    /// A drive, if it stays inside.
    fn drive(&mut self, from: Pose, side: Side, number: u32, speed: u16) -> Option<Leg> {
        if !self.effort.take(1) {
            return None;
        }
        let ray = self.dynamics.ray(from, side, number);
        let after = self.dynamics.arrive(from, &ray, speed).ok()?;
        let area = &self.problem.area;
        self.effort.take_sweep(area, &[from.site, after.site]);
        let stays = area.contains(after.site) && self.dynamics.keeps_inside(from, after, area);
        stays.then(|| (self.dynamics.grid().action(ray.index, speed), after))
    }
}

/// Rays that are tried: straight ahead and three to either side.
const RAYS: u32 = 7;

/// Kinds of motions: two turns, and three lengths along each ray.
const KINDS: u32 = 2 + 3 * RAYS;
