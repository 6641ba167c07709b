//! The search for the best action, circle by circle.
//!
//! The positions of one speed lie on a circle around the agent. Faster is better and turning less is:
//! so the outermost circle comes first, on it to either side the first ray that will do, and the search
//! ends where a circle is no better even straight ahead. What surely is certain is passed over
//! (`sight.rs`), and as certain ground of one label is convex, a ray whose end has the label of the
//! agent's own position is passed over for good; so is one that leaves the area, convex too, within the
//! shortest motion. What is left is settled by the exact predicate.

use crate::candidates::Certainty;
use crate::direction::Heading;
use crate::dynamics::{Dynamics, Pose, Ray, Side};
use crate::problem::{Candidate, Varrho};
use crate::rule::DirectionRule;
use crate::sight::Sight;

/// The rays to one side of a heading.
struct Arm {
    pose: Pose,
    side: Side,
    /// The first that may lead anywhere, and up to which they may.
    first: u32,
    count: u32,
}

/// A candidate and the number and side of its ray, by which ties are settled.
pub(crate) type Ranked = (Candidate, (u16, Side));

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
        if !core::mem::take(&mut self.promising) {
            return None;
        }
        let (best, _) = self.search(dynamics, [heading; 2], varrho, rule)?;
        self.promising = true;
        Some(best)
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
                let side = arm.side;
                let found = self.first(dynamics, arm, speed, rule, |ray, n| {
                    let value = objective(ray.effort);
                    best.is_none_or(|(b, order)| {
                        value > b.objective || (value == b.objective && (n, side) < order)
                    })
                });
                if let Some((ray, n, target)) = found {
                    let (action, objective) =
                        (grid.action(ray.index, speed), objective(ray.effort));
                    best = Some((Candidate { action, target, objective }, (n, side)));
                }
            }
        }
        best
    }

    /// The first ray of an arm whose end on a circle will do, as long as rays are worth it.
    fn first<D: Dynamics, R: DirectionRule>(
        &mut self,
        dynamics: &D,
        arm: &mut Arm,
        speed: u16,
        rule: &R,
        is_worth_it: impl Fn(&Ray, u16) -> bool,
    ) -> Option<(Ray, u16, Pose)> {
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
                let ray = dynamics.ray(pose, side, n);
                if !is_worth_it(&ray, n) {
                    return None;
                }
                if rule.admits(ray.step) {
                    if let Some(target) = self.uncertain_end(&ray, speed) {
                        return Some((ray, n, target));
                    }
                    (0, false)
                } else if self.promising || self.uncertain_end(&ray, speed).is_some() {
                    self.promising = true;
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
        self.examined += 1;
        let feasible = self.area.contains(target.site)
            && self.ground.certainty(target.site) == Certainty::Uncertain;
        feasible.then_some(target)
    }
}
