//! The last rung of the recovery ladder: motions drawn at random, after which a label can be asked.
//!
//! Uncertain ground may be within reach although the other rungs find no action that hits it. They look only from here
//! and along the ways that they follow. So this rung draws motions: first one at a time, then up to six in a row. It
//! continues as long as the plan has looks. It takes the first way that ends where a label can tell something.
//!
//! The numbers drawn are the same in each plan, so a plan is the same on every machine. The next plans follow the way
//! that was drawn, see `course`.

use heapless::Vec;

use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose, Side};
use crate::search::circles::Search;
use crate::search::course::REST;
use crate::search::direction_rule::DirectionRule;
use crate::search::motions::Leg;
use crate::search::objective::{Effort, sweep};
use crate::search::problem::Problem;

/// The looks that a drawn drive costs, with all its checks.
const LOOKS_A_DRIVE: u32 = 2;

/// Sequences that are drawn, and the most motions of each.
const DRAWN: [(u32, u32); 2] = [(256, 1), (4_096, MOTIONS as u32)];

/// Motions of a way.
const MOTIONS: usize = 1 + REST;

/// A way, at whose end a label can be asked.
type Drawn = Vec<Leg, MOTIONS, u8>;

struct Wander<'d, 'p, 'a, D, R, G> {
    problem: &'p Problem<'a, R, G>,
    dynamics: &'d D,
    effort: Effort,
    /// What is drawn next.
    state: u64,
}

/// A few motions after which a label can be asked. It draws on the looks that the search has left.
pub(crate) fn wander<D: Dynamics, R: DirectionRule, G: Workspace>(
    problem: &Problem<'_, R, G>,
    search: &mut Search<'_, D, G>,
) -> Option<Drawn> {
    let (dynamics, from) = (search.dynamics, search.pose);
    let mut it = Wander { problem, dynamics, effort: search.effort, state: 0 };
    let drawn = DRAWN
        .into_iter()
        .find_map(|(count, motions)| (0..count).find_map(|_| it.draw_way(from, motions)));
    search.effort = it.effort;
    drawn
}

/// The first drive drawn at random that stays inside. It draws on the looks that the search has left.
pub(crate) fn drift<D: Dynamics, R: DirectionRule, G: Workspace>(
    problem: &Problem<'_, R, G>,
    search: &Search<'_, D, G>,
    number: u8,
) -> Option<Leg> {
    let (dynamics, from) = (search.dynamics, search.pose);
    let mut it = Wander { problem, dynamics, effort: search.effort, state: u64::from(number) };
    (0..search.effort.looks).find_map(|_| it.draw(from).filter(|leg| leg.1.site != from.site))
}

impl<D: Dynamics, R: DirectionRule, G: Workspace> Wander<'_, '_, '_, D, R, G> {
    /// A number of motions drawn at random, up to the first that ends where a label tells something. Motions that lead
    /// back to an earlier position are left out.
    fn draw_way(&mut self, from: Pose, motions: u32) -> Option<Drawn> {
        if !self.effort.is_enough() {
            return None;
        }
        let mut way = Drawn::new();
        for _ in 0..motions {
            let at = way.last().map_or(from, |leg| leg.1);
            let Some(leg) = self.draw(at) else { continue };
            let known = way.iter().position(|it| it.1 == leg.1).map(|it| it + 1);
            if let Some(until) = known.or((leg.1 == from).then_some(0)) {
                way.truncate(until);
                continue;
            }
            way.push(leg).ok()?;
            if is_open(self.problem, self.dynamics, [at, leg.1]) {
                return Some(way);
            }
        }
        None
    }

    /// A motion drawn at random, if it stays inside. The sharpest and the straight ones are drawn more often.
    fn draw(&mut self, from: Pose) -> Option<Leg> {
        if !self.effort.take(1) {
            return None;
        }
        let (dynamics, grid) = (self.dynamics, self.dynamics.grid());
        let side = if self.below(2) == 0 { Side::Left } else { Side::Right };
        if self.below(3) == 0
            && let Some(turned) = dynamics.turn_in_place(from, side)
        {
            return Some(turned);
        }
        let speed = 1 + self.below(u32::from(grid.speeds().saturating_sub(1))) as u16;
        let last = self.last_ray(speed, side)?;
        let number = match self.below(4) {
            0 => 0,
            1 => last,
            _ => self.below(last.saturating_add(1)),
        };
        if !self.effort.take(LOOKS_A_DRIVE) {
            return None;
        }
        let ray = dynamics.ray(from, side, number);
        let after = dynamics.arrive(from, &ray, speed).ok()?;
        let stays = stays(dynamics, &self.problem.area, &mut self.effort, [from, after]);
        stays.then(|| (grid.action(ray.index, speed), after))
    }

    /// A number below a bound: the high half of a linear congruence (Knuth).
    fn below(&mut self, bound: u32) -> u32 {
        const STEP: [u64; 2] = [6_364_136_223_846_793_005, 1_442_695_040_888_963_407];
        self.state = self.state.wrapping_mul(STEP[0]).wrapping_add(STEP[1]);
        (((self.state >> 32) * u64::from(bound)) >> 32) as u32
    }

    /// The number of the last ray to a side, at a speed.
    fn last_ray(&self, speed: u16, side: Side) -> Option<u32> {
        let [left, right] = self.dynamics.rays_at(speed).unwrap_or_else(|| {
            let fan = self.dynamics.fan();
            [fan.left, fan.right]
        });
        // Without any on the left there is none straight ahead: the speed has none at all. A fan that reaches all around
        // has them all on the left.
        left.checked_sub(1).map(|last| if side == Side::Left || right == 0 { last } else { right })
    }
}

/// Whether a motion ends where a label tells something and the vehicle is safe.
pub(crate) fn is_open<D: Dynamics, R, G: Workspace>(
    problem: &Problem<'_, R, G>,
    dynamics: &D,
    [from, to]: [Pose; 2],
) -> bool {
    let Problem { lines, area, .. } = problem;
    to.site != from.site && lines.can_cut(to.site) && dynamics.is_safe(to, area)
}

/// Whether a drive stays inside and ends where the vehicle is safe. If the vehicle is not safe at the beginning, the
/// drive need only stay inside.
#[inline(never)]
pub(crate) fn stays<D: Dynamics, G: Workspace>(
    dynamics: &D,
    area: &G,
    effort: &mut Effort,
    [from, to]: [Pose; 2],
) -> bool {
    if !area.contains(to.site) {
        return false;
    }
    // The way, and two circles at either end.
    let looks = sweep(area, &[from.site, to.site]);
    effort.take(looks);
    if !dynamics.stays_inside(from, to, area) {
        return false;
    }
    effort.take(2 * looks);
    if dynamics.ends_safe(to, area, 0) {
        return true;
    }
    effort.take(2 * looks);
    !dynamics.is_safe(from, area)
}
