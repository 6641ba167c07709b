//! Positions that err: where to insert a sample whose true place is only known to be near the reported one.
//!
//! **Labels that are true** are shifted. Let the true position be within `e` of the reported `q`. A line is
//! `n . q + c = 0`, where `n` is its unit normal and points to its +1 side. Let the normals of all lines that are left
//! lie within the angle `d` of the middle one, `b`. If a line has the true position on its +1 side, `q` lies no further
//! than `e` on its other side. The place `q + (e / cos d) b` then satisfies
//!
//! ```text
//!   n . (q + (e / cos d) b) + c  >=  -e + (e / cos d) (n . b)  >=  -e + e  =  0
//! ```
//!
//! so a label +1 is true at that place, whichever position within `e` is the true one. The sample is inserted at this
//! *shifted* place as an exact one. A label -1 is shifted as far the other way. So the true line is never cut off, and
//! cells stay what they are. As the lines' arc narrows, `d` falls and the shift decreases towards the tolerance.
//!
//! **Labels that may be wrong** are not shifted but doubted: the nearer a line passes, the more. The true position is
//! spread about the reported one with the standard deviation `sigma`, a third of the tolerance. Let the reported
//! position be at the distance `s` from a line, positive on its +1 side. Let labels be true with probability `p`. For
//! that line a label +1 then has the probability `p Phi(s / sigma) + (1 - p) Phi(-s / sigma)`. See [`CellPosterior`],
//! and `belief/doubtful_labels/blur.rs` for the calculation.
//!
//! [`CellPosterior`]: crate::belief::doubtful_labels::CellPosterior

use crate::geometry::approximate::UnitVector;
use crate::geometry::arc::SlopeArc;
use crate::geometry::lattice::{UNITS_PER_METRE, Vector};
use crate::geometry::value::ValueError;

/// How far a position may be from where it is reported to be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u32", into = "u32"))]
pub struct Tolerance {
    /// Lattice units.
    units: u32,
}

/// The largest tolerance, lattice units: 1,024 m.
const MOST: u32 = 1 << 26;

const RANGE: ValueError = ValueError("a tolerance is from 0 to 1024 m");

/// The longest shift, lattice units: 4,096 m.
const FARTHEST: f32 = (1 << 28) as f32;

/// The least value of `1 + cos 2d`, half the square of the sum of an arc's two unit normals. Arcs up to 88 degrees to
/// either side of their middle have a shift. Rounding changes the value by 10^-6 there.
const LEAST: f32 = 2.4e-3;

impl Tolerance {
    /// Positions are where they are reported to be.
    pub const NONE: Self = Self { units: 0 };

    /// A tolerance in metres, rounded up to lattice units.
    ///
    /// # Errors
    /// [`ValueError`] unless it is at least 0 and at most 1,024.
    pub fn new(metres: f64) -> Result<Self, ValueError> {
        let units = libm::ceil(metres * f64::from(UNITS_PER_METRE));
        let is_one = (0.0..=f64::from(MOST)).contains(&units);
        is_one.then_some(Self { units: units as u32 }).ok_or(RANGE)
    }

    /// The tolerance in metres.
    pub fn metres(self) -> f64 {
        f64::from(self.units) / f64::from(UNITS_PER_METRE)
    }

    /// The tolerance in lattice units.
    pub const fn units(self) -> u32 {
        self.units
    }

    /// The displacement of a sample of label +1 for lines with these slopes; `None` if they span so much that the shift
    /// would be too long.
    pub fn shift(self, slopes: SlopeArc) -> Option<Vector> {
        if self == Self::NONE {
            return Some(Vector { x: 0, z: 0 });
        }
        let [from, to] = [slopes.from(), slopes.to()].map(|along| UnitVector::of(along.left()));
        let sum = [from.x + to.x, from.z + to.z];
        // `|sum|` is `2 cos d`, so this is `(e / cos d) b`, with a thousandth and two units for rounding.
        let half_square = 0.5 * (sum[0] * sum[0] + sum[1] * sum[1]);
        if half_square < LEAST {
            return None;
        }
        let scale = (self.units as f32 + 2.0) * (1.0 + 1.0 / 1024.0) / half_square;
        let [x, z] = sum.map(|v| v * scale);
        (x.abs() < FARTHEST && z.abs() < FARTHEST).then_some(Vector { x: x as i32, z: z as i32 })
    }
}

/// A tolerance in two bytes, rounded up by a thousandth at most: eleven digits and an exponent. All zeros for none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Short(u16);

impl Short {
    const DIGITS: u32 = 11;

    pub(crate) const NONE: Self = Self(0);

    pub(crate) const fn of(Tolerance { units }: Tolerance) -> Self {
        let exponent = (u32::BITS - units.leading_zeros()).saturating_sub(Self::DIGITS);
        let digits = (units + (1 << exponent) - 1) >> exponent;
        // Rounded up to one digit more, it is a power of two.
        let carry = digits >> Self::DIGITS;
        Self(((exponent + carry) << Self::DIGITS | digits >> carry) as u16)
    }

    /// What it stands for, but no more than the most that was configured.
    pub(crate) fn at_most(self, most: Tolerance) -> Tolerance {
        let Self(code) = self;
        let units = u32::from(code & ((1 << Self::DIGITS) - 1)) << (code >> Self::DIGITS);
        most.min(Tolerance { units })
    }
}

impl TryFrom<u32> for Tolerance {
    type Error = ValueError;

    fn try_from(units: u32) -> Result<Self, ValueError> {
        (units <= MOST).then_some(Self { units }).ok_or(RANGE)
    }
}

/// Metres, as [`Tolerance::new`].
impl TryFrom<f64> for Tolerance {
    type Error = ValueError;

    fn try_from(metres: f64) -> Result<Self, ValueError> {
        Self::new(metres)
    }
}

impl From<Tolerance> for u32 {
    fn from(tolerance: Tolerance) -> Self {
        tolerance.units
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;

    /// Whatever normal of the arc a line has, the shift is at least the tolerance along it, and hardly more along
    /// the outermost.
    #[test]
    fn a_shift_is_enough_for_every_line_of_the_arc_and_no_more() {
        let mut draws = Draws::new(7);
        for round in 0..20_000 {
            let (angle, half) = (core::f64::consts::TAU * draws.unit(), 1.5 * draws.unit());
            let unit = |at: f64| {
                let (sin, cos) = libm::sincos(at);
                Vector { x: (cos * 1e9) as i32, z: (sin * 1e9) as i32 }
            };
            let slopes = SlopeArc::new(unit(angle - half), unit(angle + half));
            let tolerance = Tolerance { units: 1 + draws.below(1 << 20) };
            let shift = tolerance.shift(slopes).unwrap();
            let along = |at: f64| {
                let (sin, cos) = libm::sincos(at);
                f64::from(shift.z) * cos - f64::from(shift.x) * sin
            };
            let e = f64::from(tolerance.units);
            for k in 0..=10 {
                let at = angle + half * (f64::from(k) / 5.0 - 1.0);
                assert!(along(at) >= e, "{round}: {} of {e}", along(at));
            }
            let most = e * 1.002 + 4.0;
            assert!(along(angle - half) < most && along(angle + half) < most, "{round}");
        }
    }

    #[test]
    fn short_ones_are_a_thousandth_more_at_most_and_stay_what_they_are() {
        let most = Tolerance { units: MOST };
        let numbers = (0..5_000).chain((0..30_000).map(|n| n * 2_236)).chain([MOST - 1, MOST]);
        for units in numbers {
            let exact = Tolerance { units };
            let short = Short::of(exact).at_most(most);
            assert!(short >= exact && short.units <= units + units / 1_000, "{units}");
            assert_eq!(Short::of(short).at_most(most), short, "{units}");
            assert_eq!(Short::of(exact).at_most(exact), exact);
        }
    }

    #[test]
    fn nothing_is_shifted_without_a_tolerance_and_nothing_out_of_sight() {
        let v = |x, z| Vector { x, z };
        let wide = SlopeArc::new(v(1 << 20, 1 << 10), v(-(1 << 20), 1 << 10));
        assert_eq!(Tolerance::NONE.shift(wide), Some(v(0, 0)));
        assert_eq!(Tolerance { units: 100 }.shift(wide), None);
        let narrow = SlopeArc::new(v(1 << 20, 0), v(1 << 20, 1));
        assert!(Tolerance { units: MOST }.shift(narrow).is_some());
        assert_eq!(Tolerance::new(-0.1), Err(RANGE));
        assert_eq!(Tolerance::new(f64::NAN), Err(RANGE));
        assert_eq!(Tolerance::new(1024.1), Err(RANGE));
        assert_eq!(Tolerance::new(0.15).map(|it| it.units), Ok(9_831));
        assert_eq!(Tolerance::try_from(MOST + 1), Err(RANGE));
    }
}
