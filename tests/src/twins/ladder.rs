//! The slow twin of the recovery ladder's turns and transits: every action is tried at every pose, and
//! distances are measured by clipping lines, in double precision.

use host_sim::world::polygon::Polygon;
use nalgebra::Point2;
use planner_core::dynamics::{Action, Dynamics, Ray, Side};
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::parts::{ArcRule, Problem};
use planner_core::{Certainty, Line, Pose, Recovery, Site, StopReason, Vector, Workspace};

/// Motions that a transit among uncertain ground looks ahead.
const HORIZON: u32 = 16;

/// The result of the ladder if even the undirected problem has no feasible action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rung {
    /// Uncertain ground is out of reach, at this distance in metres: some motion that leads towards it.
    Far(f64),
    /// This action.
    Take(Recovery, Action),
    /// Nothing.
    Stop(StopReason),
}

/// The ladder of a problem without a rule.
pub struct Ladder<'a, D, G> {
    /// The problem.
    pub problem: Problem<'a, ArcRule, G>,
    /// The action set.
    pub dynamics: &'a D,
}

impl<D: Dynamics, G: Workspace> Ladder<'_, D, G> {
    /// The distance in metres from a site to the nearest uncertain ground inside the area.
    pub fn distance(&self, site: Site) -> Option<f64> {
        let from = Point2::<f64>::from(site);
        let area = Polygon::from(self.problem.area.bounds());
        let to = |line: Line| {
            let part = area.clip(&line, 1.0);
            let ends: Vec<_> =
                part.0.into_iter().filter(|p| line.distance(*p).abs() < 1e-7).collect();
            let (a, b) = (*ends.first()?, *ends.last()?);
            let along = b - a;
            let t = (from - a).dot(&along) / along.norm_squared().max(1e-12);
            Some((a + along * t.clamp(0.0, 1.0) - from).norm())
        };
        let all = self.problem.lines.bounds().filter_map(|bound| to(bound.into()));
        all.min_by(f64::total_cmp)
    }

    /// The rung that is taken from a pose.
    pub fn rung(&self, pose: Pose) -> Rung {
        let Some(distance) = self.distance(pose.site) else {
            return Rung::Stop(StopReason::Resolution);
        };
        if self.is_far(pose.site, distance) {
            return Rung::Far(distance);
        }
        match self.reorient(pose) {
            Some(turn) => Rung::Take(Recovery::Reorient, turn),
            None => self.transit(pose),
        }
    }

    fn is_far(&self, site: Site, distance: f64) -> bool {
        let grid = self.dynamics.grid();
        let certain = self.problem.lines.certainty(site) != Certainty::Uncertain;
        certain && distance > 1.0001 * f64::from(grid.reach_m(grid.speeds() - 1))
    }

    fn is_feasible(&self, pose: Pose) -> bool {
        self.problem.solve_exhaustively(self.dynamics, pose).best.is_some()
    }

    /// The best action beyond a turn: its objective, then a number that is smaller the further the action turns.
    fn beyond(&self, pose: Pose, side: Side) -> Option<(i64, i64)> {
        let Problem { lines, area, weight, .. } = self.problem;
        let grid = self.dynamics.grid();
        let turn = |ray: &Ray| {
            let left = ray.heading.0.wrapping_sub(pose.heading.0) as i32;
            i64::from(if side == Side::Left { left } else { -left })
        };
        let rays = self.dynamics.rays(pose).filter(|ray| turn(ray) >= 0);
        let actions = rays.flat_map(|ray| (1..grid.speeds()).map(move |speed| (ray, speed)));
        let feasible = actions.filter(|(ray, speed)| {
            self.dynamics.arrive(pose, ray, *speed).is_ok_and(|it| {
                area.contains(it.site) && lines.certainty(it.site) == Certainty::Uncertain
            })
        });
        let values = feasible.map(|(ray, speed)| {
            let (reach, w) = (f64::from(grid.reach_mm(speed)), f64::from(ray.turn_cost));
            let value = (1.0 - weight.value()) * reach * reach - weight.value() * w;
            ((1e6 * value).round() as i64, -turn(&ray))
        });
        values.max()
    }

    /// After the fewest turns, to the side with the better action beyond.
    fn reorient(&self, pose: Pose) -> Option<Action> {
        let mut to = [(Side::Left, pose), (Side::Right, pose)];
        let mut first = [None; 2];
        loop {
            for ((side, pose), first) in to.iter_mut().zip(&mut first) {
                let (action, after) = self.dynamics.turn_in_place(*pose, *side)?;
                first.get_or_insert(action);
                *pose = after;
            }
            if to[0].1.heading.0.wrapping_sub(pose.heading.0) >= 1 << 31 {
                return None; // the back has been seen from both sides
            }
            let [left, right] = to.map(|(side, pose)| self.beyond(pose, side));
            if left.is_some() || right.is_some() {
                return if left >= right { first[0] } else { first[1] };
            }
        }
    }

    fn transit(&self, pose: Pose) -> Rung {
        let u = self.problem.lines.slope_arc().bisector();
        let half = |v: Vector, w: Vector| {
            Vector::new(v.x().midpoint(w.x()), v.z().midpoint(w.z())).expect("between the two")
        };
        let axes = [u, u.left(), half(u, u.left()), half(u, u.left()).left()];
        let bearings = axes.into_iter().flat_map(|axis| [axis, axis.reversed()]);
        let mut best: Option<(u32, Action)> = None;
        let mut moved = false;
        for bearing in bearings {
            let (first, motions) = self.approach(pose, bearing);
            moved |= first.is_some();
            if let (Some(first), Some(motions)) = (first, motions)
                && best.is_none_or(|(least, _)| motions < least)
            {
                best = Some((motions, first));
            }
        }
        match best {
            Some((_, action)) => Rung::Take(Recovery::Transit, action),
            None if moved => Rung::Stop(StopReason::Resolution),
            None => Rung::Stop(StopReason::Cornered),
        }
    }

    /// The first action of a drive, and its motions up to where the problem is feasible.
    fn approach(&self, from: Pose, direction: Vector) -> (Option<Action>, Option<u32>) {
        let (mut first, mut pose) = (None, from);
        for motions in 1..=HORIZON {
            let Some(action) = self.leg(pose, direction) else { break };
            first.get_or_insert(action);
            let after = self.dynamics.target(pose, action).expect("an action of the grid");
            if after.site != pose.site {
                let distance = self.distance(after.site);
                if distance.is_none_or(|it| self.is_far(after.site, it)) {
                    break;
                }
                if self.is_feasible(after) {
                    return (first, Some(motions));
                }
            }
            pose = after;
        }
        (first, None)
    }

    /// The first action towards a direction, for fans whose rays are dense.
    fn leg(&self, pose: Pose, direction: Vector) -> Option<Action> {
        if self.is_within_fan(pose, direction) {
            return self.drive(pose, direction);
        }
        let ahead = angle(pose, direction);
        let sides = if ahead > 0.0 { [Side::Left, Side::Right] } else { [Side::Right, Side::Left] };
        let (mut after, mut firsts) = ([pose; 2], [None; 2]);
        loop {
            for ((side, after), first) in sides.into_iter().zip(&mut after).zip(&mut firsts) {
                let (action, turned) = self.dynamics.turn_in_place(*after, side)?;
                first.get_or_insert(action);
                *after = turned;
                if self.is_within_fan(turned, direction) {
                    return self.drive(turned, direction).and(*first);
                }
            }
        }
    }

    /// All rays, the nearest to a direction first, each with its angle to that.
    fn by_angle(&self, pose: Pose, direction: Vector) -> Vec<(f64, Ray)> {
        let off = |ray: &Ray| angle(Pose { heading: ray.heading, ..pose }, direction);
        let mut rays: Vec<_> = self.dynamics.rays(pose).map(|ray| (off(&ray), ray)).collect();
        rays.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        rays
    }

    fn is_within_fan(&self, pose: Pose, direction: Vector) -> bool {
        self.by_angle(pose, direction)[0].0.abs() <= 0.125
    }

    fn drive(&self, pose: Pose, direction: Vector) -> Option<Action> {
        let grid = self.dynamics.grid();
        let rays = self.by_angle(pose, direction);
        let (nearest, _) = rays[0];
        let across = rays.iter().find(|(off, _)| (*off > 0.0) != (nearest > 0.0));
        rays.first().into_iter().chain(across).find_map(|(off, ray)| {
            (1..grid.speeds()).rev().find_map(|speed| {
                let target = self.dynamics.arrive(pose, ray, speed).ok()?;
                let reach = f64::from(grid.reach_mm(speed)) / 1000.0;
                let goal = f64::hypot(direction.x().into(), direction.z().into())
                    / f64::from(UNITS_PER_METRE);
                let nears = off.cos() >= reach / (2.0 * goal) + 0.125;
                let inside = self.problem.area.contains(target.site);
                (nears && inside).then(|| grid.action(ray.index, speed))
            })
        })
    }
}

/// The angle from a pose's heading to a direction, radians in (-pi, pi].
fn angle(pose: Pose, direction: Vector) -> f64 {
    let (sin, cos) = pose.heading.radians().sin_cos();
    let (x, z) = (f64::from(direction.x()), f64::from(direction.z()));
    f64::atan2(cos * z - sin * x, cos * x + sin * z)
}
