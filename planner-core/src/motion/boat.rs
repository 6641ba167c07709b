//! A boat: turns a little and drives, a step at a time, and never on the spot.

use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{UNITS_PER_METRE, Vector};
use crate::motion::action::{Action, ActionGrid, Control, GridError};
use crate::motion::dynamics::{Dynamics, Pose, Ray, RayFan, Side, TurningCircle};
use crate::motion::unicycle::Unicycle;

/// A [`Unicycle`] that cannot turn on the spot. Each step turns by at most its sharpest turn, then drives at least one
/// step of speed.
///
/// Its smallest circle combines the sharpest turn `w` with the slowest speed `v`. It is a polygon with the circumradius
/// `v / (2 sin(w / 2))`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Boat {
    steps: Unicycle,
    half_turn: Angle,
    /// Lattice units.
    radius: i32,
    margin: i32,
}

/// One, in the fixed point of the sines here: 29 fractional bits.
const ONE: i32 = 1 << 29;

/// The circle is smaller than this, lattice units.
const MOST: i64 = 4_096 * UNITS_PER_METRE as i64;

impl Boat {
    /// A boat with a unicycle's steps.
    ///
    /// # Errors
    /// [`GridError::Circle`].
    pub fn new(steps: Unicycle) -> Result<Self, GridError> {
        let (grid, sharpest) = (steps.grid(), steps.sharpest());
        let half_turn = Angle(sharpest.0 / 2);
        let Vector { z: sin, .. } = half_turn.unit().scaled(ONE);
        let step = i64::from(grid.step_length()) * i64::from(ONE);
        let radius = step.checked_div(sin.into()).ok_or(GridError::Circle)? >> (Ray::STEP_BITS + 1);
        // A position is rounded by less than a unit, a step by much less.
        let margin = 2 * (i64::from(u32::MAX / sharpest.0.max(1)) + 2);
        if grid.speeds() < 2 || radius + margin >= MOST {
            return Err(GridError::Circle);
        }
        Ok(Self { steps, half_turn, radius: radius as i32 + 2, margin: margin as i32 })
    }

    /// A unicycle with its steps.
    pub const fn steps(&self) -> Unicycle {
        self.steps
    }
}

impl Dynamics for Boat {
    fn grid(&self) -> ActionGrid {
        self.steps.grid()
    }

    fn fan(&self) -> RayFan {
        self.steps.fan()
    }

    fn heading(&self, pose: Pose, side: Side, n: u32) -> Heading {
        self.steps.heading(pose, side, n)
    }

    fn ray(&self, pose: Pose, side: Side, n: u32) -> Ray {
        self.steps.ray(pose, side, n)
    }

    /// Standing still is none of its motions.
    fn rays_at(&self, speed: u16) -> Option<[u32; 2]> {
        (speed == 0).then_some([0; 2])
    }

    fn turning_circles(&self, pose: Pose) -> Option<[TurningCircle; 2]> {
        let Self { half_turn, radius, margin, .. } = *self;
        let left_of = |turn| pose.heading.turned(turn).unit().left().scaled(radius);
        let circle = |ray, centre| TurningCircle {
            action: self.grid().action(ray, 1),
            centre,
            radius,
            margin,
        };
        let left = circle(2 * self.steps.fan().right, left_of(half_turn));
        Some([left, circle(0, left_of(half_turn.mirrored()).reversed())])
    }

    fn turn_in_place(&self, _: Pose, _: Side) -> Option<(Action, Pose)> {
        None
    }

    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray> {
        let (_, speed) = self.grid().split(action);
        self.steps.ray_of(pose, action).filter(|_| speed > 0)
    }

    fn control(&self, pose: Pose, action: Action) -> Control {
        self.steps.control(pose, action)
    }
}
