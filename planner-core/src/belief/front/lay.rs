//! Where the cells of a grid lie, in a frame of its own: metres from a pivot, and radians from a heading.

use crate::geometry::approximate::METRE;
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{Site, Vector};

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

/// Where the cells of a grid lie.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Lay {
    pub(crate) pivot: Site,
    /// The direction in the middle of all columns.
    pub(crate) heading: Heading,
    /// From one column to the next, radians.
    pub(crate) turn: f32,
    /// The offset at the lower edge of the first cell, metres.
    pub(crate) low: f32,
    /// The height of a cell, metres.
    pub(crate) step: f32,
    /// The curvature of the last layer, 1/m. The first has the opposite.
    pub(crate) bend: f32,
}

impl Lay {
    pub(crate) const NONE: Self = Self {
        pivot: Site::ORIGIN,
        heading: Heading(0),
        turn: 0.0,
        low: 0.0,
        step: 1.0,
        bend: 0.0,
    };

    /// The curvatures of the layers.
    pub(crate) fn bends<const L: usize>(self) -> impl Iterator<Item = f32> {
        let last = L.saturating_sub(1);
        let each = if last > 0 { 2.0 / last as f32 } else { 0.0 };
        (0..L).map(move |l| if last > 0 { self.bend * (l as f32 * each - 1.0) } else { 0.0 })
    }

    /// Whether its columns go all around.
    pub(crate) fn is_whole<const K: usize>(self) -> bool {
        self.turn * K as f32 > 6.2
    }

    /// The angle from its heading to a place on its columns, counted in columns from the first one's edge.
    pub(crate) fn angle_at<const K: usize>(self, columns: f32) -> f32 {
        (columns - 0.5 * K as f32) * self.turn
    }

    /// How far a curve of some curvature bulges at a distance along its direction. Beyond the radius it bulges no more:
    /// a front does not go round for ever.
    pub(crate) fn bulge(self, bend: f32, ahead: f32) -> f32 {
        let far = if self.bend > 0.0 { 1.0 / (self.bend * self.bend) } else { f32::MAX };
        let square = ahead * ahead;
        0.5 * bend * (if square < far { square } else { far })
    }
}
