//! The recovery ladder, for when a one-step problem has no feasible action.
//!
//! The paper is silent here, and P1 comes to it once in some fourteen steps. In this order:
//!
//! 1. *Undirected*: the same problem without its rule on directions.
//! 2. *Transit, far*: where no uncertain ground of the area is within reach, the way to the nearest:
//!    drives that bring it nearer by an eighth of their length at least, or the fewest turns in place
//!    after which there is such a drive. No sample is taken.
//! 3. *Reorient*: turn in place, the fewest sharpest turns after which (1) is feasible beyond them; of
//!    left and right, the one with the better action there. No sample is taken.
//! 4. *Transit, near*: some is within reach and yet no action hits it: to the nearest pose (counted in
//!    motions, 16 at most) from which (1) is feasible, and that leaves the reach of uncertain ground
//!    nowhere. Eight bearings are considered, along the bisector of the slope arc both ways, across
//!    it both ways, and between.
//! 5. Nothing: a [`StopReason`].
//!
//! **It ends**, though it has no state. What is known does not change before the next sample, and each
//! motion lowers a measure: far, the distance to uncertain ground and then the turns to the next drive;
//! near, the turns of (3), or where it has none the motions of (4), which stay near. What is near never
//! becomes far again.

use crate::geometry::approximate::sqrt;
use crate::geometry::direction::Heading;
use crate::geometry::lattice::Vector;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Ray, Side};
use crate::planner::{Recovery, StopReason};
use crate::search::direction_rule::{ArcRule, DirectionRule};
use crate::search::problem::{Effort, Problem};
use crate::search::view::Sight;

/// A transit among uncertain ground looks this many motions ahead. Twice as many find nothing more in
/// 1,000 standard missions of 60 steps.
const HORIZON: u32 = 16;

/// A heading this far from a bearing drives along it, as a binary angle: 1/8 rad.
const ALONG: u32 = 85_445_659;

/// Turns in place that a leg considers one after the other, even where fewer are half a turn, if rays are
/// so few that each turn brings others.
const TURNS: u32 = 8;

const HALF_TURN: u32 = 1 << 31;

/// An action, where it leads, and the rung on which it was found.
pub(crate) struct Found {
    pub(crate) recovery: Option<Recovery>,
    pub(crate) action: Action,
    pub(crate) target: Pose,
}

/// The problem's best action from a pose that all of this is seen from, or the ladder's.
///
/// # Errors
/// Why there is neither.
pub(crate) fn solve_or_recover<D: Dynamics, R: DirectionRule>(
    problem: &Problem<'_, R>,
    dynamics: &D,
    pose: Pose,
    sight: &mut Sight<'_>,
) -> Result<Found, StopReason> {
    let found = |recovery| move |(action, target)| Found { recovery, action, target };
    if let Some(best) = sight.best(dynamics, pose.heading, problem.varrho, &problem.rule) {
        return Ok(found(None)((best.action, best.target)));
    }
    if let Some((best, _)) = sight.barred {
        return Ok(found(Some(Recovery::Undirected))((best.action, best.target)));
    }
    let ladder = Ladder { problem: problem.undirected(), dynamics };
    // Where nothing is in reach no turn finds anything, so that the order does not matter.
    if let Some(turn) = ladder.reorient(sight, pose) {
        return Ok(found(Some(Recovery::Reorient))(turn));
    }
    let way = sight.way_out().ok_or(StopReason::Resolution)?;
    let leg = if sight.is_far(way) {
        ladder.leg(&mut sight.effort, pose, way).ok_or(StopReason::Cornered)
    } else {
        ladder.transit(sight, pose)
    };
    leg.map(found(Some(Recovery::Transit)))
}

/// An action and where it leads.
type Leg = (Action, Pose);

/// What comes of following a bearing.
enum Approach {
    /// Its first leg, and the number of motions to where the undirected problem is feasible.
    Feasible(Leg, u32),
    /// It is feasible nowhere on it.
    Fruitless,
    /// There is no such drive.
    Blocked,
}

struct Ladder<'a, D> {
    /// The problem without its rule on directions.
    problem: Problem<'a, ArcRule>,
    dynamics: &'a D,
}

impl<D: Dynamics> Ladder<'_, D> {
    fn reorient(&self, sight: &mut Sight<'_>, pose: Pose) -> Option<Leg> {
        let (dynamics, problem) = (self.dynamics, &self.problem);
        let left = dynamics.turn_in_place(pose, Side::Left)?;
        let right = dynamics.turn_in_place(pose, Side::Right)?;
        let sharpest = left.1.heading.0.wrapping_sub(pose.heading.0);
        // What lies ahead is known by now: after each turn, what lies beyond it.
        let (mut to, mut turned) = ([left.1, right.1], sharpest);
        while turned < HALF_TURN && sight.effort.is_enough() {
            sight.effort.looks -= 1;
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

    fn transit(&self, sight: &mut Sight<'_>, pose: Pose) -> Result<Leg, StopReason> {
        let u = self.problem.ground.slope_arc().bisector();
        let l = u.left();
        let between = |a: Vector, b: Vector| Vector { x: a.x.midpoint(b.x), z: a.z.midpoint(b.z) };
        let diagonal = between(u, l);
        let (mut nearest, mut horizon) = (None, HORIZON);
        let mut otherwise = StopReason::Cornered;
        for bearing in [u, l, diagonal, diagonal.left()] {
            for bearing in [bearing, bearing.reversed()] {
                match self.approach(sight, pose, bearing, horizon) {
                    Approach::Feasible(leg, motions) => {
                        (nearest, horizon) = (Some(leg), motions - 1);
                    }
                    Approach::Fruitless => otherwise = StopReason::Resolution,
                    Approach::Blocked => {}
                }
            }
        }
        if !sight.effort.is_enough() {
            otherwise = StopReason::Undecided;
        }
        nearest.ok_or(otherwise)
    }

    /// The straight drive in a direction, of at most `horizon` motions, to where the undirected problem
    /// is feasible.
    fn approach(
        &self,
        sight: &mut Sight<'_>,
        from: Pose,
        direction: Vector,
        horizon: u32,
    ) -> Approach {
        let mut first = None;
        let mut pose = from;
        for motions in 1..=horizon {
            let Some(leg) = self.leg(&mut sight.effort, pose, direction) else { break };
            let first = *first.get_or_insert(leg);
            // What turns in place lead to is known from the reorientation: nothing.
            if leg.1.site != pose.site {
                let grid = self.dynamics.grid();
                let mut there = self.problem.sight(leg.1.site, grid, sight.effort);
                let there = there.open();
                if there.way_out().is_none_or(|way| there.is_far(way)) {
                    break;
                }
                let Problem { varrho, rule, .. } = &self.problem;
                let best = there.best(self.dynamics, leg.1.heading, *varrho, rule);
                sight.effort = there.effort;
                if best.is_some() {
                    return Approach::Feasible(first, motions);
                }
            }
            pose = leg.1;
        }
        if first.is_some() { Approach::Fruitless } else { Approach::Blocked }
    }

    /// One motion on the way to a point: the drive that brings it nearer, or the first of the fewest
    /// turns in place after which there is one.
    fn leg(&self, effort: &mut Effort, pose: Pose, goal: Vector) -> Option<Leg> {
        let bearing = Heading::near(goal);
        let coarse = self.dynamics.fan().spacing.0 / 2 > ALONG;
        match self.drive(pose, bearing, goal) {
            Drive::Leg(leg) => return Some(leg),
            Drive::Blocked if !coarse => return None,
            _ => {}
        }
        let off = bearing.0.wrapping_sub(pose.heading.0) as i32;
        let sides = if off > 0 { [Side::Left, Side::Right] } else { [Side::Right, Side::Left] };
        let first = self.dynamics.turn_in_place(pose, sides[0])?;
        let sharpest = (first.1.heading.0.wrapping_sub(pose.heading.0) as i32).unsigned_abs();
        let (mut after, mut turned, mut turns) = ([pose; 2], 0_u32, 0);
        while (turned < HALF_TURN || coarse && turns < TURNS) && effort.is_enough() {
            effort.looks -= 1;
            for (side, after) in sides.into_iter().zip(&mut after) {
                *after = self.dynamics.turn_in_place(*after, side)?.1;
                match self.drive(*after, bearing, goal) {
                    Drive::Leg(_) => return self.dynamics.turn_in_place(pose, side),
                    Drive::Blocked if !coarse => return None,
                    _ => {}
                }
            }
            (turned, turns) = (turned.saturating_add(sharpest), turns + 1);
        }
        None
    }

    /// The fastest drive that brings a point nearer, if its bearing lies within the fan: along the
    /// nearest ray, or along the one on the other side of the bearing.
    fn drive(&self, pose: Pose, bearing: Heading, goal: Vector) -> Drive {
        let grid = self.dynamics.grid();
        let rays = self.dynamics.around(pose, bearing);
        let aside = bearing.0.wrapping_sub(rays[0].heading.0) as i32;
        if aside.unsigned_abs() > ALONG.max(self.dynamics.fan().spacing.0 / 2) {
            return Drive::Beyond;
        }
        for ray in rays {
            for speed in (1..grid.speeds()).rev().filter(|speed| nears(&ray, *speed, goal)) {
                if let Ok(target) = ray.arrive(pose.site, speed)
                    && self.problem.area.contains(target.site)
                {
                    return Drive::Leg((grid.action(ray.index, speed), target));
                }
            }
        }
        Drive::Blocked
    }
}

/// What comes of one drive on a bearing.
enum Drive {
    /// It brings its goal nearer.
    Leg(Leg),
    /// No ray leads that way: a turn may help.
    Beyond,
    /// The rays that lead that way leave the area, or are too long.
    Blocked,
}

/// Whether a drive brings a point nearer by an eighth of its own length at least.
fn nears(ray: &Ray, speed: u16, goal: Vector) -> bool {
    let drive = ray.displacement(speed);
    let square = |v: Vector| v.dot(v) as f32;
    // |goal - drive| <= |goal| - |drive| / 8 follows from this.
    let length = sqrt(square(drive));
    drive.dot(goal) as f32 >= length * (length / 2.0 + sqrt(square(goal)) / 8.0)
}
