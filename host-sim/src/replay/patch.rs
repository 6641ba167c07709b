//! Lines as points of a plane, and convex patches of them.
//!
//! Take a line that leans by an eighth turn at most, seen along an axis or against it, with its +1 side to the left.
//! Its equation is `left = slope ahead + offset`. In the plane of (slope, offset) a position is a straight line. It
//! separates the lines that pass below the position from those that pass above. So a patch bounded by positions is a
//! convex polygon. The measure of lines, d(angle) d(distance), has the density `(1 + slope^2)^(-3/2)` there.

use nalgebra::{Point2, Vector2};

/// The direction along an axis that lines are nearest to: one of four.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Quarter(pub(crate) u8);

impl Quarter {
    pub(crate) const ALL: [Self; 4] = [Self(0), Self(1), Self(2), Self(3)];

    fn along(self) -> Vector2<f64> {
        match self.0 {
            0 => Vector2::new(1.0, 0.0),
            1 => Vector2::new(0.0, 1.0),
            2 => Vector2::new(-1.0, 0.0),
            _ => Vector2::new(0.0, -1.0),
        }
    }

    /// How far ahead and to the left a position is.
    pub(crate) fn seen(self, at: Point2<f64>) -> [f64; 2] {
        let along = self.along();
        [along.dot(&at.coords), along.perp(&at.coords)]
    }

    /// A line's unit normal and its distance along it.
    pub(crate) fn normal(self, [slope, offset]: [f64; 2]) -> (Vector2<f64>, f64) {
        let along = self.along();
        let left = Vector2::new(-along.y, along.x);
        let length = libm::hypot(1.0, slope);
        ((left - along * slope) / length, offset / length)
    }

    /// The direction of lines of a slope, radians.
    pub(crate) fn direction(self, slope: f64) -> f64 {
        f64::from(self.0) * std::f64::consts::FRAC_PI_2 + libm::atan(slope)
    }
}

/// The integrals over some lines, by their measure.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mass {
    /// Of 1.
    pub(crate) measure: f64,
    /// Of the unit normal.
    pub(crate) normal: Vector2<f64>,
    /// Of the distance along it, metres.
    pub(crate) distance: f64,
}

impl Mass {
    /// Adds another, whose lines count with this weight.
    pub(crate) fn add(&mut self, other: &Self, weight: f64) {
        self.measure += weight * other.measure;
        self.normal += other.normal * weight;
        self.distance += weight * other.distance;
    }
}

/// A convex patch.
#[derive(Clone, Debug)]
pub(crate) struct Patch {
    pub(crate) quarter: Quarter,
    /// Slopes and offsets, in order around it.
    pub(crate) corners: Vec<[f64; 2]>,
}

impl Patch {
    /// The lines that have a position, as it is [seen](Quarter::seen), on their +1 side, and those that have it on
    /// the other.
    pub(crate) fn split(&self, [ahead, left]: [f64; 2]) -> [Option<Self>; 2] {
        let height = |[slope, offset]: [f64; 2]| left - slope * ahead - offset;
        let mut parts = [Vec::new(), Vec::new()];
        for (p, q) in self.corners.iter().zip(self.corners.iter().cycle().skip(1)) {
            let (d, e) = (height(*p), height(*q));
            for (part, side) in parts.iter_mut().zip([1.0, -1.0]) {
                if side * d >= 0.0 {
                    part.push(*p);
                }
                if (d > 0.0 && e < 0.0) || (d < 0.0 && e > 0.0) {
                    let share = d / (d - e);
                    part.push([0, 1].map(|k| p[k] + (q[k] - p[k]) * share));
                }
            }
        }
        parts.map(|corners| (corners.len() >= 3).then_some(Self { quarter: self.quarter, corners }))
    }

    /// The directions of the lines, from one to another, radians.
    pub(crate) fn directions(&self) -> [f64; 2] {
        let directions = self.corners.iter().map(|corner| self.quarter.direction(corner[0]));
        directions
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], it| [from.min(it), to.max(it)])
    }

    /// A line inside.
    pub(crate) fn middle(&self) -> [f64; 2] {
        let count = self.corners.len() as f64;
        [0, 1].map(|k| self.corners.iter().map(|corner| corner[k]).sum::<f64>() / count)
    }

    /// The integrals, with a factor for each line: over triangles about the middle, exact for quadratic factors.
    pub(crate) fn mass(&self, factor: impl Fn([f64; 2]) -> f64) -> Mass {
        let middle = self.middle();
        let mut mass = Mass::default();
        for (p, q) in self.corners.iter().zip(self.corners.iter().cycle().skip(1)) {
            let [a, b] = [p, q].map(|it| Vector2::new(it[0] - middle[0], it[1] - middle[1]));
            let third = a.perp(&b).abs() / 6.0;
            let between = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|k| a[k].midpoint(b[k]));
            for at in [between(middle, *p), between(*p, *q), between(*q, middle)] {
                let (normal, distance) = self.quarter.normal(at);
                let squared = 1.0 + at[0] * at[0];
                let weight = factor(at) * third / (squared * squared.sqrt());
                mass.add(&Mass { measure: 1.0, normal, distance }, weight);
            }
        }
        mass
    }
}
