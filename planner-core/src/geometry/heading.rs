//! Headings and the angles between them as binary angles, and unit vectors.

use crate::geometry::lattice::Vector;
use crate::geometry::value::ValueError;

/// A heading as a binary angle: a whole turn is 2^32, so it wraps by itself and sums of turns are
/// exact. Counter-clockwise from the x axis; a unit is 1.5 nanoradians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Heading(pub u32);

/// Binary-angle units in a radian.
const UNITS_PER_RADIAN: f64 = 4_294_967_296.0 / core::f64::consts::TAU;

const FINITE: ValueError = ValueError("a heading is a finite angle");

impl Heading {
    /// The nearest heading to an angle in radians.
    ///
    /// # Errors
    /// [`ValueError`] unless the angle is finite.
    pub fn from_radians(angle: f64) -> Result<Self, ValueError> {
        let turns = libm::fmod(angle, core::f64::consts::TAU) * UNITS_PER_RADIAN;
        let is_heading = turns.is_finite();
        is_heading.then(|| Self(libm::round(turns) as i64 as u32)).ok_or(FINITE)
    }

    /// The nearest heading to an angle in degrees.
    ///
    /// # Errors
    /// [`ValueError`] unless the angle is finite.
    pub fn from_degrees(angle: f64) -> Result<Self, ValueError> {
        Self::from_radians(angle.to_radians())
    }

    /// The angle in radians, in [-pi, pi).
    pub fn radians(self) -> f64 {
        f64::from(self.0 as i32) / UNITS_PER_RADIAN
    }

    /// The heading after a turn (to the left when below half a turn).
    #[must_use]
    pub const fn turned(self, by: Angle) -> Self {
        Self(self.0.wrapping_add(by.0))
    }

    /// The turn from another heading to this one.
    pub const fn since(self, other: Self) -> Angle {
        Angle(self.0.wrapping_sub(other.0))
    }

    /// Whether another heading is less than a quarter turn away.
    pub(crate) const fn agrees(self, other: Self) -> bool {
        (self.since(other).0 as i32).unsigned_abs() < 1 << 30
    }

    /// The unit vector of this heading, to 2^-29. Integers alone: some 110 instructions.
    pub const fn unit(self) -> SinCos {
        // Within an eighth of a turn of a multiple of a quarter, sine and cosine are short series.
        let quarters = self.0.wrapping_add(1 << 29) >> 30;
        let angle = self.0.wrapping_sub(quarters << 30) as i32;
        let x = round_shift(angle as i64 * PI_30, 31);
        let square = product(x, x);
        let sin = product(x, series(square, &SIN));
        let cos = series(square, &COS);
        let (cos, sin) = match quarters {
            0 => (cos, sin),
            1 => (-sin, cos),
            2 => (-cos, -sin),
            _ => (sin, -cos),
        };
        SinCos { cos, sin }
    }
}

/// An angle between two headings, a turn to the left, in a [`Heading`]'s units: a whole turn is 2^32.
///
/// A turn to the right is the turn to the left that leads to the same heading, so sums wrap here too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Angle(pub u32);

impl Angle {
    /// Half a turn.
    pub const HALF_TURN: Self = Self(1 << 31);

    /// An angle of so many radians, from 0 to below 2 pi, rounded down.
    pub(crate) const fn of_radians(radians: f64) -> Self {
        Self((radians * UNITS_PER_RADIAN) as u32)
    }

    /// The nearest angle to so many radians.
    ///
    /// # Errors
    /// [`ValueError`] unless they are at least 0 and below 2 pi.
    pub fn from_radians(radians: f64) -> Result<Self, ValueError> {
        const RANGE: ValueError = ValueError("an angle is from 0 to below a whole turn");
        let is_angle = (0.0..core::f64::consts::TAU).contains(&radians);
        let Heading(units) =
            is_angle.then_some(radians).ok_or(RANGE).and_then(Heading::from_radians)?;
        Ok(Self(units))
    }

    /// The nearest angle to so many degrees.
    ///
    /// # Errors
    /// [`ValueError`] unless they are at least 0 and below 360.
    pub fn from_degrees(degrees: f64) -> Result<Self, ValueError> {
        Self::from_radians(degrees.to_radians())
    }

    /// Its cosine and sine.
    pub(crate) const fn unit(self) -> SinCos {
        Heading(self.0).unit()
    }

    /// The angle in radians, in [-pi, pi); negative to the right.
    pub fn radians(self) -> f64 {
        Heading(self.0).radians()
    }

    /// The same turn to the other side.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        Self(self.0.wrapping_neg())
    }
}

/// Pi with 30 fractional bits.
const PI_30: i64 = 3_373_259_426;

/// Coefficients of the sine's series in the square, without its factor `x`, with 30 fractional bits.
const SIN: [i32; 6] = [1 << 30, -178_956_971, 8_947_849, -213_044, 2959, -27];

/// Coefficients of the cosine's series in the square, with 30 fractional bits.
const COS: [i32; 6] = [1 << 30, -536_870_912, 44_739_243, -1_491_308, 26_631, -296];

/// A polynomial by Horner's rule, with 30 fractional bits.
const fn series(x: i32, coefficients: &[i32; 6]) -> i32 {
    let [c0, c1, c2, c3, c4, c5] = *coefficients;
    c0 + product(x, c1 + product(x, c2 + product(x, c3 + product(x, c4 + product(x, c5)))))
}

/// A product with 30 fractional bits.
const fn product(a: i32, b: i32) -> i32 {
    round_shift(a as i64 * b as i64, 30)
}

/// A unit vector in fixed point with 30 fractional bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SinCos {
    cos: i32,
    sin: i32,
}

impl SinCos {
    /// No direction: all zeros in memory.
    pub(crate) const ZERO: Self = Self { cos: 0, sin: 0 };

    /// The vector of this direction with the given length (below 2^30), to the nearest integers.
    pub const fn scaled(self, length: i32) -> Vector {
        let length = length as i64;
        Vector {
            x: round_shift(self.cos as i64 * length, 30),
            z: round_shift(self.sin as i64 * length, 30),
        }
    }

    /// A quarter turn to the left.
    pub(crate) const fn left(self) -> Self {
        Self { cos: -self.sin, sin: self.cos }
    }

    /// The sine of its turn to the left from another direction.
    pub(crate) fn turn_from(self, other: Self) -> f32 {
        const UNIT: f32 = 1.0 / (1_u64 << 60) as f32;
        let [from, to] = [other, self].map(|it| Vector { x: it.cos, z: it.sin });
        let across = from.cross(to);
        across as f32 * UNIT
    }

    /// How far a vector reaches in this direction, rounded down to a multiple of four and divided by four:
    /// the upper word of the product. The vector's components may have any size.
    pub(crate) const fn along(self, v: Vector) -> i32 {
        ((self.cos as i64 * v.x as i64 + self.sin as i64 * v.z as i64) >> 32) as i32
    }
}

const fn round_shift(value: i64, bits: u32) -> i32 {
    ((value + (1 << (bits - 1))) >> bits) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_wrap() {
        let quarter = Heading::from_radians(core::f64::consts::FRAC_PI_2).unwrap();
        assert_eq!(quarter, Heading(1 << 30));
        assert_eq!(
            Heading::from_radians(-1e-9),
            Heading::from_radians(core::f64::consts::TAU - 1e-9)
        );
        let turn = Angle(1 << 30);
        assert_eq!(quarter.turned(turn).turned(turn), Heading(0).turned(turn.mirrored()));
        assert_eq!(Heading::from_radians(f64::NAN), Err(FINITE));
        assert_eq!(Heading::from_radians(f64::INFINITY), Err(FINITE));
    }

    #[test]
    fn unit_vectors_are_true_to_the_last_bits() {
        let scale = f64::from(1 << 30);
        for n in 0..200_000_u32 {
            let heading = Heading(n.wrapping_mul(2_654_435_761));
            let (sin, cos) = heading.radians().sin_cos();
            let SinCos { cos: c, sin: s } = heading.unit();
            let off = [(f64::from(c), cos), (f64::from(s), sin)].map(|(got, is)| got - is * scale);
            assert!(off.iter().all(|off| off.abs() < 2.0), "{heading:?}: {off:?}");
        }
        assert_eq!(Heading(1 << 30).unit(), SinCos { cos: 0, sin: 1 << 30 });
    }
}
