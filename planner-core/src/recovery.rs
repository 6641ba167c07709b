//! The recovery ladder, for when a one-step problem has no feasible action.
//!
//! The paper is silent here, and P1 comes to it once in some fourteen steps. In this order:
//!
//! 1. *Undirected*: the same problem without its rule on directions.
//! 2. *Reorient*: turn in place, the fewest sharpest turns after which (1) is feasible beyond them; of
//!    left and right, the one with the better action there. No sample is taken.
//! 3. *Transit*: where all ground within reach is certain, the way to the nearest that is not, turns
//!    first and then at full speed. Where some is uncertain and yet no action hits it, to the nearest
//!    pose (counted in motions, 16 at most) from which (1) is feasible: eight bearings are considered,
//!    along the bisector of the slope arc both ways, across it both ways, and between.
//! 4. Nothing: the resolution of the action grid is reached.
//!
//! Neither a turn nor a transit changes what is known, and each brings the pose it leads to one
//! motion nearer, so asking afresh at every step finishes what was begun: the ladder has no state.

use crate::action::Action;
use crate::direction::Heading;
use crate::dynamics::{Dynamics, Pose, Side};
use crate::lattice::Vector;
use crate::planner::Recovery;
use crate::problem::Problem;
use crate::rule::{ArcRule, DirectionRule};
use crate::sight::Sight;

/// A transit among uncertain ground looks this many motions ahead. Twice as many find nothing more in
/// 1,000 standard missions of 60 steps.
const HORIZON: u32 = 16;

/// A heading this far from a bearing drives along it, as a binary angle: 1/8 rad.
const ALONG: u32 = 85_445_659;

/// An action, where it leads, and the rung on which it was found.
pub(crate) struct Found {
    pub(crate) recovery: Option<Recovery>,
    pub(crate) action: Action,
    pub(crate) target: Pose,
}

/// The problem's best action from a pose that all of this is seen from, or the ladder's; `None` when
/// there is neither.
pub(crate) fn solve_or_recover<D: Dynamics, R: DirectionRule>(
    problem: &Problem<'_, R>,
    dynamics: &D,
    pose: Pose,
    sight: &mut Sight<'_>,
) -> Option<Found> {
    let found = |recovery| move |(action, target)| Found { recovery, action, target };
    if let Some(best) = sight.best(dynamics, pose.heading, problem.varrho, &problem.rule) {
        return Some(found(None)((best.action, best.target)));
    }
    if let Some((best, _)) = sight.barred {
        return Some(found(Some(Recovery::Undirected))((best.action, best.target)));
    }
    let ladder = Ladder { problem: problem.undirected(), dynamics };
    if sight.is_clear() {
        let way = sight.way_out()?;
        return ladder.leg(pose, Heading::near(way)).map(found(Some(Recovery::Transit)));
    }
    let reorient = ladder.reorient(sight, pose).map(found(Some(Recovery::Reorient)));
    reorient.or_else(|| ladder.transit(sight, pose).map(found(Some(Recovery::Transit))))
}

/// An action and where it leads.
type Leg = (Action, Pose);

struct Ladder<'a, D> {
    /// The problem without its rule on directions.
    problem: Problem<'a, ArcRule>,
    dynamics: &'a D,
}

impl<D: Dynamics> Ladder<'_, D> {
    fn reorient(&self, sight: &mut Sight<'_>, pose: Pose) -> Option<Leg> {
        const HALF_TURN: u32 = 1 << 31;
        let (dynamics, problem) = (self.dynamics, &self.problem);
        let left = dynamics.turn_in_place(pose, Side::Left)?;
        let right = dynamics.turn_in_place(pose, Side::Right)?;
        let sharpest = left.1.heading.0.wrapping_sub(pose.heading.0);
        // What lies ahead is known by now: after each turn, what lies beyond it.
        let (mut to, mut turned) = ([left.1, right.1], sharpest);
        while turned < HALF_TURN {
            let headings = to.map(|pose| pose.heading);
            match sight.better_side(dynamics, headings, problem.varrho, &problem.rule) {
                Some(Side::Left) => return Some(left),
                Some(Side::Right) => return Some(right),
                None => {}
            }
            let [to_left, to_right] = to;
            to = [
                dynamics.turn_in_place(to_left, Side::Left)?.1,
                dynamics.turn_in_place(to_right, Side::Right)?.1,
            ];
            turned = turned.saturating_add(sharpest);
        }
        None
    }

    fn transit(&self, sight: &mut Sight<'_>, pose: Pose) -> Option<Leg> {
        let u = self.problem.ground.slope_arc().bisector();
        let l = u.left();
        let between = |a: Vector, b: Vector| Vector { x: a.x.midpoint(b.x), z: a.z.midpoint(b.z) };
        let diagonal = between(u, l);
        let mut nearest = None;
        let mut horizon = HORIZON;
        for bearing in [u, l, diagonal, diagonal.left()] {
            for bearing in [bearing, bearing.reversed()] {
                let bearing = Heading::near(bearing);
                if let Some((leg, motions)) = self.approach(sight, pose, bearing, horizon) {
                    (nearest, horizon) = (Some(leg), motions - 1);
                }
            }
        }
        nearest
    }

    /// The first leg of the straight drive on a bearing to where the undirected problem is
    /// feasible, and its number of motions, at most `horizon`.
    fn approach(
        &self,
        sight: &mut Sight<'_>,
        from: Pose,
        bearing: Heading,
        horizon: u32,
    ) -> Option<(Leg, u32)> {
        let mut first = None;
        let mut pose = from;
        for motions in 1..=horizon {
            let leg = self.leg(pose, bearing)?;
            first = first.or(Some(leg));
            // What turns in place lead to is known from the reorientation: nothing.
            if leg.1.site != pose.site {
                let mut there = self.problem.sight(leg.1.site, self.dynamics.grid());
                let Problem { varrho, rule, .. } = &self.problem;
                let best = there.best(self.dynamics, leg.1.heading, *varrho, rule);
                sight.examined += there.examined;
                if best.is_some() {
                    return first.map(|leg| (leg, motions));
                }
            }
            pose = leg.1;
        }
        None
    }

    /// One motion on a bearing: the drive along the nearest ray, or the turn that brings it nearer.
    fn leg(&self, pose: Pose, bearing: Heading) -> Option<Leg> {
        let grid = self.dynamics.grid();
        let ray = self.dynamics.towards(pose, bearing);
        let off = bearing.0.wrapping_sub(ray.heading.0) as i32;
        let side = if off > 0 { Side::Left } else { Side::Right };
        if off.unsigned_abs() > ALONG
            && let Some(turn) = self.dynamics.turn_in_place(pose, side)
        {
            return Some(turn);
        }
        let inside = |&speed: &u16| {
            let target = ray.arrive(pose.site, speed);
            target.is_ok_and(|target| self.problem.area.contains(target.site))
        };
        let speed = (1..grid.speeds()).rev().find(inside)?;
        Some((grid.action(ray.index, speed), ray.arrive(pose.site, speed).ok()?))
    }
}
