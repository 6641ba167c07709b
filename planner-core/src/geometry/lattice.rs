//! Integer positions and the one predicate that decides everything.
//!
//! A position is a [`Site`]: a point of a lattice with [`UNITS_PER_METRE`] units to the metre. Neighbouring points are
//! 15 micrometres apart, far below any localisation error. Coordinates are below 2^29 units in size (8 km). On this
//! lattice [`orient`] is exact in `i64`: no tolerance, no misclassified cut, and the same answer on every machine.

use core::ops::Sub;

use nalgebra::Point2;

use crate::geometry::value::ValueError;

/// Lattice units in a metre: a power of two, so metres and units convert without rounding error.
pub const UNITS_PER_METRE: i32 = 1 << 16;

/// Coordinates are smaller than this in size (8,192 m), which keeps [`orient`] below 2^61.
pub const LIMIT: i32 = 1 << 29;

/// A position on the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "(i32, i32)", into = "(i32, i32)"))]
pub struct Site {
    x: i32,
    z: i32,
}

/// The position is beyond the lattice (8,192 m from the origin or more), or is not a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LatticeError;

impl core::fmt::Display for LatticeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("coordinates must be finite and smaller than 8192 m in size")
    }
}

impl core::error::Error for LatticeError {}

impl From<LatticeError> for ValueError {
    fn from(_: LatticeError) -> Self {
        Self("coordinates must be finite and smaller than 8192 m in size")
    }
}

impl Site {
    /// Where both coordinates are 0.
    pub const ORIGIN: Self = Self { x: 0, z: 0 };

    /// The site at `x`, `z` in lattice units.
    ///
    /// # Errors
    /// [`LatticeError`] unless both are smaller than [`LIMIT`] in size.
    pub const fn new(x: i32, z: i32) -> Result<Self, LatticeError> {
        if -LIMIT < x && x < LIMIT && -LIMIT < z && z < LIMIT {
            Ok(Self { x, z })
        } else {
            Err(LatticeError)
        }
    }

    /// The nearest site to a place in metres: `[x, z]`, or a point of `nalgebra`.
    ///
    /// # Errors
    /// [`LatticeError`] unless both coordinates are smaller than 8,192 m in size.
    pub fn metres(place: impl Into<Point2<f64>>) -> Result<Self, LatticeError> {
        Self::try_from(place.into())
    }

    /// The nearest site to a place in millimetres. In a program for a small chip it saves the arithmetic in double precision
    /// that metres need.
    ///
    /// # Errors
    /// As [`metres`](Self::metres).
    pub const fn millimetres(x: i32, z: i32) -> Result<Self, LatticeError> {
        const fn units(millimetres: i32) -> i64 {
            let doubled = 2 * millimetres as i64 * UNITS_PER_METRE as i64;
            (doubled + 1000 * doubled.signum()) / 2000
        }
        let (x, z) = (units(x), units(z));
        let limit = LIMIT as i64;
        if -limit < x && x < limit && -limit < z && z < limit {
            Ok(Self { x: x as i32, z: z as i32 })
        } else {
            Err(LatticeError)
        }
    }

    /// First coordinate, in lattice units.
    pub const fn x(self) -> i32 {
        self.x
    }

    /// Second coordinate (the paper's `z`), in lattice units.
    pub const fn z(self) -> i32 {
        self.z
    }

    /// The corners of the lattice.
    pub(crate) const CORNERS: [Self; 2] =
        [Self { x: 1 - LIMIT, z: 1 - LIMIT }, Self { x: LIMIT - 1, z: LIMIT - 1 }];

    /// The site halfway between two, rounded.
    pub(crate) const fn between(a: Self, b: Self) -> Self {
        Self { x: a.x.midpoint(b.x), z: a.z.midpoint(b.z) }
    }

    /// The site a displacement away.
    ///
    /// # Errors
    /// [`LatticeError`] when it leaves the lattice.
    pub const fn step(self, by: Vector) -> Result<Self, LatticeError> {
        Self::new(self.x.saturating_add(by.x), self.z.saturating_add(by.z))
    }
}

/// Metres to the nearest site.
impl TryFrom<Point2<f64>> for Site {
    type Error = LatticeError;

    fn try_from(metres: Point2<f64>) -> Result<Self, LatticeError> {
        let x = libm::round(metres.x * f64::from(UNITS_PER_METRE));
        let z = libm::round(metres.y * f64::from(UNITS_PER_METRE));
        let limit = f64::from(LIMIT);
        if x.abs() < limit && z.abs() < limit {
            Self::new(x as i32, z as i32)
        } else {
            Err(LatticeError) // NaN compares false and ends here too
        }
    }
}

/// Metres to the nearest site.
impl TryFrom<Point2<f32>> for Site {
    type Error = LatticeError;

    fn try_from(metres: Point2<f32>) -> Result<Self, LatticeError> {
        Self::try_from(Point2::new(f64::from(metres.x), f64::from(metres.y)))
    }
}

/// Metres, exactly.
impl From<Site> for Point2<f64> {
    fn from(site: Site) -> Self {
        let scale = 1.0 / f64::from(UNITS_PER_METRE);
        Self::new(f64::from(site.x) * scale, f64::from(site.z) * scale)
    }
}

/// Metres, rounded to single precision: exact within 256 m of the origin.
impl From<Site> for Point2<f32> {
    fn from(site: Site) -> Self {
        let scale = 1.0 / UNITS_PER_METRE as f32;
        Self::new(site.x as f32 * scale, site.z as f32 * scale)
    }
}

impl From<Site> for (i32, i32) {
    fn from(site: Site) -> Self {
        (site.x, site.z)
    }
}

impl TryFrom<(i32, i32)> for Site {
    type Error = LatticeError;

    fn try_from((x, z): (i32, i32)) -> Result<Self, LatticeError> {
        Self::new(x, z)
    }
}

/// A displacement or a direction in the plane, in integer units.
///
/// Components are smaller than 2^30 in size, as differences of sites and steps of rays are, which
/// keeps [`cross`](Self::cross) and [`dot`](Self::dot) exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Vector {
    pub(crate) x: i32,
    pub(crate) z: i32,
}

impl Vector {
    /// The vector with these components; `None` unless both are smaller than 2^30 in size.
    pub const fn new(x: i32, z: i32) -> Option<Self> {
        const BOUND: u32 = 1 << 30;
        if x.unsigned_abs() < BOUND && z.unsigned_abs() < BOUND {
            Some(Self { x, z })
        } else {
            None
        }
    }

    /// First component.
    pub const fn x(self) -> i32 {
        self.x
    }

    /// Second component.
    pub const fn z(self) -> i32 {
        self.z
    }

    /// `self.x other.z - self.z other.x`: positive when `other` lies to the left of `self`.
    pub const fn cross(self, other: Self) -> i64 {
        self.x as i64 * other.z as i64 - self.z as i64 * other.x as i64
    }

    /// The scalar product.
    pub const fn dot(self, other: Self) -> i64 {
        self.x as i64 * other.x as i64 + self.z as i64 * other.z as i64
    }

    /// A quarter turn to the left.
    #[must_use]
    pub const fn left(self) -> Self {
        Self { x: -self.z, z: self.x }
    }

    /// The opposite direction.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self { x: -self.x, z: -self.z }
    }
}

impl Sub for Site {
    type Output = Vector;

    fn sub(self, from: Self) -> Vector {
        Vector { x: self.x - from.x, z: self.z - from.z }
    }
}

/// The orientation predicate: positive when `q` lies to the left of the line from `a` to `b`,
/// negative to its right, zero on it. Exact.
pub fn orient(a: Site, b: Site, q: Site) -> i64 {
    (b - a).cross(q - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metres_survive_the_round_trip() {
        let site = Site::new(-LIMIT + 1, 12_345).unwrap();
        assert_eq!(Site::try_from(Point2::<f64>::from(site)), Ok(site));
        let near = Site::new(16_777_215, -3).unwrap();
        assert_eq!(Site::try_from(Point2::<f32>::from(near)), Ok(near));
    }

    #[test]
    fn millimetres_are_a_thousandth_of_metres() {
        for x in (-8_193_000..=8_193_000).step_by(997) {
            let metres = Site::metres([f64::from(x) * 1e-3, 0.5]);
            assert_eq!(Site::millimetres(x, 500), metres, "{x}");
        }
        for bad in [i32::MIN, -8_192_000, 8_192_000, i32::MAX] {
            assert_eq!(Site::millimetres(0, bad), Err(LatticeError), "{bad}");
        }
    }

    #[test]
    fn what_is_no_position_is_refused() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 8192.0, -8192.0, 1e300] {
            assert_eq!(Site::try_from(Point2::new(0.0, bad)), Err(LatticeError), "{bad}");
            assert_eq!(Site::try_from(Point2::new(bad, 0.0)), Err(LatticeError), "{bad}");
        }
        assert!(Site::new(LIMIT, 0).is_err());
        let edge = Site::new(LIMIT - 1, 0).unwrap();
        assert!(edge.step(Vector { x: i32::MAX, z: 0 }).is_err());
    }

    #[test]
    fn no_vector_overflows() {
        for bad in [i32::MIN, i32::MAX, 1 << 30, -(1 << 30)] {
            assert_eq!((Vector::new(bad, 0), Vector::new(0, bad)), (None, None));
        }
        let most = (1 << 30) - 1;
        let v = Vector::new(-most, most).unwrap();
        assert_eq!(v.left(), v.left().reversed().reversed());
        assert_eq!((v.dot(v), v.cross(v.left())), (2 * i64::from(most).pow(2), v.dot(v)));
    }

    #[test]
    fn the_largest_orientation_does_not_overflow() {
        let corner = |x, z| Site::new(x * (LIMIT - 1), z * (LIMIT - 1)).unwrap();
        let (a, b, q) = (corner(-1, -1), corner(1, -1), corner(-1, 1));
        let side = i64::from(2 * (LIMIT - 1));
        assert_eq!(orient(a, b, q), side * side);
        assert_eq!(orient(b, a, q), -side * side);
        assert_eq!(orient(a, corner(1, 1), corner(0, 0)), 0);
    }
}
