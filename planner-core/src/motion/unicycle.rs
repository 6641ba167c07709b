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
    turns: u32,
    step_urad: u32,
    /// The step as a binary angle with 32 fractional bits.
    step: u64,
    sharpest_rad: f32,
    sharpest_mrad2: u32,
    sharpest: Heading,
}

/// What a [`Unicycle`] can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Shape {
    /// The angle from one turn to the next, microradians.
    pub turn_step_urad: u32,
    /// The sharpest turn to one side.
    pub sharpest: Heading,
    /// Speeds, standing still included.
    pub speeds: u16,
    /// From one speed to the next, millimetres per unit time.
    pub speed_step_mm: u32,
}

/// The action sets of the unicycle that have a name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Grid {
    /// [`Unicycle::paper`].
    #[default]
    Paper,
    /// [`Unicycle::fine`].
    Fine,
}

impl From<Grid> for Unicycle {
    fn from(grid: Grid) -> Self {
        match grid {
            Grid::Paper => Self::paper(),
            Grid::Fine => Self::fine(),
        }
    }
}

impl Unicycle {
    /// A unicycle whose turns are `0, step, 2 step, ...` up to `sharpest`, to both sides, the step in
    /// microradians, and whose speeds are `0, step, ..., (speeds - 1) step`, millimetres per unit time.
    ///
    /// # Errors
    /// [`BadGrid`].
    pub const fn new(
        turn_step_urad: u32,
        sharpest_rad: f64,
        speeds: u16,
        speed_step_mm: u32,
    ) -> Result<Self, BadGrid> {
        // No angle is a turn of nothing, which is none.
        let is_angle = sharpest_rad >= 0.0 && sharpest_rad <= core::f64::consts::PI;
        let turn = if is_angle { sharpest_rad } else { 0.0 };
        let sharpest = Heading((turn * 1e6 * UNITS_PER_URAD + 0.5) as u32);
        Self::of(Shape { turn_step_urad, sharpest, speeds, speed_step_mm })
    }

    /// A unicycle of this shape: as [`new`](Self::new), in integers alone.
    ///
    /// # Errors
    /// [`BadGrid`].
    pub const fn of(shape: Shape) -> Result<Self, BadGrid> {
        let Shape { turn_step_urad, sharpest, speeds, speed_step_mm } = shape;
        let makes_sense = turn_step_urad > 0
            && turn_step_urad <= MOST_URAD
            && sharpest.0 >= Heading::turn_of(1e-3)
            && sharpest.0 <= Heading::HALF_TURN.0;
        if !makes_sense {
            return Err(BadGrid::Turn);
        }
        // Turns are half a turn at most, 2^31 units of a heading: all of this is below 2^64.
        let step = turn_step_urad as u64 * STEP_PER_URAD;
        // The multiples, rounded to headings, that are less than the sharpest turn, and that turn; so one
        // that is a multiple but for rounding is that multiple.
        let turns = below(((sharpest.0 as u64) << 32) - HALF, step) + 1;
        let grid = match ActionGrid::new(2 * turns + 1, speeds, speed_step_mm) {
            Ok(grid) => grid,
            Err(bad) => return Err(bad),
        };
        // With 16 fractional bits, as in `square_mrad2`.
        let sharpest_mrad = (sharpest.0 as u64 * MRAD_PER_UNIT) >> 32;
        Ok(Self {
            grid,
            turns,
            step_urad: turn_step_urad,
            step,
            sharpest_rad: sharpest.0 as f32 * RADIANS_PER_UNIT,
            sharpest_mrad2: ((sharpest_mrad * sharpest_mrad + HALF) >> 32) as u32,
            sharpest,
        })
    }

    /// The paper's action set: `v` in {0, 0.1, ..., 2.0} and `w` in {-pi/2, -1.57, ..., 0, 0.01,
    /// ..., 1.57, pi/2}: 317 x 21 = 6,657 actions.
    pub const fn paper() -> Self {
        const PAPER: Unicycle = match Unicycle::every(10_000) {
            Ok(unicycle) => unicycle,
            Err(_) => panic!("the paper's grid is none"),
        };
        PAPER
    }

    /// The paper's speeds and sharpest turn with rays 1 urad apart, so that accuracy ends at the lattice
    /// and not at the grid: 3,141,595 x 21 = 65,973,495 actions.
    pub const fn fine() -> Self {
        const FINE: Unicycle = match Unicycle::every(1) {
            Ok(unicycle) => unicycle,
            Err(_) => panic!("the fine grid is none"),
        };
        FINE
    }

    /// The paper's speeds and sharpest turn with other turns between.
    const fn every(turn_step_urad: u32) -> Result<Self, BadGrid> {
        Self::new(turn_step_urad, core::f64::consts::FRAC_PI_2, 21, 100)
    }

    /// What it can do.
    pub const fn shape(&self) -> Shape {
        Shape {
            turn_step_urad: self.step_urad,
            sharpest: self.sharpest,
            speeds: self.grid.speeds(),
            speed_step_mm: self.grid.speed_step_mm(),
        }
    }

    /// The sharpest turn to one side.
    pub const fn sharpest(&self) -> Heading {
        self.sharpest
    }

    /// The `j`-th turn to the left and its square, mrad^2.
    const fn turn(&self, j: u32) -> (Heading, u32) {
        if j >= self.turns {
            return (self.sharpest, self.sharpest_mrad2);
        }
        let turned = (j as u64 * self.step + HALF) >> 32;
        (Heading(turned as u32), square_mrad2(j * self.step_urad))
    }
}

/// How many steps fit below a turn, both with 32 fractional bits. A long division: a chip would carry the general one
/// for this alone.
const fn below(turn: u64, step: u64) -> u32 {
    let (mut rest, mut count, mut k) = (turn - 1, 0, step.leading_zeros());
    loop {
        if rest >= step << k {
            rest -= step << k;
            count |= 1 << k;
        }
        if k == 0 {
            return count;
        }
        k -= 1;
    }
}

/// The square of a turn in urad, half a turn at most, in mrad^2: exact for whole mrad, else off by 0.61 at
/// most. Without a division, as each ray that is looked at has one.
pub(super) const fn square_mrad2(urad: u32) -> u32 {
    /// A microradian in milliradians, with 41 fractional bits.
    const MRAD: u64 = (1 << 41) / 1000;
    // With 16 fractional bits, too small by up to 1.1 units: no square is larger than that of a larger turn.
    let mrad = ((urad as u64 * MRAD) >> 25) as u32 as u64;
    ((mrad * mrad + HALF) >> 32) as u32
}

/// A microradian in the units of a heading.
pub(super) const UNITS_PER_URAD: f64 = 4_294_967_296.0 / (1e6 * core::f64::consts::TAU);

/// A step of one microradian, with 32 fractional bits.
pub(super) const STEP_PER_URAD: u64 = (UNITS_PER_URAD * 4_294_967_296.0 + 0.5) as u64;

/// Half a turn, microradians.
const MOST_URAD: u32 = (core::f64::consts::PI * 1e6) as u32;

/// A unit of a heading in milliradians, with 48 fractional bits.
const MRAD_PER_UNIT: u64 = (core::f64::consts::TAU * 1e3 * 65_536.0 + 0.5) as u64;

/// A unit of a heading in radians.
const RADIANS_PER_UNIT: f32 = (core::f64::consts::TAU / 4_294_967_296.0) as f32;

/// One half with 32 fractional bits.
pub(super) const HALF: u64 = 1 << 31;

impl Dynamics for Unicycle {
    fn grid(&self) -> ActionGrid {
        self.grid
    }

    fn fan(&self) -> Fan {
        let spacing = Heading(((self.step >> 32) as u32 + 1).min(self.sharpest.0));
        Fan { left: self.turns + 1, right: self.turns, spacing }
    }

    fn heading(&self, pose: Pose, side: Side, n: u32) -> Heading {
        let (turn, _) = self.turn(n);
        pose.heading.turned(if side == Side::Left { turn } else { turn.mirrored() })
    }

    fn ray(&self, pose: Pose, side: Side, n: u32) -> Ray {
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
        let w = if turn >= self.turns {
            self.sharpest_rad
        } else {
            (turn * self.step_urad) as f32 / 1e6
        };
        let w = if ray < self.turns { -w } else { w };
        Control { v: self.grid.reach_m(speed), w }
    }
}
