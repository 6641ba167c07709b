//! The motions of a manoeuvre: along the vehicle's circle, or straight on.
//!
//! Each motion of a safe vehicle ends safe, so the vehicle does not drive itself into a corner. If the vehicle is not
//! safe to begin with, an error has brought it there. Then motions may use the margin that the area keeps for errors,
//! and shorter motions that bulge less.

use crate::geometry::lattice::Vector;
use crate::geometry::workspace::Workspace;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Side, TurningCircle, room_for_errors};
use crate::search::objective::Effort;

/// An action and where it leads.
pub(crate) type Leg = (Action, Pose);

/// Where all motions begin.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum StartGround {
    /// Inside the area, with a circle to one side to stay on for ever.
    Safe,
    /// Inside with no such circle, or where an error has brought it: within the margin.
    Unsafe,
    /// Outside: motions may be so too.
    Outside,
}

/// The motions from poses that a vehicle comes to.
pub(crate) struct Motions<'d, 'p, D, G> {
    pub(crate) dynamics: &'d D,
    pub(crate) area: &'p G,
    pub(crate) start: StartGround,
    /// Where motions stay.
    ground: G,
    /// From outside: how far inside motions end at least; negative.
    pub(crate) depth: i32,
    pub(crate) effort: Effort,
}

impl<'d, 'p, D: Dynamics, G: Workspace> Motions<'d, 'p, D, G> {
    pub(crate) fn new(dynamics: &'d D, area: &'p G, from: Pose, effort: Effort) -> Self {
        let whole = area.whole();
        let start = match area.contains(from.site) {
            true if dynamics.is_safe(from, area) => StartGround::Safe,
            _ if whole.contains(from.site) => StartGround::Unsafe,
            _ => StartGround::Outside,
        };
        let depth = whole.depth(from.site);
        let ground = if start == StartGround::Safe { *area } else { whole };
        Self { dynamics, area, start, ground, depth, effort }
    }

    /// The motion along the vehicle's circle to a side. If that would leave the area, and the vehicle is not safe
    /// either way, a shorter motion is used, as it bulges less. It is the longest of the sharpest ones that stays
    /// inside.
    pub(crate) fn round(&mut self, pose: Pose, side: Side) -> Option<Leg> {
        let (dynamics, grid) = (self.dynamics, self.dynamics.grid());
        let action = side.of(dynamics.turning_circles(pose)?).action;
        let after = dynamics.target(pose, action)?;
        if self.stays(pose, after)
            && (self.start == StartGround::Outside || self.may_hold(pose, after, side))
        {
            return Some((action, after));
        }
        if dynamics.is_safe(pose, self.area) {
            return None;
        }
        let (_, speed) = grid.split(action);
        (1..speed).rev().find_map(|speed| {
            if !self.effort.is_enough() {
                return None;
            }
            let [left, right] = dynamics.rays_at(speed)?;
            let n = if side == Side::Left { left.saturating_sub(1) } else { right };
            let ray = (n > 0).then(|| dynamics.ray(pose, side, n))?;
            let after = dynamics.arrive(pose, &ray, speed).ok()?;
            self.stays(pose, after).then(|| (grid.action(ray.index, speed), after))
        })
    }

    /// The longest motion straight ahead that ends safe, or from where the vehicle is not safe, inside.
    pub(crate) fn straight(&mut self, pose: Pose) -> Option<Leg> {
        let (dynamics, area, grid) = (self.dynamics, self.area, self.dynamics.grid());
        let (is_safe, room) = (dynamics.is_safe(pose, area), self.room(pose));
        let ray = dynamics.ray(pose, Side::Left, 0);
        let mut otherwise = None;
        for speed in (1..grid.speeds()).rev() {
            if !self.effort.is_enough() {
                break;
            }
            let Ok(after) = dynamics.arrive(pose, &ray, speed) else { continue };
            if !self.stays(pose, after) {
                continue;
            }
            // A fan never grows as the speed falls.
            if dynamics.rays_at(speed).is_some_and(|[left, _]| left == 0) {
                break;
            }
            let leg = (grid.action(ray.index, speed), after);
            // Of a safe vehicle it is known by now that the motion stays inside.
            let is_inside = self.start == StartGround::Safe
                || area.contains(after.site) && dynamics.stays_inside(pose, after, area);
            if is_inside && dynamics.ends_safe(after, area, room) {
                return Some(leg);
            }
            otherwise = otherwise.or(Some(leg));
        }
        if is_safe { None } else { otherwise }
    }

    /// Several of the fastest motions straight ahead at once, no further than `free`, and how many they are. The vehicle
    /// is safe all along.
    pub(crate) fn straight_on(&mut self, pose: Pose, free: f32) -> Option<(Leg, u32)> {
        let grid = self.dynamics.grid();
        let fastest = grid.speeds().saturating_sub(1);
        let ray = self.dynamics.ray(pose, Side::Left, 0);
        let mut count = (free / (f32::from(fastest) * grid.step_units())) as u32;
        while count > 1 {
            if let Some(after) = self.advance(pose, ray.displacement(fastest), count) {
                return Some(((grid.action(ray.index, fastest), after), count));
            }
            count /= 2;
        }
        None
    }

    /// Where so many motions straight ahead lead, if the vehicle's circle to one side stays inside all along.
    fn advance(&mut self, pose: Pose, by: Vector, count: u32) -> Option<Pose> {
        let (area, room) = (self.area, self.room(pose));
        let times = |v: i32| v.checked_mul(count as i32);
        let by = Vector::new(times(by.x)?, times(by.z)?)?;
        let after = Pose { site: pose.site.step(by).ok()?, ..pose };
        self.effort.take(2);
        self.effort.take_sweep(area, &[pose.site, after.site]);
        let is_clear = |circle: TurningCircle| {
            let radius = circle.with_room(room);
            let centres = [pose, after].map(|it| it.site.step(circle.centre));
            let [Ok(from), Ok(to)] = centres else { return false };
            area.contains_disc(from, radius)
                && area.contains_disc(to, radius)
                && area.is_clear(&[from, to], radius.unsigned_abs())
        };
        let stays = area.contains(after.site)
            && area.lets_pass(&[pose.site, after.site])
            && self.dynamics.turning_circles(pose).is_some_and(|it| it.into_iter().any(is_clear));
        stays.then_some(after)
    }

    /// Whether a motion stays where motions may go, or from outside ends no further out than it may; and touches no
    /// keep-out.
    fn stays(&mut self, pose: Pose, after: Pose) -> bool {
        let ground = &self.ground;
        self.effort.take(1);
        self.effort.take_sweep(ground, &[pose.site, after.site]);
        let ends = ground.encloses(after.site)
            || self.start == StartGround::Outside && ground.depth(after.site) >= self.depth;
        ends && ground.confines(pose.site, after.site)
            && self.dynamics.stays_inside(pose, after, ground)
    }

    /// Whether a safe vehicle stays safe after one more motion round to a side. It does on the circle that it follows,
    /// wherever rounding has moved that, or with a margin.
    fn may_hold(&self, pose: Pose, after: Pose, side: Side) -> bool {
        let (dynamics, area) = (self.dynamics, self.area);
        let fits = |circle: TurningCircle| circle.is_inside(after.site, area, circle.radius);
        !dynamics.is_safe(pose, area)
            || dynamics.keeps_inside(pose, after, area, self.room(pose))
            || dynamics.turning_circles(after).is_some_and(|circles| fits(side.of(circles)))
    }

    /// The room that a motion must leave around its circle, lattice units. It is 0 if the circle at the beginning has
    /// no such room either.
    fn room(&self, from: Pose) -> i32 {
        let room = room_for_errors(self.area);
        let has_room = room > 0 && self.dynamics.keeps_inside(from, from, self.area, room);
        if has_room { room } else { 0 }
    }
}
