//! The measure of a cell of lines, d(angle) d(offset), in single precision and without cancellation.
//!
//! Three lines, in pairs less than a half turn apart, are the corners of a triangle of lines. When
//! two of them cross at an angle `t` in a point at distance `h` from the third, and make angles `u`
//! and `v` with it, the triangle's measure is
//!
//! ```text
//! h sin(t) / (2 cos(t/2) cos(u/2) cos(v/2))
//! ```
//!
//! A cell is a fan of such triangles about its first vertex. Two neighbouring vertices cross at the
//! sample between them, so `h` and `sin(t)` are exact integers over lengths; and all triangles are
//! turned the same way, so nothing is lost in the sum, however thin the cell. It is off by some
//! 10^-7 of itself, where [`estimate::area`](crate::belief::estimate::area), by other means and in double
//! precision, is its slow twin.

use crate::belief::consistent_lines::ConsistentLines;
use crate::geometry::lattice::{UNITS_PER_METRE, Vector};

/// A unit vector, and the inverse of the length that it had.
#[derive(Clone, Copy)]
struct UnitVector {
    x: f32,
    z: f32,
    per_length: f32,
}

impl UnitVector {
    fn of(v: Vector) -> Self {
        let (x, z) = (v.x as f32, v.z as f32);
        let per_length = inverse_sqrt(x * x + z * z);
        Self { x: x * per_length, z: z * per_length, per_length }
    }

    /// Twice the square of the cosine of half the angle between the two.
    fn opening(self, other: Self) -> f32 {
        let opening = 1.0 + (self.x * other.x + self.z * other.z);
        if opening > f32::EPSILON { opening } else { f32::EPSILON }
    }
}

/// Radian metres; 0 for a cell without area.
#[inline(never)]
pub(crate) fn measure(lines: ConsistentLines<'_>) -> f32 {
    let mut bounds = lines.bounds();
    let Some(apex) = bounds.next() else { return 0.0 };
    let apex_unit = UnitVector::of(apex.along);
    // The first triangle is flat.
    let (mut last, mut last_unit, mut last_opening) = (apex, apex_unit, 2.0);
    let mut sum = 0.0;
    for bound in bounds {
        let unit = UnitVector::of(bound.along);
        let opening = apex_unit.opening(unit);
        let turn = last.along.cross(bound.along) as f32 * (last_unit.per_length * unit.per_length);
        let openings = last_opening * last_unit.opening(unit) * opening;
        sum += apex.at(bound.through) as f32 * turn * inverse_sqrt(openings);
        (last, last_unit, last_opening) = (bound, unit, opening);
    }
    let scale = core::f32::consts::SQRT_2 / UNITS_PER_METRE as f32;
    (sum * (apex_unit.per_length * scale)).abs()
}

/// By Newton's iteration from the well-known guess: some 20 instructions and the same on every
/// machine, where libm's square root takes 150.
fn inverse_sqrt(x: f32) -> f32 {
    let half = 0.5 * x;
    let mut y = f32::from_bits(0x5f37_5a86 - (x.to_bits() >> 1));
    for _ in 0..3 {
        y *= 1.5 - half * y * y;
    }
    y
}
