//! The distance between samples of different labels: the nearest points of their convex hulls.
//!
//! For two disjoint convex polygons, some nearest pair is a corner of one and a point on a side of the other. Any two
//! samples of a label span a segment inside its hull. So the distance of the hulls is the least distance from a sample
//! to a segment of the other label. It never grows with another sample, not even by rounding, as every distance
//! computed before remains in the minimum.

use nalgebra::Point2;
use planner_core::Sample;

/// The square of the least distance of samples of different labels, metres^2.
#[derive(Clone, Copy, Debug)]
pub struct Gap(f64);

impl Gap {
    /// Samples of one label only.
    pub const OPEN: Self = Self(f64::INFINITY);

    /// The gap after another sample.
    #[must_use]
    pub fn with(self, earlier: &[Sample], sample: Sample) -> Self {
        let of = |own: bool| {
            earlier
                .iter()
                .filter(move |it| (it.label == sample.label) == own)
                .map(|it| it.site.into())
        };
        let new = Point2::from(sample.site);
        let mut least = self.0;
        for (k, other) in of(false).enumerate() {
            for another in of(false).skip(k) {
                least = least.min(squared_distance(new, other, another));
            }
            for own in of(true) {
                least = least.min(squared_distance(other, new, own));
            }
        }
        Self(least)
    }

    /// The square of half the gap, metres^2. Half the gap is the greatest distance that a dividing line keeps from its
    /// samples.
    pub fn margin_squared(self) -> f64 {
        self.0 / 4.0
    }
}

/// The square of a point's distance from a segment.
fn squared_distance(point: Point2<f64>, from: Point2<f64>, to: Point2<f64>) -> f64 {
    let (way, off) = (to - from, point - from);
    let length_squared = way.norm_squared();
    let share =
        if length_squared > 0.0 { (way.dot(&off) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    (off - way * share).norm_squared()
}
