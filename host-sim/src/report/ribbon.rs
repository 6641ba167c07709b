//! The map of a front as a ribbon: the places on it, and how far to either side it may lie.

use nalgebra::{Point2, Vector2};

use crate::mission::front::VertexRecord;
use crate::mission::results::Results;
use crate::report::pieces::Pieces;

/// A place of the map: where it is, and the two ends of its 90 % interval, to the left and to the right.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rung {
    /// On the mean front.
    pub(crate) at: Point2<f64>,
    /// The ends.
    pub(crate) ends: [Point2<f64>; 2],
}

impl From<&VertexRecord> for Rung {
    fn from(vertex: &VertexRecord) -> Self {
        let (sin, cos) = libm::sincos(vertex.heading);
        let left = Vector2::new(-sin, cos) * vertex.half_width;
        Self { at: vertex.at(), ends: [vertex.at() + left, vertex.at() - left] }
    }
}

/// The map by its pieces. A new one begins where the front was not known after a step.
#[derive(Clone, Debug, Default)]
pub struct Ribbon(pub(crate) Vec<Vec<Rung>>);

impl Ribbon {
    /// That of a mission.
    pub(crate) fn of(results: &Results) -> Self {
        Self::from(&Pieces::of(results))
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The mean front, piece by piece.
    pub(crate) fn ways(&self) -> impl Iterator<Item = Vec<Point2<f64>>> {
        self.0.iter().map(|piece| piece.iter().map(|it| it.at).collect())
    }

    /// The ground within the intervals: a polygon from each place to the next.
    pub(crate) fn ground(&self) -> impl Iterator<Item = [Point2<f64>; 4]> {
        let between = |pair: &[Rung]| {
            let [from, to] = [pair[0].ends, pair[pair.len() - 1].ends];
            [from[0], to[0], to[1], from[1]]
        };
        self.0.iter().flat_map(move |piece| piece.chunks(1).chain(piece.windows(2)).map(between))
    }
}

impl From<&Pieces> for Ribbon {
    fn from(pieces: &Pieces) -> Self {
        let rungs =
            |piece: &[(usize, VertexRecord)]| piece.iter().map(|(_, it)| it.into()).collect();
        Self(pieces.iter().map(rungs).collect())
    }
}
