//! The recovery ladder, for when a one-step problem has no feasible action.
//!
//! The paper is silent here, and P1 comes to it once in some fourteen steps. In this order:
//!
//! 1. *Undirected*: the same problem without its rule on directions.
//! 2. *Reorient*: turn in place, the fewest sharpest turns after which (1) is feasible; of left and
//!    right, the one with the better action afterwards. No sample is taken.
//! 3. *Transit*: drive straight through certain ground, at full speed, to the nearest pose (counted
//!    in motions, turns included) from which (1) is feasible. Eight bearings are considered: along
//!    the bisector of the slope arc both ways, across it both ways, and between.
//! 4. Nothing: the resolution of the action grid is reached.
//!
//! Neither a turn nor a transit changes what is known, and each brings the pose it leads to one
//! motion nearer, so asking afresh at every step finishes what was begun: the ladder has no state.

use crate::action::Action;
use crate::dynamics::{Dynamics, Pose};
use crate::lattice::Vector;
use crate::planner::Recovery;
use crate::problem::{AnyDirection, DirectionRule, Problem};

/// A transit looks this many motions ahead.
const HORIZON: u32 = 32;

/// An action, where it leads, and the rung on which it was found.
pub(crate) struct Found {
    pub(crate) recovery: Option<Recovery>,
    pub(crate) action: Action,
    pub(crate) target: Pose,
}

/// The problem's best action, or the ladder's; `None` when there is neither. Adds the actions that
/// were looked at to `examined`.
pub(crate) fn solve_or_recover<D: Dynamics, R: DirectionRule, const E: usize>(
    problem: &Problem<'_, R, E>,
    dynamics: &D,
    pose: Pose,
    examined: &mut u32,
) -> Option<Found> {
    let undirected = problem.with_rule(AnyDirection);
    let mut ladder = Ladder { problem: undirected, dynamics, examined };
    let found = |recovery| move |(action, target)| Found { recovery, action, target };
    ladder
        .solve(problem, pose)
        .map(|(motion, _)| found(None)(motion))
        .or_else(|| {
            let (motion, _) = ladder.solve(&undirected, pose)?;
            Some(found(Some(Recovery::Undirected))(motion))
        })
        .or_else(|| ladder.reorient(pose).map(found(Some(Recovery::Reorient))))
        .or_else(|| ladder.transit(pose).map(found(Some(Recovery::Transit))))
}

/// An action and where it leads.
type Leg = (Action, Pose);

struct Ladder<'a, D, const E: usize> {
    /// The problem without its rule on directions.
    problem: Problem<'a, AnyDirection, E>,
    dynamics: &'a D,
    examined: &'a mut u32,
}

impl<D: Dynamics, const E: usize> Ladder<'_, D, E> {
    /// The best action of a problem and its objective.
    fn solve<R: DirectionRule>(
        &mut self,
        problem: &Problem<'_, R, E>,
        pose: Pose,
    ) -> Option<(Leg, i64)> {
        let search = problem.solve(self.dynamics, pose);
        *self.examined += search.examined;
        search.best.map(|best| ((best.action, best.target), best.objective))
    }

    /// What the undirected problem is worth from a pose.
    fn worth(&mut self, pose: Pose) -> Option<i64> {
        let undirected = self.problem;
        self.solve(&undirected, pose).map(|(_, objective)| objective)
    }

    fn reorient(&mut self, pose: Pose) -> Option<Leg> {
        const HALF_TURN: u32 = 1 << 31;
        let left = self.dynamics.turn_in_place(pose, true)?;
        let right = self.dynamics.turn_in_place(pose, false)?;
        let sharpest = left.1.heading.0.wrapping_sub(pose.heading.0);
        let (mut to_left, mut to_right, mut turned) = (left.1, right.1, sharpest);
        while turned <= HALF_TURN {
            let (on_left, on_right) = (self.worth(to_left), self.worth(to_right));
            if on_left.max(on_right).is_some() {
                return Some(if on_left >= on_right { left } else { right });
            }
            to_left = self.dynamics.turn_in_place(to_left, true)?.1;
            to_right = self.dynamics.turn_in_place(to_right, false)?.1;
            turned = turned.saturating_add(sharpest);
        }
        None
    }

    fn transit(&mut self, pose: Pose) -> Option<Leg> {
        let u = self.problem.ground.slope_arc().bisector();
        let l = u.left();
        let between = |a: Vector, b: Vector| Vector { x: a.x.midpoint(b.x), z: a.z.midpoint(b.z) };
        let diagonal = between(u, l);
        let mut nearest = None;
        let mut horizon = HORIZON;
        for bearing in [u, l, diagonal, diagonal.left()] {
            for bearing in [bearing, bearing.reversed()] {
                if let Some((leg, motions)) = self.approach(pose, bearing, horizon) {
                    (nearest, horizon) = (Some(leg), motions - 1);
                }
            }
        }
        nearest
    }

    /// The first leg of the straight drive on a bearing to where the undirected problem is
    /// feasible, and its number of motions, at most `horizon`.
    fn approach(&mut self, from: Pose, bearing: Vector, horizon: u32) -> Option<(Leg, u32)> {
        let mut first = None;
        let mut pose = from;
        for motions in 1..=horizon {
            let leg = self.leg(pose, bearing)?;
            first = first.or(Some(leg));
            pose = leg.1;
            if self.worth(pose).is_some() {
                return first.map(|leg| (leg, motions));
            }
        }
        None
    }

    /// One motion on a bearing: the drive along the nearest ray, or the turn that brings it nearer.
    fn leg(&self, pose: Pose, bearing: Vector) -> Option<Leg> {
        let grid = self.dynamics.grid();
        let ray = self.dynamics.rays(pose).max_by_key(|ray| ray.step.dot(bearing))?;
        let (dot, cross) = (ray.step.dot(bearing), ray.step.cross(bearing));
        if cross.abs() > dot / 8
            && let Some(turn) = self.dynamics.turn_in_place(pose, cross > 0)
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
