//! A polyline over x as the boundary: the label is +1 above. Its first and its last piece go on straight.

use nalgebra::Point2;
use planner_core::Reading;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::world::boundary::{BoundaryRecord, CoastRecord, Curve, side};
use crate::world::coast::coast;
use crate::world::way::{self, Way};

/// How far its ends go on, metres: beyond every place of the lattice and its reach.
const FAR: f64 = 1e6;

/// A polyline.
#[derive(Clone, Debug)]
pub struct Polyline {
    points: Way,
    /// The same with ends that go on.
    whole: Way,
    /// The coast that was drawn, if it is one.
    coast: Option<CoastRecord>,
}

impl Polyline {
    /// A polyline through some points; `None` unless there are two at least, and each is further right than the last.
    pub fn through(points: Way) -> Option<Self> {
        let (&[first, second, ..], &[.., before, last]) = (&points[..], &points[..]) else {
            return None;
        };
        if points.windows(2).any(|piece| piece[1].x <= piece[0].x) {
            return None;
        }
        // Ends of one length, however steep they are.
        let beyond = |end: Point2<f64>, inner: Point2<f64>| {
            let way = end - inner;
            end + way * (FAR / libm::hypot(way.x, way.y))
        };
        let middle = points.iter().copied();
        let ends = [beyond(first, second), beyond(last, before)];
        let whole = [ends[0]].into_iter().chain(middle).chain([ends[1]]).collect();
        Some(Self { points, whole, coast: None })
    }
}

impl Polyline {
    /// A random coast, whose heights have a deviation of `height` about `z = middle.y` and are alike over `length`. Its
    /// drawn part goes `half` to either side of the middle; beyond that it goes on straight.
    pub fn coast(record: CoastRecord, middle: Point2<f64>, half: f64) -> Option<Self> {
        let CoastRecord { height, length, seed } = record;
        let way = coast(&mut ChaCha8Rng::seed_from_u64(seed), [height, length], half);
        let whole = Self::through(way.iter().map(|at| at + middle.coords).collect())?;
        Some(Self { coast: Some(record), ..whole })
    }
}

impl Curve for Polyline {
    fn side(&self, at: Point2<f64>) -> Reading {
        let pieces = self.points.len() - 1;
        let piece = self.points.partition_point(|it| it.x <= at.x).clamp(1, pieces) - 1;
        let (from, to) = (self.points[piece], self.points[piece + 1]);
        // The place is to the left of a piece that goes to the right.
        side((to - from).perp(&(at - from)))
    }

    fn distance(&self, at: Point2<f64>) -> f64 {
        way::distance(at, std::slice::from_ref(&self.whole))
    }

    fn ways(&self, _: [Point2<f64>; 2]) -> Vec<Way> {
        vec![self.whole.clone()]
    }

    fn record(&self) -> BoundaryRecord {
        let points = || self.points.iter().map(|at| (*at).into()).collect();
        let polyline = self.coast.is_none().then(points);
        BoundaryRecord { polyline, coast: self.coast, ..BoundaryRecord::default() }
    }
}
