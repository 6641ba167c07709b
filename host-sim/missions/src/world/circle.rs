//! A circle as the boundary: the label is +1 inside.

use nalgebra::{Point2, Vector2};
use planner_core::Reading;

use crate::world::boundary::{BoundaryRecord, Curve, side};
use crate::world::way::Way;

/// A circle.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// Metres.
    pub middle: Point2<f64>,
    /// Metres.
    pub radius: f64,
}

impl Circle {
    /// How far inside a place is.
    fn depth(&self, at: Point2<f64>) -> f64 {
        let off = at - self.middle;
        self.radius - libm::hypot(off.x, off.y)
    }
}

impl Curve for Circle {
    fn side(&self, at: Point2<f64>) -> Reading {
        side(self.depth(at))
    }

    fn distance(&self, at: Point2<f64>) -> f64 {
        self.depth(at).abs()
    }

    fn ways(&self, _: [Point2<f64>; 2]) -> Vec<Way> {
        const CHORDS: u32 = 256;
        let at = |n: u32| {
            let (sin, cos) =
                libm::sincos(f64::from(n % CHORDS) / f64::from(CHORDS) * std::f64::consts::TAU);
            self.middle + Vector2::new(cos, sin) * self.radius
        };
        vec![(0..=CHORDS).map(at).collect()]
    }

    fn record(&self) -> BoundaryRecord {
        let circle = Some([self.middle.x, self.middle.y, self.radius]);
        BoundaryRecord { circle, ..BoundaryRecord::default() }
    }
}
