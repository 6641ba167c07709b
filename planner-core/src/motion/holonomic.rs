//! A holonomic integrator: any bearing, whichever way the agent faces.

use crate::geometry::heading::{Angle, Heading};
use crate::motion::action::{Action, ActionGrid, Control, GridError};
use crate::motion::dynamics::{Dynamics, Pose, Ray, RayFan, Side};

/// A holonomic integrator, `zeta' = zeta + u`, with `u` on a polar grid: any of `bearings` equally
/// spaced directions at any speed of the grid, whichever way the agent faces.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Holonomic {
    grid: ActionGrid,
}

impl Holonomic {
    /// An integrator with `bearings` directions, the first along the x axis, and the speeds
    /// `0, step, ..., (speeds - 1) step`, millimetres per unit time.
    ///
    /// # Errors
    /// [`GridError::Actions`], [`GridError::Reach`].
    pub fn new(bearings: u32, speeds: u16, speed_step_mm: u32) -> Result<Self, GridError> {
        Ok(Self { grid: ActionGrid::new(bearings, speeds, speed_step_mm)? })
    }

    fn bearing(&self, n: u32) -> Heading {
        Heading(((u64::from(n) << 32) / u64::from(self.grid.rays().max(1))) as u32)
    }
}

impl Dynamics for Holonomic {
    fn grid(&self) -> ActionGrid {
        self.grid
    }

    /// Counter-clockwise from the x axis; all cost the same.
    fn fan(&self) -> RayFan {
        let spacing = (u32::MAX / self.grid.rays().max(1)).saturating_add(1);
        RayFan { left: self.grid.rays(), right: 0, spacing: Angle(spacing) }
    }

    fn heading(&self, _: Pose, _: Side, n: u32) -> Heading {
        self.bearing(n)
    }

    fn ray(&self, _: Pose, _: Side, n: u32) -> Ray {
        let heading = self.bearing(n);
        let step = heading.unit().scaled(self.grid.step_length());
        Ray { index: n, heading, step, turn_cost: 0 }
    }

    fn turn_in_place(&self, _: Pose, _: Side) -> Option<(Action, Pose)> {
        None
    }

    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray> {
        let (index, _) = self.grid.split(action);
        (index < self.grid.rays()).then(|| self.ray(pose, Side::Left, index))
    }

    fn control(&self, pose: Pose, action: Action) -> Control {
        let (ray, speed) = self.grid.split(action);
        let turn = self.bearing(ray).since(pose.heading);
        Control { distance_m: self.grid.reach_m(speed), turn_rad: turn.radians() as f32 }
    }
}
