//! The paper's unicycle: turn, then drive.

use crate::action::{Action, ActionGrid, BadGrid, Control};
use crate::direction::{Heading, Rotation};
use crate::dynamics::{Dynamics, Pose, Ray};

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
    /// Rotations by one step, and by what the sharpest turn adds to the last multiple of it.
    one_turn: Rotation,
    last_turn: Rotation,
}

impl Unicycle {
    /// A unicycle whose turns are `0, step, 2 step, ...` up to `sharpest`, milliradians, to both
    /// sides, and whose speeds are `0, step, ..., (speeds - 1) step`, millimetres per unit time.
    ///
    /// # Errors
    /// [`BadGrid`] when there is no turn, a turn exceeds pi, or the grid is none.
    pub fn new(
        turn_step_mrad: u32,
        sharpest_rad: f64,
        speeds: u16,
        speed_step_mm: u32,
    ) -> Result<Self, BadGrid> {
        if turn_step_mrad == 0 || !(sharpest_rad > 0.0 && sharpest_rad <= core::f64::consts::PI) {
            return Err(BadGrid);
        }
        let turns = libm::ceil(sharpest_rad * 1000.0 / f64::from(turn_step_mrad)) as u16;
        let grid = ActionGrid::new(2 * turns + 1, speeds, speed_step_mm)?;
        Ok(Self::with_grid(grid, turn_step_mrad, sharpest_rad))
    }

    /// The paper's action set: `v` in {0, 0.1, ..., 2.0} and `w` in {-pi/2, -1.57, ..., 0, 0.01,
    /// ..., 1.57, pi/2}: 317 x 21 = 6,657 actions.
    pub fn paper() -> Self {
        const GRID: ActionGrid = match ActionGrid::new(317, 21, 100) {
            Ok(grid) => grid,
            Err(_) => panic!("the paper's grid is none"),
        };
        Self::with_grid(GRID, 10, core::f64::consts::FRAC_PI_2)
    }

    fn with_grid(grid: ActionGrid, step_mrad: u32, sharpest_rad: f64) -> Self {
        let turns = grid.rays() / 2;
        let before_last_rad = f64::from(u32::from(turns - 1) * step_mrad) / 1000.0;
        let heading = |rad| Heading::from_radians(rad).unwrap_or_default();
        Self {
            grid,
            turns,
            step_mrad,
            step: libm::round(f64::from(step_mrad) * BINARY_ANGLE_PER_MRAD) as u64,
            sharpest_rad: sharpest_rad as f32,
            sharpest_mrad2: libm::round(sharpest_rad * sharpest_rad * 1e6) as u32,
            sharpest: heading(sharpest_rad),
            one_turn: heading(f64::from(step_mrad) / 1000.0).unit(),
            last_turn: heading(sharpest_rad - before_last_rad).unit(),
        }
    }

    /// The `j`-th turn to the left and its square, mrad^2.
    fn turn(&self, j: u16) -> (Heading, u32) {
        if j == self.turns {
            return (self.sharpest, self.sharpest_mrad2);
        }
        let turned = (u64::from(j) * self.step + (1 << 15)) >> 16;
        (Heading(turned as u32), (u32::from(j) * self.step_mrad).pow(2))
    }
}

/// A milliradian as a binary angle with 16 fractional bits.
const BINARY_ANGLE_PER_MRAD: f64 = 281_474_976_710_656.0 / (1000.0 * core::f64::consts::TAU);

impl Dynamics for Unicycle {
    fn grid(&self) -> ActionGrid {
        self.grid
    }

    /// Straight ahead, then the smallest turns first, each to the left and to the right.
    fn rays(&self, pose: Pose) -> impl Iterator<Item = Ray> {
        let length = self.grid.step_length();
        let ahead = pose.heading.unit();
        let (mut to_left, mut to_right) = (ahead, ahead);
        (0..self.grid.rays()).map(move |n| {
            let (j, left) = (n.div_ceil(2), n % 2 == 1);
            if left {
                let by = if j == self.turns { self.last_turn } else { self.one_turn };
                (to_left, to_right) = (to_left.then(by), to_right.then(by.inverse()));
            }
            let (turn, effort) = self.turn(j);
            let (index, turn, unit) = if left {
                (self.turns + j, turn, to_left)
            } else {
                (self.turns - j, turn.mirrored(), to_right)
            };
            Ray { index, heading: pose.heading.turned(turn), step: unit.scaled(length), effort }
        })
    }

    fn turn_in_place(&self, pose: Pose, left: bool) -> Option<(Action, Pose)> {
        let (ray, turn) =
            if left { (2 * self.turns, self.sharpest) } else { (0, self.sharpest.mirrored()) };
        let turned = Pose { heading: pose.heading.turned(turn), ..pose };
        Some((self.grid.action(ray, 0), turned))
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
