//! The paper's unicycle: turn, then drive.

use crate::geometry::heading::Angle;
use crate::motion::action::{ActionGrid, GridError};
use crate::motion::pivots::{HALF, Pivots, RADIANS_PER_UNIT, square_mrad2_of};

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
    sharpest: Angle,
}

/// What a [`Unicycle`] can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename = "Steps"))]
pub struct UnicycleShape {
    /// The angle from one turn to the next, microradians.
    pub turn_step_urad: u32,
    /// The sharpest turn to one side.
    pub sharpest: Angle,
    /// Speeds, standing still included.
    pub speeds: u16,
    /// From one speed to the next, millimetres per unit time.
    pub speed_step_mm: u32,
}

impl Unicycle {
    /// A unicycle with the turns `0, step, 2 step, ...` up to the sharpest, to both sides. `turn_step_urad` is in
    /// microradians, `sharpest_rad` in radians. The speeds are `0, step, ..., (speeds - 1) step` with a step of
    /// `speed_step_mm`, millimetres per unit time.
    ///
    /// # Errors
    /// [`GridError`].
    pub const fn new(
        turn_step_urad: u32,
        sharpest_rad: f64,
        speeds: u16,
        speed_step_mm: u32,
    ) -> Result<Self, GridError> {
        // Anything else becomes a turn of 0, which `of` refuses.
        let is_angle = sharpest_rad >= 0.0 && sharpest_rad <= core::f64::consts::PI;
        let turn = if is_angle { sharpest_rad } else { 0.0 };
        let sharpest = Angle((turn * 1e6 * UNITS_PER_URAD + 0.5) as u32);
        Self::of(UnicycleShape { turn_step_urad, sharpest, speeds, speed_step_mm })
    }

    /// A unicycle of this shape: as [`new`](Self::new), in integers alone.
    ///
    /// # Errors
    /// [`GridError`].
    pub const fn of(shape: UnicycleShape) -> Result<Self, GridError> {
        let UnicycleShape { turn_step_urad, sharpest, speeds, speed_step_mm } = shape;
        let makes_sense = turn_step_urad > 0
            && turn_step_urad <= MOST_URAD
            && sharpest.0 >= Angle::of_radians(1e-3).0
            && sharpest.0 <= Angle::HALF_TURN.0;
        if !makes_sense {
            return Err(GridError::Turn);
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
        Ok(Self {
            grid,
            turns,
            step_urad: turn_step_urad,
            step,
            sharpest_rad: sharpest.0 as f32 * RADIANS_PER_UNIT,
            sharpest_mrad2: square_mrad2_of(sharpest),
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
    const fn every(turn_step_urad: u32) -> Result<Self, GridError> {
        Self::new(turn_step_urad, core::f64::consts::FRAC_PI_2, 21, 100)
    }

    /// What it can do.
    pub const fn shape(&self) -> UnicycleShape {
        UnicycleShape {
            turn_step_urad: self.step_urad,
            sharpest: self.sharpest,
            speeds: self.grid.speeds(),
            speed_step_mm: self.grid.speed_step_mm(),
        }
    }

    /// The sharpest turn to one side.
    pub const fn sharpest(&self) -> Angle {
        self.sharpest
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

impl Pivots for Unicycle {
    fn grid(&self) -> ActionGrid {
        self.grid
    }

    fn turn(&self, n: u32) -> Angle {
        if n >= self.turns {
            return self.sharpest;
        }
        Angle(((u64::from(n) * self.step + HALF) >> 32) as u32)
    }

    fn spacing(&self) -> Angle {
        Angle(((self.step >> 32) as u32 + 1).min(self.sharpest.0))
    }

    fn turn_cost(&self, n: u32) -> u32 {
        if n >= self.turns { self.sharpest_mrad2 } else { square_mrad2(n * self.step_urad) }
    }

    fn turn_rad(&self, n: u32) -> f32 {
        if n >= self.turns { self.sharpest_rad } else { (n * self.step_urad) as f32 / 1e6 }
    }
}

/// The paper's: [`Unicycle::paper`].
impl Default for Unicycle {
    fn default() -> Self {
        Self::paper()
    }
}
