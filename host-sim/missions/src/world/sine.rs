//! A sine along a straight line as the boundary.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};
use planner_core::{Line, Reading};

use crate::world::boundary::{BoundaryRecord, Curve, side};
use crate::world::way::Way;

/// A sine: the label is +1 where the signed distance from the base line is more than
/// `height * sin(TAU * s / length + phase)`. Here `s` runs along the base line, from its point nearest to the origin, so
/// that the +1 side is on the left.
#[derive(Clone, Copy, Debug)]
pub struct Sine {
    /// The base line.
    pub base: Line,
    /// Metres.
    pub height: f64,
    /// Of a whole wave, metres.
    pub length: f64,
    /// Radians.
    pub phase: f64,
}

impl Sine {
    /// The height of the wave at `s`.
    fn wave(&self, s: f64) -> f64 {
        self.height * libm::sin(TAU * s / self.length + self.phase)
    }

    /// A place as `s`, and as its distance from the base line.
    fn along(&self, at: Point2<f64>) -> [f64; 2] {
        let [a, b, c] = self.base.coefficients();
        [b * at.x - a * at.y, a * at.x + b * at.y + c]
    }

    /// The inverse of [`along`](Self::along).
    fn place(&self, [s, off]: [f64; 2]) -> Point2<f64> {
        let [a, b, c] = self.base.coefficients();
        Point2::origin() + Vector2::new(b, -a) * s + Vector2::new(a, b) * (off - c)
    }
}

impl Curve for Sine {
    fn side(&self, at: Point2<f64>) -> Reading {
        let [s, off] = self.along(at);
        side(off - self.wave(s))
    }

    /// The nearest point is less than half a wave away along the base line: beyond, a nearer point has the same height.
    fn distance(&self, at: Point2<f64>) -> f64 {
        const PARTS: i32 = 512;
        const HALVINGS: u32 = 40;
        let [s, off] = self.along(at);
        let from = |t: f64| libm::hypot(t - s, self.wave(t) - off);
        let step = self.length / f64::from(PARTS);
        let place = |n: i32| s + f64::from(n) * step;
        // Each part that is no further than its neighbours is searched: there the distance has one least value.
        let least = |n: i32| {
            let (mut middle, mut width) = (place(n), step / 2.0);
            for _ in 0..HALVINGS {
                let [left, right] = [middle - width, middle + width];
                middle = [left, right]
                    .into_iter()
                    .fold(middle, |best, it| if from(it) < from(best) { it } else { best });
                width *= 0.7;
            }
            from(middle)
        };
        let ends = PARTS / 2;
        let reached: Vec<_> = (-ends - 1..=ends + 1).map(|n| from(place(n))).collect();
        let valleys =
            reached.windows(3).zip(-ends..).filter(|(of, _)| of[1] <= of[0] && of[1] <= of[2]);
        valleys.map(|(_, n)| least(n)).fold(f64::INFINITY, f64::min)
    }

    fn ways(&self, [min, max]: [Point2<f64>; 2]) -> Vec<Way> {
        const PARTS: f64 = 48.0;
        const MOST: f64 = 100_000.0;
        let corners = [min, Point2::new(max.x, min.y), max, Point2::new(min.x, max.y)];
        let [from, to] = crate::world::extent::span(corners.map(|at| self.along(at)[0]));
        let parts = ((to - from) / self.length * PARTS).ceil().clamp(1.0, MOST);
        let place = |n: u32| {
            let s = from + (to - from) * (f64::from(n) / parts);
            self.place([s, self.wave(s)])
        };
        vec![(0..=parts as u32).map(place).collect()]
    }

    fn record(&self) -> BoundaryRecord {
        BoundaryRecord {
            line: Some(self.base.coefficients()),
            sine: Some([self.height, self.length, self.phase]),
            ..BoundaryRecord::default()
        }
    }
}
