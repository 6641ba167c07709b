//! The paper's unicycle: turn, then drive.

use crate::geometry::heading::Heading;
use crate::motion::action::{Action, ActionGrid, BadGrid, Control};
use crate::motion::dynamics::{Dynamics, Fan, Pose, Ray, Side};

/// The paper's unicycle (Section V): `theta' = theta + w`, then `x' = x + v cos theta'`,
/// `z' = z + v sin theta'`.
///
/// The turns are the multiples of a step up to a sharpest turn, and that turn itself, to both
/// sides. Rays are counted from the sharpest right turn to the sharpest left one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unicycle {
    grid: ActionGrid,
    /// Turns to one side.
    turns: u16,
    step_mrad: u32,
    /// The step as a binary angle with 16 fractional bits.
    step: u64,
    sharpest_rad: f32,
    sharpest_mrad2: u32,
    sharpest: Heading,
}

impl Unicycle {
    /// A unicycle whose turns are `0, step, 2 step, ...` up to `sharpest`, milliradians, to both
    /// sides, and whose speeds are `0, step, ..., (speeds - 1) step`, millimetres per unit time.
    ///
    /// # Errors
    /// [`BadGrid`].
    pub fn new(
        turn_step_mrad: u32,
        sharpest_rad: f64,
        speeds: u16,
        speed_step_mm: u32,
    ) -> Result<Self, BadGrid> {
        use core::f64::consts::PI;
        let step = f64::from(turn_step_mrad) / 1000.0;
        if turn_step_mrad == 0 || step > PI || !(1e-3..=PI).contains(&sharpest_rad) {
            return Err(BadGrid::Turn);
        }
        // A sharpest turn that is a multiple of the step but for rounding is that multiple.
        let turns = libm::ceil(sharpest_rad / step - 1e-9) as u16;
        let grid = ActionGrid::new(2 * turns + 1, speeds, speed_step_mm)?;
        Ok(Self::with_grid(grid, turn_step_mrad, sharpest_rad))
    }

    /// The paper's action set: `v` in {0, 0.1, ..., 2.0} and `w` in {-pi/2, -1.57, ..., 0, 0.01,
    /// ..., 1.57, pi/2}: 317 x 21 = 6,657 actions.
    pub const fn paper() -> Self {
        const PAPER: Unicycle = match ActionGrid::new(317, 21, 100) {
            Ok(grid) => Unicycle::with_grid(grid, 10, core::f64::consts::FRAC_PI_2),
            Err(_) => panic!("the paper's grid is none"),
        };
        PAPER
    }

    /// A sharpest turn is at most pi, so all of this is far from overflow.
    const fn with_grid(grid: ActionGrid, step_mrad: u32, sharpest_rad: f64) -> Self {
        let sharpest_mrad = sharpest_rad * 1000.0;
        Self {
            grid,
            turns: grid.rays() / 2,
            step_mrad,
            step: (step_mrad as f64 * BINARY_ANGLE_PER_MRAD + 0.5) as u64,
            sharpest_rad: sharpest_rad as f32,
            sharpest_mrad2: (sharpest_mrad * sharpest_mrad + 0.5) as u32,
            sharpest: Heading((sharpest_mrad * BINARY_ANGLE_PER_MRAD / 65_536.0 + 0.5) as u32),
        }
    }

    /// The `j`-th turn to the left and its square, mrad^2.
    const fn turn(&self, j: u16) -> (Heading, u32) {
        if j >= self.turns {
            return (self.sharpest, self.sharpest_mrad2);
        }
        let turned = (j as u64 * self.step + (1 << 15)) >> 16;
        (Heading(turned as u32), (j as u32 * self.step_mrad).pow(2))
    }
}

/// A milliradian as a binary angle with 16 fractional bits.
const BINARY_ANGLE_PER_MRAD: f64 = 281_474_976_710_656.0 / (1000.0 * core::f64::consts::TAU);

impl Dynamics for Unicycle {
    fn grid(&self) -> ActionGrid {
        self.grid
    }

    fn fan(&self) -> Fan {
        let spacing = Heading(((self.step >> 16) as u32 + 1).min(self.sharpest.0));
        Fan { left: self.turns + 1, right: self.turns, spacing }
    }

    fn heading(&self, pose: Pose, side: Side, n: u16) -> Heading {
        let (turn, _) = self.turn(n);
        pose.heading.turned(if side == Side::Left { turn } else { turn.mirrored() })
    }

    fn ray(&self, pose: Pose, side: Side, n: u16) -> Ray {
        let n = n.min(self.turns);
        let (heading, (_, effort)) = (self.heading(pose, side, n), self.turn(n));
        let index = if side == Side::Left { self.turns + n } else { self.turns - n };
        Ray { index, heading, step: heading.unit().scaled(self.grid.step_length()), effort }
    }

    fn turn_in_place(&self, pose: Pose, side: Side) -> Option<(Action, Pose)> {
        let ray = self.ray(pose, side, self.turns);
        Some((self.grid.action(ray.index, 0), Pose { heading: ray.heading, ..pose }))
    }

    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray> {
        let (index, _) = self.grid.split(action);
        let side = if index >= self.turns { Side::Left } else { Side::Right };
        (index < self.grid.rays()).then(|| self.ray(pose, side, index.abs_diff(self.turns)))
    }

    fn control(&self, action: Action) -> Control {
        let (ray, speed) = self.grid.split(action);
        let turn = ray.abs_diff(self.turns);
        let w = if turn == self.turns {
            self.sharpest_rad
        } else {
            (u32::from(turn) * self.step_mrad) as f32 / 1000.0
        };
        let w = if ray < self.turns { -w } else { w };
        Control { v: self.grid.reach_m(speed), w }
    }
}
