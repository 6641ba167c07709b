//! Dynamics: how an action moves the agent.
//!
//! The paper's one-step problem allows any `phi` and any finite action set. This module defines what the search needs
//! of them: the actions, grouped into [`Ray`]s that form a [`RayFan`]. [`Unicycle`](crate::motion::unicycle) is the
//! paper's dynamics, and [`Holonomic`](crate::motion::holonomic) is another.
//!
//! A vehicle that cannot turn on the spot has a [`TurningCircle`] to either side, the circle that it follows by repeating one
//! action. As long as that circle lies inside the area, the vehicle is never cornered. [`Car`](crate::motion::car)
//! drives along arcs, and [`Boat`](crate::motion::boat) turns a little in each step.

use core::num::NonZeroU32;

use nalgebra::Point2;

use crate::geometry::area::Area;
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{LatticeError, Site, UNITS_PER_METRE, Vector};
use crate::geometry::workspace::Workspace;
use crate::motion::action::{Action, ActionGrid, Control};

/// Where the agent is and where it faces: the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pose {
    /// Position.
    pub site: Site,
    /// Heading.
    pub heading: Heading,
}

impl Pose {
    /// At a place in metres, `[x, z]` or a point of `nalgebra`.
    ///
    /// # Errors
    /// [`LatticeError`] unless both coordinates are smaller than 8,192 m in size.
    pub fn at(place: impl Into<Point2<f64>>, heading: Heading) -> Result<Self, LatticeError> {
        Ok(Self { site: Site::metres(place)?, heading })
    }
}

/// The actions that share a direction of travel from a pose. For a vehicle that drives along arcs, it is the direction
/// of the chord.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ray {
    /// Which ray of the grid.
    pub index: u32,
    /// Heading of travel.
    pub heading: Heading,
    /// Displacement for one step of speed, in 2^-[`STEP_BITS`](Self::STEP_BITS) lattice units.
    pub step: Vector,
    /// The share of `|u|^2` that does not depend on the speed, 10^-6: a turn's square in mrad^2.
    pub turn_cost: u32,
}

impl Ray {
    /// Fractional bits of [`step`](Self::step).
    pub const STEP_BITS: u32 = ActionGrid::STEP_BITS;

    /// Displacement at a speed of the grid, to the nearest lattice units.
    pub fn displacement(&self, speed: u16) -> Vector {
        const HALF: i32 = 1 << (Ray::STEP_BITS - 1);
        // Whole units and the rest of each step apart, so that 32 bits hold any motion: see ActionGrid::LONGEST_MM.
        const REST: i32 = (1 << Ray::STEP_BITS) - 1;
        let k = i32::from(speed);
        let times = |step: i32| {
            let rest = (step & REST).wrapping_mul(k).wrapping_add(HALF) >> Self::STEP_BITS;
            (step >> Self::STEP_BITS).wrapping_mul(k).wrapping_add(rest)
        };
        Vector { x: times(self.step.x), z: times(self.step.z) }
    }
}

/// To which side of straight ahead a ray lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Side {
    /// Counter-clockwise. Straight ahead counts here.
    Left,
    /// Clockwise.
    Right,
}

impl Side {
    /// This side's of two things, the left one first.
    pub(crate) fn of<T>(self, [left, right]: [T; 2]) -> T {
        if self == Self::Left { left } else { right }
    }
}

/// The rays from a pose. They fan out from the 0th, straight ahead, to the left and to the right; see [`Dynamics`] for
/// the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RayFan {
    /// Rays to the left, the 0th included.
    pub left: u32,
    /// Rays to the right, without the 0th.
    pub right: u32,
    /// The turn from one to the next, at most.
    pub spacing: Angle,
}

/// The circle that a vehicle goes round by repeating one action, as seen from a pose on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TurningCircle {
    /// The action that is repeated.
    pub action: Action,
    /// Its centre from the pose's position, lattice units.
    pub centre: Vector,
    /// The whole way lies within this distance of the centre, its [corners](Dynamics::tangent_intersection) too;
    /// lattice units.
    pub radius: i32,
    /// How far rounding to the lattice may move the centre in one round; lattice units.
    pub margin: i32,
}

impl TurningCircle {
    /// Whether a disc about the circle's centre lies inside the area. `site` is the position from which the circle is
    /// seen, and `radius` that of the disc in lattice units.
    pub fn is_inside<G: Workspace>(&self, site: Site, area: &G, radius: i32) -> bool {
        site.step(self.centre).is_ok_and(|centre| area.contains_disc(centre, radius))
    }

    /// The sum of the radius, the margin and `room`, lattice units.
    pub(crate) fn with_room(&self, room: i32) -> i32 {
        self.radius.saturating_add(self.margin).saturating_add(room)
    }
}

/// The area is too small for the vehicle's [turning circle](TurningCircle).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoomError {
    /// The width that the circle needs, millimetres.
    pub across_mm: u32,
}

impl core::fmt::Display for RoomError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "an area with room for a turning circle {} mm across", self.across_mm)
    }
}

impl core::error::Error for RoomError {}

/// The agent's known dynamics over its finite action set (Section II-A's `phi` and `U`).
///
/// An action's squared control is its squared reach plus its ray's turn cost,
/// `|u|^2 = |zeta' - zeta|^2 + turn_cost`: for the unicycle `v^2 + w^2`, for an integrator `v^2`.
///
/// # Contract
///
/// The search skips rays without looking at them, so it relies on these promises, from every pose.
/// [`contract::check`](crate::motion::contract::check) tells which one an implementation breaks.
///
/// 1. The fan has the grid's number of rays, one at least on the left.
/// 2. On either side each ray turns further away from the 0th than the one before, by [`RayFan::spacing`] at most. The two
///    sides together turn by a whole turn at most.
/// 3. The turn cost never decreases from one ray of a side to the next, and the 0th's is the least of all.
/// 4. [`Ray::heading`] is [`heading`](Self::heading)'s, and [`Ray::step`] points there, as long as one
///    step of the grid's speed.
/// 5. Indices are those of the grid, each once, and [`ray_of`](Self::ray_of) gives the ray back.
/// 6. A turn in place keeps the position and turns to its side by less than a whole turn. It turns no further than the
///    fan reaches to that side, so the fans before and after leave no gap.
/// 7. [`rays_at`](Self::rays_at) is the whole fan at the fastest speed, never grows as the speed falls, and
///    [`ray_of`](Self::ray_of) knows just the actions that it has.
/// 8. [`arrive`](Self::arrive) leads one [`displacement`](Ray::displacement) from the pose. The way there lies in the
///    triangle of its two ends and its [`tangent_intersection`](Self::tangent_intersection). Without one, the way is the
///    straight line.
/// 9. Repeating the action of one of the [`turning_circles`](Self::turning_circles) turns to its side and stays within its
///    radius, and within its radius and margin for a round.
///
/// The search for the best action needs 1 to 5, 7 and 8, in each algorithm. If no action ends on uncertain ground, the
/// recovery ladder needs 6 or 9, unless the fan reaches all around. A vehicle that has neither ends its mission there.
pub trait Dynamics {
    /// The action set.
    fn grid(&self) -> ActionGrid;

    /// How the rays lie.
    fn fan(&self) -> RayFan;

    /// The heading of the `n`-th ray to a side of the fan; the 0th is the same on both.
    fn heading(&self, pose: Pose, side: Side, n: u32) -> Heading;

    /// The `n`-th ray to a side of the fan.
    fn ray(&self, pose: Pose, side: Side, n: u32) -> Ray;

    /// The rays from a pose in the order in which ties are settled: by number, left before right.
    fn rays(&self, pose: Pose) -> impl Iterator<Item = Ray> {
        let RayFan { left, right, .. } = self.fan();
        (0..left.max(right.saturating_add(1))).flat_map(move |n| {
            let on_left = (n < left).then(|| self.ray(pose, Side::Left, n));
            let on_right = (1..=right).contains(&n).then(|| self.ray(pose, Side::Right, n));
            on_left.into_iter().chain(on_right)
        })
    }

    /// The number of rays of a speed, to the left with the 0th, and to the right. There are fewer than in the fan if a
    /// short motion cannot turn as far as a long one. `None`: all of the fan.
    fn rays_at(&self, _speed: u16) -> Option<[u32; 2]> {
        None
    }

    /// The pose to which a ray leads at a speed. By default the agent then faces in the direction of travel.
    ///
    /// # Errors
    /// [`LatticeError`] when that is beyond the lattice.
    fn arrive(&self, pose: Pose, ray: &Ray, speed: u16) -> Result<Pose, LatticeError> {
        let site = pose.site.step(ray.displacement(speed))?;
        Ok(Pose { site, heading: ray.heading })
    }

    /// Where the tangents at the two ends of a motion meet, seen from its beginning: a convex area that has both
    /// ends and this place in it has all of the way. `None` when the way is straight.
    fn tangent_intersection(&self, _from: Pose, _to: Pose) -> Option<Vector> {
        None
    }

    /// The smallest circles, or nearly, that the agent can go round to the left and to the right. `None` if it needs
    /// none, as it turns in place or leaves in any direction.
    fn turning_circles(&self, _pose: Pose) -> Option<[TurningCircle; 2]> {
        None
    }

    /// Whether the vehicle's circle fits somewhere in an area. If not, the vehicle is cornered after any motion there.
    ///
    /// # Errors
    /// [`RoomError`].
    fn fits(&self, area: Area) -> Result<(), RoomError> {
        let pose = Pose { site: area.middle(), heading: Heading(0) };
        let Some([circle, _]) = self.turning_circles(pose) else { return Ok(()) };
        let radius = circle.with_room(room_for_errors(&area)).unsigned_abs();
        let across_mm = (u64::from(radius) * 2_000).div_ceil(UNITS_PER_METRE as u64) as u32;
        area.inset(radius).map(drop).ok_or(RoomError { across_mm })
    }

    /// Whether one of the circles from a pose lies inside the area, so that the agent can stay there for ever.
    fn is_safe<G: Workspace>(&self, pose: Pose, area: &G) -> bool {
        has_circle_inside(self, pose, area, |circle| circle.radius)
    }

    /// Whether a motion to a place inside the area stays inside and ends safe. The circle must have `room` around it,
    /// in lattice units, and a margin for the rounding of a round.
    fn keeps_inside<G: Workspace>(&self, from: Pose, to: Pose, area: &G, room: i32) -> bool {
        self.stays_inside(from, to, area) && self.ends_safe(to, area, room)
    }

    /// Whether one of the circles from where a motion ends lies inside the area, with `room` around it, in lattice units, and
    /// a margin for the rounding of a round.
    fn ends_safe<G: Workspace>(&self, to: Pose, area: &G, room: i32) -> bool {
        has_circle_inside(self, to, area, |circle| circle.with_room(room))
    }

    /// Whether all of a motion to a place that the border [allows](Workspace::confines) stays there, and touches no
    /// keep-out.
    fn stays_inside<G: Workspace>(&self, from: Pose, to: Pose, area: &G) -> bool {
        let Some(corner) = self.tangent_intersection(from, to) else {
            return area.lets_pass(&[from.site, to.site]);
        };
        from.site.step(corner).is_ok_and(|corner| {
            area.confines(from.site, corner) && area.lets_pass(&[from.site, corner, to.site])
        })
    }

    /// The ray nearest to a heading, and the nearest within half a turn on the other side of it. If there is none, the
    /// second is the first again. Computes some 70 headings at most.
    fn around(&self, pose: Pose, heading: Heading) -> [Ray; 2] {
        let RayFan { left, right, spacing } = self.fan();
        let to_left = heading.0.wrapping_sub(self.heading(pose, Side::Left, 0).0);
        // To the right of the heading and to the left: how far off, and which ray.
        let mut nearest = [(u32::MAX, Side::Left, 0); 2];
        for (side, last, to) in [
            (Side::Left, left.saturating_sub(1), to_left),
            (Side::Right, right, to_left.wrapping_neg()),
        ] {
            let before = last_within(last, to, spacing, |n| turn(self, pose, side, n));
            for n in [before, before.saturating_add(1).min(last)] {
                // Positive if the ray turns less than the heading.
                let off = to.wrapping_sub(turn(self, pose, side, n)) as i32;
                let is_left = (off < 0) == (side == Side::Left);
                if let Some(place) = nearest.get_mut(usize::from(is_left))
                    && off.unsigned_abs() < place.0
                {
                    *place = (off.unsigned_abs(), side, n);
                }
            }
        }
        let [right, left] = nearest;
        let (first, second) = if left.0 < right.0 { (left, right) } else { (right, left) };
        let second = if second.0 == u32::MAX { first } else { second };
        [first, second].map(|(_, side, n)| self.ray(pose, side, n))
    }

    /// The sharpest turn in place, to the left or right: its action and the pose after it. `None`
    /// when the agent cannot turn on the spot, or has no reason to as it can leave in any direction.
    fn turn_in_place(&self, pose: Pose, side: Side) -> Option<(Action, Pose)>;

    /// The control that an action asks of the vehicle.
    fn control(&self, pose: Pose, action: Action) -> Control;

    /// The ray to which an action belongs.
    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray>;

    /// The pose after an action; `None` when there is no such action or it leads off the lattice.
    fn target(&self, pose: Pose, action: Action) -> Option<Pose> {
        let (_, speed) = self.grid().split(action);
        let ray = self.ray_of(pose, action)?;
        self.arrive(pose, &ray, speed).ok()
    }
}

/// Room for two errors of the position, so that they do not push a circle out; lattice units. The area's own margin is
/// the size of one error.
pub fn room_for_errors<G: Workspace>(area: &G) -> i32 {
    (area.bounds().margin() as i32).saturating_mul(2)
}

/// Whether the agent needs no circle, or the disc of one of so large a radius lies inside the area.
fn has_circle_inside<D: Dynamics + ?Sized, G: Workspace>(
    dynamics: &D,
    pose: Pose,
    area: &G,
    radius: impl Fn(&TurningCircle) -> i32,
) -> bool {
    let fits = |circle: &TurningCircle| circle.is_inside(pose.site, area, radius(circle));
    dynamics.turning_circles(pose).is_none_or(|circles| circles.iter().any(fits))
}

/// The turn from straight ahead to the `n`-th ray of a side.
#[inline(never)] // it is called in three places, where time does not matter
fn turn<D: Dynamics + ?Sized>(dynamics: &D, pose: Pose, side: Side, n: u32) -> u32 {
    let turned = dynamics.heading(pose, side, n).0.wrapping_sub(dynamics.heading(pose, side, 0).0);
    if side == Side::Left { turned } else { turned.wrapping_neg() }
}

/// The last of the numbers from 0 whose turn is at most this one. The turns grow from 0, by the spacing at most from one
/// to the next. Where they are as far apart as that, it takes two looks. Else a binary search ends it.
fn last_within(last: u32, most: u32, spacing: Angle, turn: impl Fn(u32) -> u32) -> u32 {
    let spacings = |turn: u32| NonZeroU32::new(spacing.0).map_or(0, |spacing| turn / spacing);
    let mut low = spacings(most).min(last);
    low = low.saturating_add(spacings(most.saturating_sub(turn(low)))).min(last);
    let (mut high, mut next) = (last, low.saturating_add(1));
    while low < high {
        if turn(next) <= most {
            low = next;
        } else {
            high = next - 1;
        }
        next = high - (high - low) / 2;
    }
    low
}
