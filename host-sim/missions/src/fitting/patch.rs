//! Lines as points of a plane, and convex patches of them.
//!
//! Take a line that leans by an eighth turn at most, seen along an axis or against it, with its +1 side to the left.
//! Its equation is `left = slope ahead + offset`. In the plane of (slope, offset) a position is a straight line. It
//! separates the lines that pass below the position from those that pass above. So a patch bounded by positions is a
//! convex polygon. The measure of lines, d(angle) d(distance), has the density `(1 + slope^2)^(-3/2)` there.

use nalgebra::{Point2, Vector2, center};

use crate::fitting::line_set::ByNormal;
use crate::world::extent::span;
use crate::world::polygon::Polygon;

/// The direction along an axis that lines are nearest to: one of four.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quarter(pub u8);

impl Quarter {
    /// All four.
    pub const ALL: [Self; 4] = [Self(0), Self(1), Self(2), Self(3)];

    fn along(self) -> Vector2<f64> {
        match self.0 {
            0 => Vector2::new(1.0, 0.0),
            1 => Vector2::new(0.0, 1.0),
            2 => Vector2::new(-1.0, 0.0),
            _ => Vector2::new(0.0, -1.0),
        }
    }

    /// How far ahead and to the left a position is.
    pub fn seen(self, at: Point2<f64>) -> [f64; 2] {
        let along = self.along();
        [along.dot(&at.coords), along.perp(&at.coords)]
    }

    /// The unit normal of the line with this slope and offset, and its distance along it.
    pub fn normal(self, line: Point2<f64>) -> (Vector2<f64>, f64) {
        let (slope, offset) = (line.x, line.y);
        let along = self.along();
        let left = Vector2::new(-along.y, along.x);
        let length = libm::hypot(1.0, slope);
        ((left - along * slope) / length, offset / length)
    }

    /// The direction of lines of a slope, radians.
    pub fn direction(self, slope: f64) -> f64 {
        f64::from(self.0) * std::f64::consts::FRAC_PI_2 + libm::atan(slope)
    }
}

/// The integrals over some lines, by their measure.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mass {
    /// Of 1.
    pub measure: f64,
    /// Of the unit normal.
    pub normal: Vector2<f64>,
    /// Of the distance along it, metres.
    pub distance: f64,
}

impl Mass {
    /// The mean line, by its unit normal and the distance along it.
    pub fn line(&self) -> ByNormal {
        let length = self.normal.norm();
        (self.normal / length, self.distance / length)
    }

    /// Adds another, whose lines count with this weight.
    pub fn add(&mut self, other: &Self, weight: f64) {
        self.measure += weight * other.measure;
        self.normal += other.normal * weight;
        self.distance += weight * other.distance;
    }
}

/// A convex patch.
#[derive(Clone, Debug)]
pub struct Patch {
    /// The quarter of the directions that its lines are in.
    pub quarter: Quarter,
    /// Its lines: slopes as x, offsets as y.
    pub lines: Polygon,
}

impl Patch {
    /// The lines that have a position, as it is [seen](Quarter::seen), on their +1 side, and those that have it on
    /// the other.
    pub fn split(&self, [ahead, left]: [f64; 2]) -> [Option<Self>; 2] {
        [1.0, -1.0].map(|side| {
            let lines = self.lines.above(|line| side * (left - line.x * ahead - line.y));
            (lines.0.len() >= 3).then_some(Self { quarter: self.quarter, lines })
        })
    }

    /// The directions of the lines, from one to another, radians.
    pub fn directions(&self) -> [f64; 2] {
        span(self.lines.0.iter().map(|line| self.quarter.direction(line.x)))
    }

    /// A line inside.
    pub fn middle(&self) -> Point2<f64> {
        let corners = self.lines.0.iter();
        Point2::from(
            corners.map(|line| line.coords).sum::<Vector2<f64>>() / self.lines.0.len() as f64,
        )
    }

    /// The integrals, with a factor for each line: over triangles about the middle, exact for quadratic factors.
    pub fn mass(&self, factor: impl Fn(Point2<f64>) -> f64) -> Mass {
        let middle = self.middle();
        let mut mass = Mass::default();
        for (p, q) in self.lines.sides() {
            let third = (p - middle).perp(&(q - middle)).abs() / 6.0;
            for line in [center(&middle, &p), center(&p, &q), center(&q, &middle)] {
                let (normal, distance) = self.quarter.normal(line);
                let squared = 1.0 + line.x * line.x;
                let weight = factor(line) * third / (squared * squared.sqrt());
                mass.add(&Mass { measure: 1.0, normal, distance }, weight);
            }
        }
        mass
    }
}
