//! The search for the best action, circle by circle.
//!
//! The positions of one speed lie on a circle around the agent. Faster is better and turning less is:
//! so the outermost circle comes first, on it to either side the first ray that will do, and the search
//! ends where a circle is no better even straight ahead. What surely is certain is passed over
//! (`sight.rs`), and as certain ground of one label is convex, a ray whose end has the label of the
//! agent's own position is passed over for good; so is one that leaves the area, convex too, within the
//! shortest motion. What is left is settled by the exact predicate.

use crate::belief::candidates::Certainty;
use crate::geometry::direction::Heading;
use crate::motion::dynamics::{Dynamics, Pose, Ray, Side};
use crate::search::direction_rule::DirectionRule;
use crate::search::problem::{Candidate, Varrho};
use crate::search::view::Sight;

/// The rays to one side of a heading.
struct Arm {
    pose: Pose,
    side: Side,
    /// The first that may lead anywhere, and up to which they may.
    first: u32,
    count: u32,
}

/// The number and side of a ray, by which ties are settled.
type Order = (u16, Side);

/// A candidate and the order of its ray.
pub(crate) type Ranked = (Candidate, Order);

fn is_better(value: i64, order: Order, than: Option<Ranked>) -> bool {
    than.is_none_or(|(best, at)| value > best.objective || (value == best.objective && order < at))
}

impl Sight<'_> {
    /// The best action from here when facing some heading, the same each time; at once if an earlier
    /// search by another rule has come upon no place to go at all.
    pub(crate) fn best<D: Dynamics, R: DirectionRule>(
        &mut self,
        dynamics: &D,
        heading: Heading,
        varrho: Varrho,
        rule: &R,
    ) -> Option<Candidate> {
        if core::mem::replace(&mut self.keeps_barred, true) && self.barred.is_none() {
            return None;
        }
        self.search(dynamics, [heading; 2], varrho, rule).map(|(candidate, _)| candidate)
    }

    /// On which side there is the better action: on the left of one heading or the right of another.
    pub(crate) fn better_side<D: Dynamics, R: DirectionRule>(
        &mut self,
        dynamics: &D,
        headings: [Heading; 2],
        varrho: Varrho,
        rule: &R,
    ) -> Option<Side> {
        self.search(dynamics, headings, varrho, rule).map(|(_, (_, side))| side)
    }

    /// The best action on the left of one heading and the right of another.
    pub(crate) fn search<D: Dynamics, R: DirectionRule>(
        &mut self,
        dynamics: &D,
        [left, right]: [Heading; 2],
        varrho: Varrho,
        rule: &R,
    ) -> Option<Ranked> {
        let (grid, fan) = (self.grid, dynamics.fan());
        let arm = |heading, side, first, count| Arm {
            pose: Pose { site: self.site, heading },
            side,
            first,
            count,
        };
        let mut arms = [
            arm(left, Side::Left, 0, u32::from(fan.left)),
            arm(right, Side::Right, 1, u32::from(fan.right) + 1),
        ];
        let mut best: Option<Ranked> = None;
        for speed in (1..grid.speeds()).rev() {
            let objective = |effort| varrho.objective(grid.reach_mm(speed), effort);
            let done = arms.iter().all(|arm| arm.first >= arm.count);
            if done || best.is_some_and(|(b, _)| objective(0) < b.objective) || !self.look(speed) {
                break;
            }
            for arm in &mut arms {
                best = self.first(dynamics, arm, speed, rule, best, objective).or(best);
            }
        }
        best
    }

    /// The first ray of an arm whose end on a circle will do, if that is better than the best so far.
    fn first<D: Dynamics, R: DirectionRule>(
        &mut self,
        dynamics: &D,
        arm: &mut Arm,
        speed: u16,
        rule: &R,
        best: Option<Ranked>,
        objective: impl Fn(u32) -> i64,
    ) -> Option<Ranked> {
        let spacing = dynamics.fan().spacing.0.max(1);
        let (pose, side) = (arm.pose, arm.side);
        let mut next = arm.first;
        while next < arm.count {
            let n = next as u16;
            let heading = dynamics.heading(pose, side, n);
            // How far this ray's verdict holds, and whether it does for the inner circles too.
            let (turn, throughout) = if let Some(turn) = self.walled(heading, side) {
                (turn, true)
            } else if let Some((label, turn)) = self.surely(heading, side) {
                (turn, self.here == Certainty::Certain(label))
            } else if let Some(turn) = self.outside(heading, side) {
                (turn, false)
            } else {
                self.effort.looks = self.effort.looks.checked_sub(1)?;
                let ray = dynamics.ray(pose, side, n);
                let (value, order) = (objective(ray.effort), (n, side));
                if !is_better(value, order, best) {
                    return None;
                }
                let action = self.grid.action(ray.index, speed);
                let candidate = |target| (Candidate { action, target, objective: value }, order);
                if rule.admits(ray.step) {
                    let found = self.uncertain_end(&ray, speed).map(candidate);
                    if found.is_some() {
                        return found;
                    }
                    (0, false)
                } else if !self.keeps_barred || !is_better(value, order, self.barred) {
                    (rule.barred(heading, ray.step, side), true)
                } else if let Some(target) = self.uncertain_end(&ray, speed) {
                    self.barred = Some(candidate(target));
                    (rule.barred(heading, ray.step, side), true)
                } else {
                    (0, false)
                }
            };
            // Rays within the turn are like this one: it is below 2^32, and a step above 2^15.
            let after = next + turn / spacing + 1;
            if throughout && next == arm.first {
                arm.first = after;
            } else if throughout && after >= arm.count {
                arm.count = next;
            }
            next = after;
        }
        None
    }

    /// The pose at a ray's end, if that is inside the area and on uncertain ground.
    fn uncertain_end(&mut self, ray: &Ray, speed: u16) -> Option<Pose> {
        let target = ray.arrive(self.site, speed).ok()?;
        self.effort.examined += 1;
        let feasible = self.area.contains(target.site)
            && self.ground.certainty(target.site) == Certainty::Uncertain;
        feasible.then_some(target)
    }
}
