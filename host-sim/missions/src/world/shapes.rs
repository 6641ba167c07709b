//! Polygons as the boundary, drawn or of a map: the label is +1 inside.

use nalgebra::Point2;
use planner_core::{Label, Reading};

use crate::world::boundary::{BoundaryRecord, Curve};
use crate::world::way::{self, Way};

/// Polygons with holes.
#[derive(Clone, Debug)]
pub struct Shapes {
    /// The file, if they are from one.
    name: Option<String>,
    /// All rings, each with its first corner again at its end.
    rings: Vec<Way>,
}

impl Shapes {
    /// A polygon by its corners.
    pub fn drawn(corners: Way) -> Self {
        Self { name: None, ..Self::new(String::new(), vec![corners]) }
    }

    /// The polygons of the file called `name`: rings around them and around their holes.
    pub fn new(name: String, rings: Vec<Way>) -> Self {
        let closed = |ring: Way| ring.iter().chain(ring.first()).copied().collect();
        Self { name: Some(name), rings: rings.into_iter().map(closed).collect() }
    }
}

impl Curve for Shapes {
    /// Inside is what has an odd number of sides to its left.
    fn side(&self, at: Point2<f64>) -> Reading {
        if self.distance(at) == 0.0 {
            return Reading::Boundary;
        }
        let sides = self.rings.iter().flat_map(|ring| ring.windows(2));
        let is_left = |side: &&[Point2<f64>]| {
            let [p, q] = [side[0], side[1]];
            let crosses = (p.y <= at.y) != (q.y <= at.y);
            crosses && p.x + (at.y - p.y) / (q.y - p.y) * (q.x - p.x) < at.x
        };
        let is_inside = sides.filter(is_left).count() % 2 == 1;
        if is_inside { Label::Positive.into() } else { Label::Negative.into() }
    }

    fn distance(&self, at: Point2<f64>) -> f64 {
        way::distance(at, &self.rings)
    }

    fn ways(&self, _: [Point2<f64>; 2]) -> Vec<Way> {
        self.rings.clone()
    }

    fn record(&self) -> BoundaryRecord {
        let corners = |ring: &Way| ring[..ring.len() - 1].iter().map(|at| (*at).into()).collect();
        let polygon = self.rings.first().filter(|_| self.name.is_none()).map(corners);
        BoundaryRecord { polygon, geojson: self.name.clone(), ..BoundaryRecord::default() }
    }
}
