//! The integer-indexed action grid: a finite action set in which one `u32` names an action.
//!
//! Actions that share a direction of travel form a *ray* and differ only in speed. A grid has `rays` rays, each with
//! `speeds` speeds: `0, step, 2 step, ...`. The index of an action is `ray * speeds + speed`.

use crate::geometry::lattice::UNITS_PER_METRE;

/// The name of an action within a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Action(pub u32);

/// What an action asks of the vehicle in one unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Control {
    /// How far to drive, metres: the paper's `v` in one unit of time.
    #[cfg_attr(feature = "serde", serde(rename = "v"))]
    pub distance_m: f32,
    /// How far to turn before the drive, or all along it for a [car](crate::Car), radians; positive to the left.
    /// The paper's `w`.
    #[cfg_attr(feature = "serde", serde(rename = "w"))]
    pub turn_rad: f32,
}

/// The shape of an action set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ActionGrid {
    rays: u32,
    speeds: u16,
    speed_step_mm: u32,
    /// One step of speed in the units of a ray's step.
    step_length: i32,
}

/// Why there is no such grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum GridError {
    /// It has no action, or more than 2^32.
    Actions,
    /// Its steps of speed are zero, or 100 m or more. Or one of its motions is 3,000 m long or longer.
    Reach,
    /// Its step of turning is zero or more than half a turn. Or its sharpest turn is less than a milliradian or more
    /// than half a turn.
    Turn,
    /// Its turning circle is zero, or of 2,048 m or more. Or its motions are too short, or its steps of turning too
    /// large, to go round the circle.
    Circle,
}

impl core::fmt::Display for GridError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Actions => "an action grid has 1 to 2^32 actions",
            Self::Reach => "steps of speed are 1 mm or more and below 100 m, and a motion is shorter than 3000 m",
            Self::Turn => {
                "a step of turning is 1 to 3141592 urad, and the sharpest turn from 0.001 to pi rad"
            }
            Self::Circle => {
                "a turning circle's radius is 1 mm or more and below 2048 m, and some motion goes round it"
            }
        })
    }
}

impl core::error::Error for GridError {}

impl ActionGrid {
    /// Fractional bits of a ray's step.
    pub const STEP_BITS: u32 = 8;

    /// Motions are shorter than this, millimetres: so the objective, with six decimal places, fits an `i64`.
    pub const LONGEST_MM: u32 = 3_000_000;

    /// Steps of speed are smaller than this, millimetres: so a ray's step, with 8 fractional bits, fits an `i32`.
    pub const LONGEST_STEP_MM: u32 = 100_000;

    /// A grid of `rays` directions with the speeds `0, step, ..., (speeds - 1) step`.
    ///
    /// # Errors
    /// [`GridError::Actions`], [`GridError::Reach`].
    pub const fn new(rays: u32, speeds: u16, speed_step_mm: u32) -> Result<Self, GridError> {
        let actions = rays as u64 * speeds as u64;
        if actions == 0 || actions > 1 << 32 {
            return Err(GridError::Actions);
        }
        let reach = (speeds as u64 - 1) * speed_step_mm as u64;
        let is_step = speed_step_mm > 0 && speed_step_mm < Self::LONGEST_STEP_MM;
        if !is_step || reach >= Self::LONGEST_MM as u64 {
            return Err(GridError::Reach);
        }
        // To the nearest, in 32 bits: whole metres, and of the rest an eighth of numerator and denominator.
        let per_metre = (UNITS_PER_METRE as u32) << Self::STEP_BITS;
        let (metres, rest) = (speed_step_mm / 1000, speed_step_mm % 1000);
        let step_length = (metres * per_metre + (rest * (per_metre / 8) + 62) / 125) as i32;
        Ok(Self { rays, speeds, speed_step_mm, step_length })
    }

    /// Number of directions.
    pub const fn rays(&self) -> u32 {
        self.rays
    }

    /// Number of speeds on a ray, standing still included.
    pub const fn speeds(&self) -> u16 {
        self.speeds
    }

    /// Number of actions.
    pub const fn actions(&self) -> u64 {
        self.rays as u64 * self.speeds as u64
    }

    /// The spacing of the speeds, millimetres per unit time.
    pub const fn speed_step_mm(&self) -> u32 {
        self.speed_step_mm
    }

    /// Distance of travel at a speed of the grid, millimetres. Speeds beyond the grid have none: what
    /// is returned for them means nothing.
    pub const fn reach_mm(&self, speed: u16) -> u32 {
        (speed as u32).wrapping_mul(self.speed_step_mm)
    }

    /// Distance of travel, metres.
    pub const fn reach_m(&self, speed: u16) -> f32 {
        self.reach_mm(speed) as f32 / 1000.0
    }

    /// Length of one step of speed in the units of [`Ray::step`](crate::motion::dynamics::Ray::step).
    pub const fn step_length(self) -> i32 {
        self.step_length
    }

    /// Length of the longest motion, lattice units.
    pub(crate) fn longest_units(self) -> f32 {
        f32::from(self.speeds.saturating_sub(1)) * self.step_units()
    }

    /// Length of one step of speed, lattice units.
    pub(crate) const fn step_units(self) -> f32 {
        self.step_length as f32 / (1 << Self::STEP_BITS) as f32
    }

    /// The name of an action.
    pub const fn action(&self, ray: u32, speed: u16) -> Action {
        Action(ray.wrapping_mul(self.speeds as u32).wrapping_add(speed as u32))
    }

    /// Ray and speed of an action.
    pub const fn split(&self, action: Action) -> (u32, u16) {
        let speeds = if self.speeds == 0 { 1 } else { self.speeds as u32 }; // never 0; spares a panic path
        (action.0 / speeds, (action.0 % speeds) as u16)
    }
}
