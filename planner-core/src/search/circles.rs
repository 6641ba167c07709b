//! The search for the best action, circle by circle.
//!
//! The positions of one speed lie on a circle around the agent. A faster motion is better, and so is a smaller turn. So
//! the search begins with the outermost circle. On each side it looks for the first ray that will do. It ends at a
//! circle that is no better even straight ahead.
//!
//! Rays that are known to end on certain ground are skipped (see `view`). Two kinds of rays are skipped on all inner
//! circles too. One kind ends on ground that has the label of the agent's own position, as certain ground of one label
//! is convex. The other kind leaves the area, which is convex too, within the shortest motion. The exact predicate
//! decides all other rays.

use core::num::NonZeroU32;

use crate::belief::cells::Certainty;
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose, Ray, Side, room_for_errors};
use crate::search::direction_rule::DirectionRule;
use crate::search::objective::{Choice, Effort, EffortWeight, sweep};
use crate::search::view::View;

/// The search of one plan: what it moves by, from where, what it sees there, and what it has cost.
pub(crate) struct Search<'a, D, G> {
    pub(crate) dynamics: &'a D,
    pub(crate) pose: Pose,
    pub(crate) weight: EffortWeight,
    pub(crate) view: View<'a, G>,
    pub(crate) effort: Effort,
    /// Whether some motion ended on uncertain ground but could not stay inside the area.
    pub(crate) is_hemmed_in: bool,
}

/// The number and side of a ray, by which ties are settled.
type Rank = (u32, Side);

/// A choice and the rank of its ray.
type Ranked = (Choice, Rank);

/// What a search found.
#[derive(Clone, Copy)]
pub(crate) struct Findings {
    /// The best of the actions that the rule allows.
    pub(crate) best: Option<Ranked>,
    /// The best of the others that came up; of all of them if `best` is `None`.
    pub(crate) best_forbidden: Option<Ranked>,
}

/// The least spacing that the search assumes of a fan. If the fan is narrower, the search only looks at more rays.
/// There are at most 2^31 rays that move, so `next + turn / LEAST + 1` is below 2^32.
const LEAST: NonZeroU32 = NonZeroU32::MIN.saturating_add(1);

/// Rays this near to one that leads to the border are assumed to lead there too. The angle is less than the 10 mrad of
/// the paper's fan, so only finer fans lose an action to it, near the border. Without it they would use up a plan's
/// looks there.
const HEMMED_IN: u32 = Angle::of_radians(0.004).0;

/// If the rays of a fan are further apart than this, the search looks at each of them. Else it skips rays next to one
/// whose end is certain.
const COARSE: u32 = Angle::of_radians(0.001).0;

/// The rays to one side of a heading that may still lead anywhere.
struct Arm {
    pose: Pose,
    side: Side,
    /// The turn from one to the next, at most.
    spacing: NonZeroU32,
    first: u32,
    end: u32,
}

impl Arm {
    const fn is_empty(&self) -> bool {
        self.first >= self.end
    }

    /// Leaves rays out for good, if they are the first or the last.
    const fn leave_out(&mut self, from: u32, to: u32) {
        if from == self.first {
            self.first = to;
        } else if to >= self.end {
            self.end = from;
        }
    }
}

/// What is known of the end of a ray on a circle.
enum EndVerdict {
    /// It will do, and is the best so far.
    Best,
    /// It will not, and neither will the ends of rays within this turn.
    Infeasible { turn: u32, on_inner_circles_too: bool },
    /// None beyond it is better than the best so far, or the looks are used up.
    NoneBetter,
}

/// The object of a search, and its results so far.
struct CircleSearch<'r, R> {
    rule: &'r R,
    /// Whether the best forbidden action is wanted.
    keeps_forbidden: bool,
    /// Whether rays are so far apart that each is looked at.
    is_coarse: bool,
    found: Findings,
}

fn is_better(value: i64, rank: Rank, than: Option<&Ranked>) -> bool {
    than.is_none_or(|(best, at)| value > best.objective || (value == best.objective && rank < *at))
}

impl<D: Dynamics, G: Workspace> Search<'_, D, G> {
    /// Computes the view. This is a separate step, so that the search is built where it stays.
    #[must_use]
    pub(crate) fn open(&mut self) -> &mut Self {
        self.view.open();
        self
    }

    /// The best action by a rule. `before` is the result of an earlier search by another rule, if that found no action.
    /// If it found none under any rule, this search looks at nothing again.
    pub(crate) fn best<R: DirectionRule>(
        &mut self,
        rule: &R,
        before: Option<Findings>,
    ) -> Findings {
        let found = match before {
            Some(nothing @ Findings { best_forbidden: None, .. }) => return nothing,
            Some(found) => found,
            None => Findings { best: None, best_forbidden: None },
        };
        let mut hunt = CircleSearch { rule, keeps_forbidden: true, is_coarse: false, found };
        self.look_around([self.pose.heading; 2], &mut hunt);
        hunt.found
    }

    /// The best action on the left of one heading and the right of another, and on which side it is.
    pub(crate) fn best_between<R: DirectionRule>(
        &mut self,
        headings: [Heading; 2],
        rule: &R,
    ) -> Option<(Choice, Side)> {
        let found = Findings { best: None, best_forbidden: None };
        let mut hunt = CircleSearch { rule, keeps_forbidden: false, is_coarse: false, found };
        self.look_around(headings, &mut hunt);
        hunt.found.best.map(|(choice, (_, side))| (choice, side))
    }

    fn look_around<R: DirectionRule>(
        &mut self,
        [left, right]: [Heading; 2],
        hunt: &mut CircleSearch<'_, R>,
    ) {
        let (grid, fan, site) = (self.dynamics.grid(), self.dynamics.fan(), self.pose.site);
        let spacing = NonZeroU32::new(fan.spacing.0).map_or(LEAST, |spacing| spacing.max(LEAST));
        hunt.is_coarse = fan.spacing.0 > COARSE;
        let arm = |heading, side, first, end| {
            let pose = Pose { site, heading };
            Arm { pose, side, spacing, first, end }
        };
        let mut arms =
            [arm(left, Side::Left, 0, fan.left), arm(right, Side::Right, 1, fan.right + 1)];
        for speed in (1..grid.speeds()).rev() {
            let straight_ahead = || self.weight.objective(grid.reach_mm(speed), 0);
            let best = hunt.found.best.as_ref();
            if arms.iter().all(Arm::is_empty)
                || best.is_some_and(|(best, _)| straight_ahead() < best.objective)
                || !self.view.enter_circle(speed)
                || speed.is_multiple_of(4) && !self.effort.take(4)
            {
                break;
            }
            if let Some([left, right]) = self.dynamics.rays_at(speed) {
                let [on_left, on_right] = &mut arms;
                on_left.end = on_left.end.min(left);
                on_right.end = on_right.end.min(right.saturating_add(1));
            }
            for arm in &mut arms {
                self.search_arm(arm, speed, hunt);
            }
        }
    }

    /// Finds the first ray of an arm whose end on a circle will do, if that is better than the best so
    /// far.
    fn search_arm<R: DirectionRule>(
        &mut self,
        arm: &mut Arm,
        speed: u16,
        hunt: &mut CircleSearch<'_, R>,
    ) {
        let (pose, side, spacing) = (arm.pose, arm.side, arm.spacing);
        let mut next = arm.first;
        while next < arm.end {
            match self.judge(pose, (next, side), speed, hunt) {
                EndVerdict::Infeasible { turn, on_inner_circles_too } => {
                    // Rays within the turn are like this one.
                    let after = next + turn / spacing + 1;
                    if on_inner_circles_too {
                        arm.leave_out(next, after);
                    }
                    next = after;
                }
                EndVerdict::Best | EndVerdict::NoneBetter => return,
            }
        }
    }

    /// The verdict on a ray from a pose: by the view if that decides, and else by the ray's end.
    fn judge<R: DirectionRule>(
        &mut self,
        pose: Pose,
        rank: Rank,
        speed: u16,
        hunt: &mut CircleSearch<'_, R>,
    ) -> EndVerdict {
        let (n, side) = rank;
        let heading = self.dynamics.heading(pose, side, n);
        if let Some((turn, on_inner_circles_too)) = self.infeasible_until(heading, side) {
            return EndVerdict::Infeasible { turn, on_inner_circles_too };
        }
        let Some(looks) = self.effort.looks.checked_sub(1) else { return EndVerdict::NoneBetter };
        self.effort.looks = looks;
        let (grid, ray) = (self.dynamics.grid(), self.dynamics.ray(pose, side, n));
        let objective = self.weight.objective(grid.reach_mm(speed), ray.turn_cost);
        if !is_better(objective, rank, hunt.found.best.as_ref()) {
            return EndVerdict::NoneBetter;
        }
        let is_allowed = hunt.rule.admits(ray.step);
        let is_wanted = is_allowed
            || hunt.keeps_forbidden
                && is_better(objective, rank, hunt.found.best_forbidden.as_ref());
        if is_wanted {
            let target = match self.worthwhile_end(pose, &ray, speed, hunt.is_coarse) {
                Ok(target) => target,
                Err(turn) => return EndVerdict::Infeasible { turn, on_inner_circles_too: false },
            };
            let action = grid.action(ray.index, speed);
            let choice = Some((Choice { action, target, objective }, rank));
            let Findings { best, best_forbidden } = &mut hunt.found;
            *(if is_allowed { best } else { best_forbidden }) = choice;
        }
        if is_allowed {
            return EndVerdict::Best;
        }
        let turn = hunt.rule.forbidden_until(heading, ray.step, side);
        EndVerdict::Infeasible { turn, on_inner_circles_too: true }
    }

    /// The turn within which no ray will do as far as the view decides, and whether that holds on inner circles too.
    #[inline]
    fn infeasible_until(&mut self, heading: Heading, side: Side) -> Option<(u32, bool)> {
        if let Some(turn) = self.view.leaves_area_until(heading, side) {
            return Some((turn, true));
        }
        if let Some((label, turn)) = self.view.certain_until(heading, side) {
            return Some((turn, self.view.own_label() == Certainty::Certain(label)));
        }
        self.view.outside_until(heading, side).map(|turn| (turn, false))
    }

    /// The pose at a ray's end, if a label there can tell something. The end and the way there must lie inside the
    /// area, and the vehicle must be able to stay inside afterwards. Otherwise returns a turn: the search assumes that
    /// no ray within it is better.
    fn worthwhile_end(
        &mut self,
        pose: Pose,
        ray: &Ray,
        speed: u16,
        is_coarse: bool,
    ) -> Result<Pose, u32> {
        let target = self.dynamics.arrive(pose, ray, speed).map_err(|_| 0_u32)?;
        self.effort.examined += 1;
        let area = self.view.area();
        if !area.contains(target.site) {
            // Where a rectangle ends is seen before. Of other areas it may not be.
            let is_plain = area.sides().next().is_none() && area.is_open();
            return Err(if is_plain { 0 } else { HEMMED_IN });
        }
        if !self.view.can_cut(target.site) {
            return Err(if is_coarse { 0 } else { self.view.passed_over(target.site) });
        }
        // The way, and two circles at most.
        self.effort.take(2 * sweep(self.view.area(), &[pose.site, target.site]));
        if !self.dynamics.keeps_inside(
            pose,
            target,
            self.view.area(),
            room_for_errors(self.view.area()),
        ) {
            self.is_hemmed_in = true;
            return Err(HEMMED_IN);
        }
        Ok(target)
    }
}
