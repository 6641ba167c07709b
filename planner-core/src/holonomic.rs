//! A holonomic integrator: any bearing, whichever way the agent faces.

use crate::action::{Action, ActionGrid, BadGrid, Control};
use crate::direction::{Heading, Rotation};
use crate::dynamics::{Dynamics, Pose, Ray};

/// A holonomic integrator, `zeta' = zeta + u`, with `u` on a polar grid: any of `bearings` equally
/// spaced directions at any speed of the grid, whichever way the agent faces.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Holonomic {
    grid: ActionGrid,
    one_bearing: Rotation,
}

impl Holonomic {
    /// An integrator with `bearings` directions, the first along the x axis, and the speeds
    /// `0, step, ..., (speeds - 1) step`, millimetres per unit time.
    ///
    /// # Errors
    /// [`BadGrid`] when the grid is none.
    pub fn new(bearings: u16, speeds: u16, speed_step_mm: u32) -> Result<Self, BadGrid> {
        let grid = ActionGrid::new(bearings, speeds, speed_step_mm)?;
        Ok(Self { grid, one_bearing: bearing(1, bearings).unit() })
    }
}

fn bearing(n: u16, bearings: u16) -> Heading {
    Heading(((u64::from(n) << 32) / u64::from(bearings.max(1))) as u32)
}

impl Dynamics for Holonomic {
    fn grid(&self) -> ActionGrid {
        self.grid
    }

    /// Counter-clockwise from the x axis; all cost the same.
    fn rays(&self, _: Pose) -> impl Iterator<Item = Ray> {
        let length = self.grid.step_length();
        let mut unit = Rotation::IDENTITY;
        (0..self.grid.rays()).map(move |index| {
            let step = unit.scaled(length);
            unit = unit.then(self.one_bearing);
            Ray { index, heading: bearing(index, self.grid.rays()), step, effort: 0 }
        })
    }

    fn turn_in_place(&self, _: Pose, _: bool) -> Option<(Action, Pose)> {
        None
    }

    fn control(&self, action: Action) -> Control {
        let (ray, speed) = self.grid.split(action);
        Control { v: self.grid.reach_m(speed), w: bearing(ray, self.grid.rays()).radians() as f32 }
    }
}
