//! Metres and radians in single precision.

use crate::geometry::approximate::METRE;
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::Vector;

/// A direction as a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    pub(crate) x: f32,
    pub(crate) z: f32,
}

impl Unit {
    pub(crate) const ZERO: Self = Self { x: 0.0, z: 0.0 };

    pub(crate) fn of(heading: Heading) -> Self {
        const ONE: i32 = (1 << 30) - 1;
        let Vector { x, z } = heading.unit().scaled(ONE);
        Self { x: x as f32 / ONE as f32, z: z as f32 / ONE as f32 }
    }

    /// How far a place lies ahead, and how far to the left.
    pub(crate) fn seen(self, [x, z]: [f32; 2]) -> [f32; 2] {
        [self.x * x + self.z * z, self.x * z - self.z * x]
    }
}

/// A vector in metres.
pub(crate) fn metres(v: Vector) -> [f32; 2] {
    [v.x as f32 * METRE, v.z as f32 * METRE]
}

/// An angle of so many radians, less than a turn in size.
pub(crate) fn angle(radians: f32) -> Angle {
    const UNITS: f32 = (1_u32 << 31) as f32 / core::f32::consts::PI;
    Angle((radians * UNITS) as i64 as u32)
}

/// An angle in radians, from -pi to below pi.
pub(crate) fn radians(Angle(units): Angle) -> f32 {
    const UNIT: f32 = core::f32::consts::PI / (1_u32 << 31) as f32;
    units as i32 as f32 * UNIT
}

/// A number, or the nearest that is no larger than `most` in size. Unlike `clamp` it cannot panic.
pub(crate) fn limited(value: f32, most: f32) -> f32 {
    match () {
        () if value > most => most,
        () if value < -most => -most,
        () => value,
    }
}
