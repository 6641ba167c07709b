//! The map of a front by its pieces, and as a file of vertices.

use anyhow::Result;
use nalgebra::{Point2, Vector2};

use crate::mission::front::VertexRecord;
use crate::mission::map::pieces;
use crate::mission::results::Results;

/// The vertices of a map by its pieces, each vertex with the number of its step or row. A new piece begins where the
/// front was not known after a step or a row.
#[derive(Clone, Debug, Default)]
pub struct Pieces(pub(crate) Vec<Vec<(usize, VertexRecord)>>);

/// The columns of all map files, after the number of the step or row.
pub(crate) const TITLES: [&str; 7] =
    ["x", "z", "heading", "curvature", "half_width", "turn_deviation", "piece"];

/// Those of coordinates of the samples' file: of the globe, or of metres.
pub(crate) const OWN: [[&str; 2]; 2] = [["lat", "lon"], ["file_x", "file_z"]];

/// The title of the column that says whose a vertex is.
pub(crate) const ROBOT: &str = "robot";

/// More columns of a map file: their titles, and what a vertex has there.
pub type Own<'a> = ([&'static str; 2], &'a dyn Fn(&VertexRecord) -> [f64; 2]);

impl Pieces {
    /// Those of a mission.
    pub fn of(results: &Results) -> Self {
        Self(pieces(&results.mapped()))
    }

    /// The mean front, piece by piece.
    pub(crate) fn ways(&self) -> impl Iterator<Item = Vec<Point2<f64>>> {
        self.0.iter().map(|piece| piece.iter().map(|(_, it)| it.at()).collect())
    }

    /// The ground within the intervals of each piece: a polygon from each place to the next.
    pub(crate) fn ground(&self) -> impl Iterator<Item = impl Iterator<Item = [Point2<f64>; 4]>> {
        let between = |pair: &[(usize, VertexRecord)]| {
            let [from, to] = [0, pair.len() - 1].map(|k| ends(&pair[k].1));
            [from[0], to[0], to[1], from[1]]
        };
        self.0.iter().map(move |piece| piece.chunks(1).chain(piece.windows(2)).map(between))
    }

    /// Some of very many vertices, and the last of each piece.
    pub(crate) fn some(mut self) -> Self {
        const MOST: usize = 5_000;
        let each = self.0.iter().map(Vec::len).sum::<usize>().div_ceil(MOST).max(1);
        for piece in &mut self.0 {
            let last = piece.last().copied();
            *piece = piece.iter().step_by(each).copied().chain(last.filter(|_| each > 1)).collect();
        }
        self
    }

    /// All vertices, each with the number of its piece, from 1, and that of its step or row.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = (usize, usize, &VertexRecord)> {
        let numbered = (1..).zip(&self.0);
        numbered.flat_map(|(piece, them)| them.iter().map(move |(number, it)| (piece, *number, it)))
    }

    /// A map file: a row for each vertex, under a header. `number` is the title of the first column, and `own` are
    /// columns at the end. So is whose each vertex is, if several robots made the map.
    ///
    /// # Errors
    /// When a row could not be written.
    pub fn csv(&self, number: &str, own: Option<Own<'_>>, robots: &[usize]) -> Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let titles = own.iter().flat_map(|(titles, _)| titles);
        let titles = titles.chain((!robots.is_empty()).then_some(&ROBOT));
        writer.write_record([number].iter().chain(&TITLES).chain(titles))?;
        for (index, (piece, number, it)) in self.vertices().enumerate() {
            let &VertexRecord { x, z, heading, curvature, half_width, turn_deviation } = it;
            let row = (number, x, z, heading, curvature, half_width, turn_deviation, piece);
            let own: Vec<_> = own.iter().flat_map(|(_, at)| at(it)).collect();
            let robot: Vec<_> = robots.get(index).into_iter().collect();
            writer.serialize((row, own, robot))?;
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    }
}

/// The ends of a vertex's 90 % interval, to the left and to the right.
pub(crate) fn ends(vertex: &VertexRecord) -> [Point2<f64>; 2] {
    let (sin, cos) = libm::sincos(vertex.heading);
    let left = Vector2::new(-sin, cos) * vertex.half_width;
    [vertex.at() + left, vertex.at() - left]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::front::PassedRecord;
    use crate::mission::map::Mapped;

    fn vertex(x: f64) -> VertexRecord {
        let (curvature, turn_deviation) = (0.0, 0.25);
        VertexRecord { x, z: 2.0, heading: -0.5, curvature, half_width: 0.75, turn_deviation }
    }

    fn map(known: &str) -> Pieces {
        let step = |(k, it)| {
            let is_known = it == b'#';
            let here = |vertex| PassedRecord { passed: k + 1, begins: false, vertex };
            let vertices = is_known.then(|| here(vertex(k as f64))).into_iter().collect();
            Mapped { number: k + 1, metres: k as f64, is_known, vertices }
        };
        Pieces(pieces(&known.bytes().enumerate().map(step).collect::<Vec<_>>()))
    }

    #[test]
    fn a_piece_begins_where_the_front_was_lost() {
        for (known, lengths) in [
            ("", &[][..]),
            ("...", &[]),
            ("###", &[3]),
            (".##..#.", &[2, 1]),
            ("#.#.#", &[1, 1, 1]),
        ] {
            let lengths_found: Vec<_> = map(known).0.iter().map(Vec::len).collect();
            assert_eq!(lengths_found, lengths, "{known}");
        }
    }
}
