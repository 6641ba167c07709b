//! Quick approximations in single precision, the same on every machine. They propose and never decide: the caller
//! leaves a margin for the error of each.

use crate::geometry::angle::CoarseAngle;
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{UNITS_PER_METRE, Vector};

/// Metres in a lattice unit.
pub(crate) const METRE: f32 = 1.0 / UNITS_PER_METRE as f32;

/// The lever of a stretch, as a share of its length: 1 / sqrt(12), the deviation of places spread evenly over it.
pub(crate) const LEVER: f32 = 0.288_675_13;

/// The [cross product](Vector::cross) to 2 10^-7 of it, however small it is beside the vectors.
#[inline(never)] // in many places, and not for speed
pub(crate) fn cross(a: Vector, b: Vector) -> f32 {
    rounded(a.cross(b))
}

/// An integer to 2 10^-7 of it.
#[inline(never)] // as above
pub(crate) const fn single(value: i64) -> f32 {
    rounded(value)
}

/// The same in line. Some ten instructions, where the run-time's own conversion takes four times as many.
const fn rounded(value: i64) -> f32 {
    let size = value.unsigned_abs();
    let size = (size >> 32) as u32 as f32 * 4_294_967_296.0 + size as u32 as f32;
    if value < 0 { -size } else { size }
}

/// The length of a way, lattice units.
pub(crate) fn distance(way: Vector) -> f32 {
    sqrt(single(way.dot(way)))
}

/// The inverse of the square root of a positive number, to 2 10^-7 of it. By Newton's iteration from the
/// well-known guess: some 20 instructions and the same on every machine, where libm's square root takes 150.
pub(crate) fn inverse_sqrt(x: f32) -> f32 {
    let half = 0.5 * x;
    let mut y = f32::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1)); // any number may come
    for _ in 0..3 {
        y *= 1.5 - half * y * y;
    }
    y
}

/// A unit vector, and the inverse of the length that it had.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnitVector {
    pub(crate) x: f32,
    pub(crate) z: f32,
    pub(crate) per_length: f32,
}

impl UnitVector {
    #[inline(never)] // as above
    pub(crate) fn of(v: Vector) -> Self {
        let (x, z) = (v.x as f32, v.z as f32);
        let per_length = inverse_sqrt(x * x + z * z);
        Self { x: x * per_length, z: z * per_length, per_length }
    }

    pub(crate) fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.z * other.z
    }

    /// How far a vector reaches this way, in its units.
    pub(crate) fn along(self, v: Vector) -> f32 {
        self.x * v.x as f32 + self.z * v.z as f32
    }
}

/// The square root of a number, to 10^-5 of it. 0 where rounding left less than 0, and where it is no number.
#[inline(never)] // as above
pub(crate) fn sqrt(x: f32) -> f32 {
    if x > 0.0 { root(x) } else { 0.0 }
}

/// The same in line. Newton's method on `1 / sqrt(x)`.
#[expect(clippy::inline_always, reason = "the arc cosine is called for each line of each circle")]
#[inline(always)]
fn root(x: f32) -> f32 {
    let mut inverse = f32::from_bits(0x5f37_59df_u32.wrapping_sub(x.to_bits() >> 1)); // any number may come
    for _ in 0..2 {
        inverse *= 1.5 - 0.5 * x * inverse * inverse;
    }
    x * inverse
}

/// The arc cosine of a number in [-1, 1], to 10^-4 rad. In the middle by the arc sine, without a root;
/// beyond by Abramowitz and Stegun, 4.4.45.
#[inline(never)] // it is called in three places of one small function
pub(crate) fn acos(x: f32) -> CoarseAngle {
    let size = x.abs();
    if size < 0.6 {
        let s = x * x;
        let asin = x * (1.0 + s * (0.167_385_2 + s * (0.065_445_93 + s * 0.080_477_12)));
        return CoarseAngle::QUARTER_TURN - CoarseAngle::radians(asin);
    }
    let cubic = 1.570_728_8 + size * (-0.212_114_4 + size * (0.074_261 - size * 0.018_729_3));
    let angle = CoarseAngle::radians(root(1.0 - size) * cubic);
    if x < 0.0 { CoarseAngle::HALF_TURN - angle } else { angle }
}

/// The heading of a direction, to 10^-5 rad.
pub(crate) fn heading_of(direction: Vector) -> Heading {
    heading(direction.x as f32, direction.z as f32)
}

/// The heading of a direction, to 2^-27 rad: the rough one, and the angle that is left.
pub(crate) fn precise_heading_of(direction: Vector) -> Heading {
    const UNITS_PER_RADIAN: f32 = (1_u32 << 31) as f32 / core::f32::consts::PI;
    let size = direction.x.unsigned_abs() | direction.z.unsigned_abs();
    let up = size.leading_zeros().saturating_sub(2);
    let long = Vector { x: direction.x << up, z: direction.z << up };
    let (x, z) = (long.x as f32, long.z as f32);
    let rough = heading(x, z);
    let left = 4.0 * rough.unit().left().along(long) as f32 / sqrt(x * x + z * z);
    rough.turned(Angle((left * UNITS_PER_RADIAN) as i32 as u32))
}

/// The heading of a vector, to 10^-5 rad.
pub(crate) fn heading(x: f32, z: f32) -> Heading {
    let (along, up) = (x.abs(), z.abs());
    let t = if up > along { along / up } else { up / along };
    let s = t * t;
    let tail = -0.116_432_87 + s * (0.052_653_32 - s * 0.011_721_2);
    let octant = t * (0.999_977_26 + s * (-0.332_623_47 + s * (0.193_543_46 + s * tail)));
    let octant = CoarseAngle::radians(octant);
    let quadrant = if up > along { CoarseAngle::QUARTER_TURN - octant } else { octant };
    let half = if x < 0.0 { CoarseAngle::HALF_TURN - quadrant } else { quadrant };
    (if z < 0.0 { -half } else { half }).heading()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_comes_back_from_its_unit_vector() {
        for n in 0..200_000_u32 {
            let heading = Heading(n.wrapping_mul(2_654_435_761));
            let near = heading_of(heading.unit().scaled((1 << 30) - 1));
            assert!((near.0.wrapping_sub(heading.0) as i32).unsigned_abs() < 7_000, "{heading:?}");
        }
    }

    #[test]
    fn a_precise_heading_is_one_of_short_and_long_vectors() {
        for n in 0..200_000_u32 {
            let heading = Heading(n.wrapping_mul(2_654_435_761));
            let v = heading.unit().scaled((1 << (10 + n % 20)) - 1);
            let off = precise_heading_of(v).radians() - f64::from(v.z).atan2(f64::from(v.x));
            assert!(off.sin().abs() < 7.5e-9, "{v:?}: {off}");
        }
    }

    #[test]
    fn errors_are_as_stated() {
        for n in 0..=20_000 {
            let x = n as f32 / 10_000.0 - 1.0;
            assert!(
                (acos(x).heading().radians() - f64::from(x).acos()).sin().abs() < 1e-4,
                "acos {x}"
            );
            let (sin, cos) = (n as f32 / 1000.0).sin_cos();
            for scale in [1e-3, 1.0, 1e9] {
                let (z, x) = (scale * sin, scale * cos);
                let off = heading(x, z).radians() - f64::from(z).atan2(f64::from(x));
                assert!(off.sin().abs() < 1e-5, "heading {x} {z}: {off}");
            }
            let y = n as f32 * n as f32 * 1e9 + 1e-3;
            let off = f64::from(sqrt(y)) / f64::from(y).sqrt() - 1.0;
            assert!(off.abs() < 1e-5, "sqrt {y}: {off}");
        }
        // Rounding may leave a little less than 0, or no number: none of these panics.
        for x in [0.0, -1.0, f32::NAN, -f32::NAN, f32::NEG_INFINITY] {
            assert!(sqrt(x).abs() < 1e-30);
            let _ = inverse_sqrt(x);
        }
        for x in [1.000_001, -1.000_001, f32::NAN, -f32::NAN] {
            let _ = acos(x);
        }
        assert_eq!(heading(-1.0, 0.0), Heading(1 << 31));
    }
}
