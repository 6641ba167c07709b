//! Lines: exact ones through two samples, and the ones that are read out in metres.

use nalgebra::{Point2, Vector2};

use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::local_line::LocalLine;

/// A line `a x + b z + c = 0` in metres, positive on the +1 side.
///
/// Homogeneous, so a vertical line is a line like any other; where the paper's `z = rho x + c`
/// exists, [`slope`](Self::slope) and [`intercept`](Self::intercept) give it. Lines are read-outs:
/// no decision of the planner depends on one.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Line {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
}

/// As `z = 0.4100 x + 3.5000`, or `x = 7.2500` for a vertical line; metres.
impl core::fmt::Display for Line {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match (self.slope(), self.intercept()) {
            (Some(slope), Some(intercept)) => {
                let sign = if intercept < 0.0 { '-' } else { '+' };
                write!(f, "z = {slope:.4} x {sign} {:.4}", intercept.abs())
            }
            _ => write!(f, "x = {:.4}", -self.c / self.a),
        }
    }
}

impl Line {
    /// The line with these coefficients.
    ///
    /// `None` when one of them is not finite, when `a` and `b` are both zero, or when the distance from the origin is
    /// not finite.
    pub fn from_coefficients(a: f64, b: f64, c: f64) -> Option<Self> {
        // Scaled by a power of two no ratio changes, and no product with a coordinate overflows.
        let (_, exponent) = libm::frexp(a.abs().max(b.abs()));
        let [a, b, c] = [a, b, c].map(|it| libm::scalbn(it, -exponent));
        let line = Self { a, b, c };
        let norm = line.norm();
        (norm > 0.0 && norm.is_finite() && (c / norm).is_finite()).then_some(line)
    }

    /// `z = slope x + intercept`, +1 above it. `None` unless both are finite.
    pub fn from_slope(slope: f64, intercept: f64) -> Option<Self> {
        Self::from_coefficients(-slope, 1.0, -intercept)
    }

    /// The line through a point with a given normal, +1 on the side to which the normal points.
    ///
    /// `None` when one of these is not finite, or the normal is zero.
    pub fn through(point: Point2<f64>, normal: Vector2<f64>) -> Option<Self> {
        let (a, b, c) = (normal.x, normal.y, -normal.dot(&point.coords));
        let is_one = (a != 0.0 || b != 0.0) && (a + b).is_finite() && c.is_finite();
        is_one.then_some(Self { a, b, c })
    }

    pub(crate) fn norm(&self) -> f64 {
        libm::hypot(self.a, self.b)
    }

    /// The coefficients `a`, `b`, `c`, scaled to `a^2 + b^2 = 1`.
    pub fn coefficients(&self) -> [f64; 3] {
        [self.a, self.b, self.c].map(|it| it / self.norm())
    }

    /// Signed distance of a point in metres, positive on the +1 side.
    pub fn distance(&self, point: Point2<f64>) -> f64 {
        (self.a * point.x + self.b * point.y + self.c) / self.norm()
    }

    /// The paper's `rho`; `None` for a vertical line.
    pub fn slope(&self) -> Option<f64> {
        (self.b != 0.0).then(|| -self.a / self.b + 0.0)
    }

    /// The paper's `c`, in metres: where the line meets `x = 0`; `None` for a vertical line.
    pub fn intercept(&self) -> Option<f64> {
        (self.b != 0.0).then(|| -self.c / self.b + 0.0)
    }

    /// Angle of the line against the x axis, degrees in (-90, 90].
    pub fn angle_deg(&self) -> f64 {
        let (run, rise) = (self.b.abs(), if self.b < 0.0 { self.a } else { -self.a });
        if run == 0.0 { 90.0 } else { libm::atan2(rise + 0.0, run).to_degrees() }
    }

    /// Angle between the two lines, degrees in [0, 90].
    pub fn angle_to_deg(&self, other: &Self) -> f64 {
        let cross = self.a * other.b - self.b * other.a;
        let dot = self.a * other.a + self.b * other.b;
        libm::atan2(cross.abs(), dot.abs()).to_degrees()
    }
}

/// The exact line through two samples, one of the paper's bounds `l_ij`.
///
/// In the space of lines it is a vertex of a cell, see [`DualCell`](crate::belief::cells::DualCell). It is oriented
/// so that its +1 side is to the left of its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Bound {
    /// A site on the line.
    pub through: Site,
    /// The direction of the line, in lattice units. Never zero.
    pub along: Vector,
}

impl Bound {
    /// Positive when `q` is on the +1 side, negative on the other, zero on the line. Exact.
    pub fn at(&self, q: Site) -> i64 {
        self.along.cross(q - self.through)
    }

    /// The intercept in metres; `None` for a vertical line.
    pub fn intercept(&self) -> Option<f64> {
        let run = self.along.x;
        // The numerator is exact, so a line kilometres away loses nothing to cancellation.
        let rise = i64::from(self.through.z()) * i64::from(run)
            - i64::from(self.through.x()) * i64::from(self.along.z);
        (run != 0).then(|| rise as f64 / (f64::from(run) * f64::from(UNITS_PER_METRE)) + 0.0)
    }
}

/// The bound in metres, rounded.
impl From<Bound> for Line {
    fn from(bound: Bound) -> Self {
        let through = Point2::<f64>::from(bound.through);
        let (a, b) = (-f64::from(bound.along.z), f64::from(bound.along.x));
        Self { a, b, c: -(a * through.x + b * through.y) }
    }
}

/// The line in metres from the origin.
impl From<LocalLine> for Line {
    fn from(local: LocalLine) -> Self {
        let vector = |v: Vector| Vector2::new(f64::from(v.x), f64::from(v.z)).normalize();
        let (along, left) = (vector(local.along), vector(local.along.left()));
        let normal = left - along * f64::from(local.slope);
        let about = Point2::<f64>::from(local.about);
        let c = -normal.dot(&about.coords) - f64::from(local.intercept);
        Self { a: normal.x, b: normal.y, c }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slope_and_intercept_come_back() {
        for (slope, intercept) in [(0.41, 3.5), (0.41, -3.5), (-0.41, 3.5), (-2.0, -900.0)] {
            let line = Line::from_slope(slope, intercept).unwrap();
            assert!((line.slope().unwrap() - slope).abs() < 1e-12);
            assert!((line.intercept().unwrap() - intercept).abs() < 1e-9);
            assert!((line.angle_deg() - libm::atan(slope).to_degrees()).abs() < 1e-12);
            assert!(line.distance(Point2::new(1.0, slope + intercept + 1.0)) > 0.0);
        }
    }

    #[test]
    fn a_vertical_line_has_an_angle_and_no_slope() {
        for sign in [1.0, -1.0] {
            let line = Line::from_coefficients(2.0 * sign, 0.0, -8.0 * sign).unwrap();
            assert_eq!((line.slope(), line.intercept(), line.angle_deg()), (None, None, 90.0));
            assert!((line.distance(Point2::new(5.0, 3.0)) - sign).abs() < 1e-15);
        }
    }

    #[test]
    fn coefficients_of_any_size_make_the_same_line() {
        let point = Point2::new(5.0, 3.0);
        let plain = Line::from_coefficients(-0.41, 1.0, -3.5).unwrap();
        for exponent in [-1074 + 60, -600, -1, 1, 600, 1021] {
            let [a, b, c] = [-0.41, 1.0, -3.5].map(|it| libm::scalbn(it, exponent));
            let line = Line::from_coefficients(a, b, c).unwrap();
            let all = |line: &Line| {
                let [a, b, c] = line.coefficients();
                let (slope, intercept) = (line.slope().unwrap(), line.intercept().unwrap());
                [a, b, c, slope, intercept, line.distance(point)].map(f64::to_bits)
            };
            assert_eq!(all(&line), all(&plain), "2^{exponent}");
        }
        let diagonal = Line::from_coefficients(1e308, -1e308, 0.0).unwrap();
        assert!((diagonal.distance(point) - 2.0 / core::f64::consts::SQRT_2).abs() < 1e-15);
        let upright = Line::from_coefficients(f64::MAX, 0.0, -f64::MAX).unwrap();
        assert!((upright.distance(point) - 4.0).abs() < 1e-15);
        assert!(Line::from_slope(1e308, 3.5).unwrap().distance(point).is_finite());
        // Too far off to be told.
        assert!(Line::from_coefficients(1e-300, 0.0, 1e300).is_none());
    }

    #[test]
    fn what_is_no_line_is_refused() {
        assert!(Line::from_coefficients(0.0, 0.0, 1.0).is_none());
        assert!(Line::from_coefficients(f64::NAN, 1.0, 1.0).is_none());
        assert!(Line::from_slope(f64::INFINITY, 1.0).is_none());
        assert!(Line::from_slope(1.0, f64::INFINITY).is_none());
        assert!(Line::from_coefficients(1e-200, 1e-200, 0.0).is_some());
    }
}
