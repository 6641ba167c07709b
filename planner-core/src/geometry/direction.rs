//! Directions: headings as binary angles, rotations, and arcs modulo pi.

use heapless::Vec;

use crate::geometry::approximate::{atan2, sqrt};
use crate::geometry::lattice::Vector;

/// A heading as a binary angle: a whole turn is 2^32, so it wraps by itself and sums of turns are
/// exact. Counter-clockwise from the x axis; a unit is 1.5 nanoradians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Heading(pub u32);

/// Binary-angle units in a radian.
const UNITS_PER_RADIAN: f64 = 4_294_967_296.0 / core::f64::consts::TAU;

impl Heading {
    /// The nearest heading to an angle in radians; `None` unless it is finite.
    pub fn from_radians(angle: f64) -> Option<Self> {
        let turns = libm::fmod(angle, core::f64::consts::TAU) * UNITS_PER_RADIAN;
        turns.is_finite().then(|| Self(libm::round(turns) as i64 as u32))
    }

    /// The angle in radians, in [-pi, pi).
    pub fn radians(self) -> f64 {
        f64::from(self.0 as i32) / UNITS_PER_RADIAN
    }

    /// The heading after a turn (to the left when below half a turn).
    #[must_use]
    pub const fn turned(self, by: Self) -> Self {
        Self(self.0.wrapping_add(by.0))
    }

    /// The same turn to the other side.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        Self(self.0.wrapping_neg())
    }

    /// The unit vector of this heading, to 2^-29. Integers alone: some 60 instructions.
    pub const fn unit(self) -> Unit {
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
        Unit { cos, sin }
    }

    /// The heading of a direction, to 10^-5 rad: it proposes, and decides nothing.
    pub(crate) fn near(direction: Vector) -> Self {
        Self(atan2(direction.z as f32, direction.x as f32))
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
pub struct Unit {
    cos: i32,
    sin: i32,
}

impl Unit {
    /// The vector of this direction with the given length (below 2^30), to the nearest integers.
    pub const fn scaled(self, length: i32) -> Vector {
        let length = length as i64;
        Vector {
            x: round_shift(self.cos as i64 * length, 30),
            z: round_shift(self.sin as i64 * length, 30),
        }
    }
}

const fn round_shift(value: i64, bits: u32) -> i32 {
    ((value + (1 << (bits - 1))) >> bits) as i32
}

/// An arc of directions modulo pi, narrower than pi: the paper's `E_rho`, as the exact directions
/// of its two ends.
///
/// A line has no front, so a direction lies in the arc when it or its opposite does. An arc across
/// the vertical is the paper's "disjoint union of two intervals".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Arc {
    from: Vector,
    to: Vector,
}

impl Arc {
    /// The arc that runs counter-clockwise from one direction to another, less than half a turn.
    pub const fn new(from: Vector, to: Vector) -> Self {
        Self { from, to }
    }

    /// The arc that spans all these oriented directions, which lie within half a turn of each
    /// other; `None` when there are none.
    pub fn spanning(directions: impl IntoIterator<Item = Vector>) -> Option<Self> {
        directions.into_iter().fold(None, |arc, d| {
            let Self { from, to } = arc.unwrap_or(Self { from: d, to: d });
            Some(Self {
                from: if from.cross(d) < 0 { d } else { from },
                to: if to.cross(d) > 0 { d } else { to },
            })
        })
    }

    /// The arc that spans two which lie within half a turn of each other.
    #[must_use]
    pub const fn hull(self, other: Self) -> Self {
        Self {
            from: if self.from.cross(other.from) < 0 { other.from } else { self.from },
            to: if self.to.cross(other.to) > 0 { other.to } else { self.to },
        }
    }

    /// The arc of directions that track one: within 1/64 of it in tangent (0.9 degrees), so that
    /// some ray of the paper's grid, which are 0.57 degrees apart, always does.
    pub const fn tracking(direction: Vector) -> Self {
        let (d, aside) = (direction, direction.left());
        Self {
            from: Vector { x: d.x - aside.x / 64, z: d.z - aside.z / 64 },
            to: Vector { x: d.x + aside.x / 64, z: d.z + aside.z / 64 },
        }
    }

    /// The directions of this arc that track its bisector.
    #[must_use]
    pub fn middle(&self) -> Self {
        let middle = Self::tracking(self.bisector());
        if self.contains(middle.from) { middle } else { *self }
    }

    /// Where the arc begins.
    pub const fn from(&self) -> Vector {
        self.from
    }

    /// Where the arc ends, counter-clockwise from its beginning.
    pub const fn to(&self) -> Vector {
        self.to
    }

    /// Whether the direction or its opposite lies in the arc, ends included. Exact.
    pub const fn contains(&self, direction: Vector) -> bool {
        let (from, to) = (self.from.cross(direction), direction.cross(self.to));
        (from >= 0 && to >= 0) || (from <= 0 && to <= 0)
    }

    /// The direction that halves the arc, some 2^28 units long. Rounded: it proposes, and decides
    /// nothing.
    pub fn bisector(&self) -> Vector {
        let unit = |v: Vector| {
            let (x, z) = (v.x as f32, v.z as f32);
            let scale = (1 << 27) as f32 / sqrt(x * x + z * z);
            (x * scale, z * scale)
        };
        let ((ax, az), (bx, bz)) = (unit(self.from), unit(self.to));
        Vector { x: (ax + bx) as i32, z: (az + bz) as i32 }
    }

    /// Width in degrees.
    pub fn width_deg(&self) -> f64 {
        libm::atan2(self.from.cross(self.to) as f64, self.from.dot(self.to) as f64).to_degrees()
    }

    /// The arc as intervals of slope angles in degrees within [-90, 90]: one, or two when it
    /// crosses the vertical.
    pub fn intervals_deg(&self) -> Vec<[f64; 2], 2> {
        let angle = |v: Vector| {
            let v = if v.x < 0 { v.reversed() } else { v };
            libm::atan2(f64::from(v.z), f64::from(v.x)).to_degrees()
        };
        // Oriented, the arc crosses the vertical exactly when its ends point to opposite sides.
        let crosses = (self.from.x > 0 && self.to.x < 0) || (self.from.x < 0 && self.to.x > 0);
        // An end on the vertical is 90 or -90, whichever side the arc lies on.
        let from = if self.from.x == 0 { -90.0 } else { angle(self.from) };
        let to = if self.to.x == 0 { 90.0 } else { angle(self.to) };
        if crosses {
            Vec::from_array([[-90.0, to], [from, 90.0]])
        } else {
            Vec::from_iter([[from, to]])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn v(x: i32, z: i32) -> Vector {
        Vector { x, z }
    }

    #[test]
    fn headings_wrap() {
        let quarter = Heading::from_radians(core::f64::consts::FRAC_PI_2).unwrap();
        assert_eq!(quarter, Heading(1 << 30));
        assert_eq!(
            Heading::from_radians(-1e-9),
            Heading::from_radians(core::f64::consts::TAU - 1e-9)
        );
        assert_eq!(quarter.turned(quarter).turned(quarter), quarter.mirrored());
        assert_eq!(Heading::from_radians(f64::NAN), None);
        assert_eq!(Heading::from_radians(f64::INFINITY), None);
    }

    #[test]
    fn unit_vectors_are_true_to_the_last_bits() {
        let scale = f64::from(1 << 30);
        for n in 0..200_000_u32 {
            let heading = Heading(n.wrapping_mul(2_654_435_761));
            let (sin, cos) = heading.radians().sin_cos();
            let Unit { cos: c, sin: s } = heading.unit();
            let off = [(f64::from(c), cos), (f64::from(s), sin)].map(|(got, is)| got - is * scale);
            assert!(off.iter().all(|off| off.abs() < 2.0), "{heading:?}: {off:?}");
            let near = Heading::near(Vector { x: c, z: s });
            assert!((near.0.wrapping_sub(heading.0) as i32).unsigned_abs() < 7_000, "{heading:?}");
        }
        assert_eq!(Heading(1 << 30).unit(), Unit { cos: 0, sin: 1 << 30 });
    }

    #[test]
    fn a_direction_and_its_opposite_are_one() {
        let arc = Arc::new(v(10, -1), v(10, 7));
        for (direction, inside) in [
            (v(1, 0), true),
            (v(-1, 0), true),
            (v(10, 7), true),
            (v(-10, 1), true),
            (v(0, 1), false),
        ] {
            assert_eq!(arc.contains(direction), inside, "{direction:?}");
        }
        assert!(Arc::new(v(1, 1), v(1, 1)).contains(v(-3, -3)));
        assert!(!Arc::new(v(1, 1), v(1, 1)).contains(v(3, 2)));
    }

    #[test]
    fn an_arc_across_the_vertical_is_two_intervals() {
        assert_eq!(Arc::new(v(1, 1), v(-1, 1)).intervals_deg(), [[-90.0, -45.0], [45.0, 90.0]]);
        assert_eq!(Arc::new(v(-1, -1), v(1, -1)).intervals_deg(), [[-90.0, -45.0], [45.0, 90.0]]);
        assert_eq!(Arc::new(v(1, -1), v(1, 1)).intervals_deg(), [[-45.0, 45.0]]);
        assert_eq!(Arc::new(v(-1, 1), v(-1, -1)).intervals_deg(), [[-45.0, 45.0]]);
        assert_eq!(Arc::new(v(1, 1), v(0, 1)).intervals_deg(), [[45.0, 90.0]]);
        assert_eq!(Arc::new(v(0, 1), v(-1, 1)).intervals_deg(), [[-90.0, -45.0]]);
    }

    #[test]
    fn the_arc_of_several_directions_has_their_outermost_as_ends() {
        let arc = Arc::spanning([v(3, 1), v(1, 3), v(2, -1), v(1, 1)]).unwrap();
        assert_eq!((arc.from(), arc.to()), (v(2, -1), v(1, 3)));
        assert!(arc.contains(arc.bisector()));
        assert_eq!(Arc::spanning([]), None);
    }
}
