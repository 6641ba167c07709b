//! The front along a recorded track: drawn, and for a map (`GeoJSON`).

use anyhow::{Context as _, Result};
use geojson::{Feature, GeometryValue};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::float::simplify::SimplifyShape as _;
use nalgebra::Point2;
use serde_json::{Value, json};

use crate::mission::front::VertexRecord;
use crate::mission::map::State;
use crate::replay::frame::Frame;
use crate::replay::front_map::FrontMap;
use crate::replay::geojson::{collection, feature};
use crate::report::look;
use crate::report::picture::{Dot, Picture};
use crate::report::pieces::{Pieces, ends};

/// Samples that a figure shows at most, so that they do not hide the front.
const MOST: usize = 150;

impl FrontMap {
    /// The samples and the front that they map, as an SVG document. Of very many samples and vertices it shows some.
    ///
    /// # Errors
    /// When it could not be drawn.
    pub fn figure(&self) -> Result<String> {
        let samples = &self.file.samples;
        let count = samples.len();
        let every = count.div_ceil(MOST).max(1);
        let sparse =
            if every > 1 { format!("; one label in {every} shown") } else { String::new() };
        let metres = self.map.metres;
        let what = match self.map.state {
            _ if self.one_label.is_some() => "No front: the ground has one label".to_owned(),
            State::Sought => "A front that was not found".to_owned(),
            State::Lost => format!("A front that is lost: {metres:.0} m mapped"),
            State::Closed => format!("A closed front: {metres:.0} m mapped"),
            State::Followed => format!("A front: {metres:.0} m mapped"),
        };
        let note = format!("{what} along a track of {count} labels{sparse}");
        let dots = samples.iter().map(|s| Dot::new(s.site, look::small(s.label))).collect();
        let picture = Picture::of_front(&self.file.name, note, dots, self.pieces.clone());
        let mut picture = picture.context("no area around the samples")?;
        picture.samples = picture.samples.into_iter().step_by(every).collect();
        Ok(picture.svg())
    }

    /// The front by its pieces: the ground where it lies with a probability of 0.9, the mean front, and each vertex.
    /// Also all samples.
    ///
    /// # Errors
    /// For a file whose positions are in metres, as these have no place on a map by themselves. Also for positions on
    /// both sides of the 180th meridian.
    pub fn geojson(&self) -> Result<String> {
        let file = &self.file;
        file.area_on_globe()?;
        let number = |_, number: usize, told: &mut Value| {
            told[self.number()] = number.into();
            if let Some(time) = file.time(number) {
                told["time"] = time;
            }
        };
        let mut features = features(&self.pieces, &self.pieces, &file.frame, &number)?;
        for (index, sample) in file.samples.iter().enumerate() {
            features.push(file.point(index, sample, None)?);
        }
        Ok(collection(features))
    }
}

/// A front by its pieces: bands and lines as they are drawn, and vertices. `number` adds what numbers a vertex, by its index and its number.
///
/// # Errors
/// Metres have no place on a map by themselves.
pub(crate) fn features(
    pieces: &Pieces,
    drawn: &Pieces,
    frame: &Frame,
    number: &dyn Fn(usize, usize, &mut Value),
) -> Result<Vec<Feature>> {
    let mut features = Vec::new();
    for (piece, vertices) in (1..).zip(&drawn.0) {
        let on_globe = |ring: &Vec<[f64; 2]>| {
            let closed = ring.iter().chain(ring.first());
            closed.map(|at| frame.degrees((*at).into())).collect::<Result<Vec<_>>>()
        };
        let band = band(vertices).into_iter();
        let band = band.map(|polygon| polygon.iter().map(on_globe).collect::<Result<Vec<_>>>());
        let band = band.collect::<Result<Vec<_>>>()?;
        if !band.is_empty() {
            features.push(feature(
                GeometryValue::new_multi_polygon(band),
                json!({ "kind": "band", "piece": piece, "probability": 0.9 }),
            ));
        }
    }
    for (piece, way) in (1..).zip(drawn.ways()) {
        let way = way.into_iter().map(|at| frame.degrees(at)).collect::<Result<Vec<_>>>()?;
        if way.len() > 1 {
            features.push(feature(
                GeometryValue::new_line_string(way),
                json!({ "kind": "front", "piece": piece }),
            ));
        }
    }
    for (index, (piece, of, it)) in pieces.vertices().enumerate() {
        let mut told = json!({
            "kind": "vertex",
            "piece": piece,
            "heading": it.heading,
            "curvature": it.curvature,
            "half_width": it.half_width,
            "turn_deviation": it.turn_deviation,
        });
        number(index, of, &mut told);
        features.push(feature(GeometryValue::new_point(frame.degrees(it.at())?), told));
    }
    Ok(features)
}

/// The ground within the intervals of a piece: polygons that do not overlap, each by its rings, the outer one first and
/// counter-clockwise.
fn band(piece: &[(usize, VertexRecord)]) -> Vec<Vec<Vec<[f64; 2]>>> {
    let quads = piece.windows(2).map(|pair| ring([ends(&pair[0].1), ends(&pair[1].1)]));
    let quads: Vec<Vec<[f64; 2]>> = quads.map(|it| it.map(Into::into).to_vec()).collect();
    quads.simplify_shape(FillRule::NonZero)
}

/// The four ends of two intervals as a ring, counter-clockwise. Of the three orders the one with the most area does not
/// cross itself.
fn ring([[a, b], [c, d]]: [[Point2<f64>; 2]; 2]) -> [Point2<f64>; 4] {
    let area = |[p, q, r, s]: &[Point2<f64>; 4]| (r - p).perp(&(s - q));
    let orders = [[a, b, d, c], [a, b, c, d], [a, c, b, d]];
    let [p, q, r, s] = orders
        .into_iter()
        .max_by(|one, other| area(one).abs().total_cmp(&area(other).abs()))
        .unwrap_or([a, b, d, c]);
    if area(&[p, q, r, s]) < 0.0 { [s, r, q, p] } else { [p, q, r, s] }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Whether two stretches cross each other.
    fn cross([a, b]: [Point2<f64>; 2], [c, d]: [Point2<f64>; 2]) -> bool {
        let side = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| (q - p).perp(&(r - p));
        side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
    }

    #[test]
    fn a_ring_of_four_places_does_not_cross_itself() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for trial in 0..10_000 {
            let mut end = || Point2::from(rng.random::<[f64; 2]>());
            let ends = [[end(), end()], [end(), end()]];
            let [p, q, r, s] = ring(ends);
            let crosses = cross([p, q], [r, s]) || cross([q, r], [s, p]);
            assert!(!crosses, "trial {trial} of seed 5: {ends:?}");
            assert!((r - p).perp(&(s - q)) >= 0.0, "trial {trial} of seed 5: clockwise");
        }
    }
}
