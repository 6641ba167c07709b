//! The map of a front in each form that it is written in, whether one robot made it or several.

use std::fmt::Write as _;

use anyhow::{Context as _, Result};
use geojson::{Feature, GeometryValue};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::float::simplify::SimplifyShape as _;
use serde::Serialize;
use serde_json::{Value, json};

use crate::mission::front::VertexRecord;
use crate::replay::MOST_NAMED;
use crate::report::on_map::feature;
use crate::report::picture::{Dot, Picture};
use crate::report::pieces::{OWN, Pieces};
use crate::world::frame::Frame;

/// A map of a front.
pub(crate) struct PlacedMap {
    pub(crate) frame: Frame,
    /// What numbers its vertices: `step` or `row`.
    pub(crate) numbers: &'static str,
    pub(crate) pieces: Pieces,
    /// Whose each vertex is, if several robots made the map.
    pub(crate) robots: Vec<usize>,
    /// Whether its first piece goes all round.
    pub(crate) is_round: bool,
}

/// A vertex.
#[derive(Serialize)]
pub(crate) struct PlaceRecord {
    number: usize,
    piece: usize,
    #[serde(flatten)]
    vertex: VertexRecord,
    /// In the coordinates of the file, if these are others.
    #[serde(skip_serializing_if = "Option::is_none")]
    in_file: Option<[f64; 2]>,
    /// Whose it is, if several robots made the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    robot: Option<usize>,
}

impl PlacedMap {
    /// The vertices as records.
    pub(crate) fn vertices(&self) -> Vec<PlaceRecord> {
        let record = |(index, (piece, number, vertex)): (usize, (_, _, &VertexRecord))| {
            let (in_file, robot) =
                (self.frame.in_file(vertex.at()), self.robots.get(index).copied());
            PlaceRecord { number, piece, vertex: *vertex, in_file, robot }
        };
        self.pieces.vertices().enumerate().map(record).collect()
    }

    /// The map as a file of vertices. If positions have an origin, each vertex has its coordinates in the file as well.
    pub(crate) fn csv(&self) -> Result<String> {
        let titles = OWN[usize::from(!self.frame.is_geographic())];
        let recorded = |it: &VertexRecord| self.frame.recorded(it.at());
        let own = self.frame.origin.map(|_| (titles, &recorded as _));
        self.pieces.csv(self.numbers, own, &self.robots)
    }

    /// The pieces in words, a line each, the first ones if there are many. `which` are the first.
    pub(crate) fn in_words(&self, which: &str, unit: &str) -> String {
        let (mut text, pieces) = (String::new(), &self.pieces.0);
        let count = pieces.len();
        // Writing to a string cannot fail.
        if count > 1 {
            let more = format!(", the {which} of which are");
            let more = if count > MOST_NAMED { &more } else { "" };
            let _ = writeln!(text, "It has {count} pieces{more}:");
        }
        let mut index = 0;
        for piece in pieces.iter().take(MOST_NAMED) {
            let [from, to] = [0, piece.len() - 1].map(|k| {
                let robot = self.robots.get(index + k);
                let robot = robot.map_or(String::new(), |it| format!(" of robot {it}"));
                let (number, VertexRecord { x, z, .. }) = piece[k];
                (number, format!("({x:.2}, {z:.2}){robot}"))
            });
            index += piece.len();
            let rows = format!("{unit}s {} to {}: ", from.0, to.0);
            let rows = if self.robots.is_empty() { &rows } else { "" };
            if count > 1 || rows.is_empty() {
                let _ = writeln!(text, "  {rows}from {} to {}", from.1, to.1);
            }
        }
        text
    }

    /// The map as it is drawn: one that goes all round ends where it begins.
    fn drawn(&self) -> Pieces {
        let mut pieces = self.pieces.clone();
        let begin = pieces.0.first().and_then(|piece| piece.first()).copied();
        pieces.0.iter_mut().take(usize::from(self.is_round)).for_each(|it| it.extend(begin));
        pieces
    }

    /// The map drawn, among some samples.
    pub(crate) fn picture(&self, title: &str, note: String, samples: Vec<Dot>) -> Result<Picture> {
        let picture = Picture::of_front(title, note, samples, self.drawn());
        picture.context("no area around the map")
    }

    /// The map by its pieces: the ground where the front lies with a probability of 0.9, the mean front, and each
    /// vertex. A vertex has the time of its number, if that is known.
    ///
    /// # Errors
    /// Metres have no place on a map by themselves.
    pub(crate) fn features(&self, time: impl Fn(usize) -> Option<Value>) -> Result<Vec<Feature>> {
        let (mut features, drawn) = (Vec::new(), self.drawn());
        for (piece, ground) in (1..).zip(drawn.ground()) {
            let quads: Vec<_> = ground.map(|it| it.map(<[f64; 2]>::from).to_vec()).collect();
            let band = quads.simplify_shape(FillRule::NonZero);
            let band = band.iter().map(|it| it.iter().map(|it| self.frame.ring(it)).collect());
            let band = band.collect::<Result<Vec<Vec<_>>>>()?;
            if !band.is_empty() {
                let told = json!({ "kind": "band", "piece": piece, "probability": 0.9 });
                features.push(feature(GeometryValue::new_multi_polygon(band), told));
            }
        }
        for (piece, way) in (1..).zip(drawn.ways()) {
            let way =
                way.into_iter().map(|at| self.frame.degrees(at)).collect::<Result<Vec<_>>>()?;
            if way.len() > 1 {
                let told = json!({ "kind": "front", "piece": piece });
                features.push(feature(GeometryValue::new_line_string(way), told));
            }
        }
        for PlaceRecord { number, piece, vertex, robot, .. } in self.vertices() {
            let mut told = json!(vertex);
            for at in ["x", "z"] {
                told.as_object_mut().and_then(|it| it.remove(at));
            }
            told["kind"] = "vertex".into();
            told["piece"] = piece.into();
            told[self.numbers] = number.into();
            for (name, value) in [("robot", robot.map(Into::into)), ("time", time(number))] {
                if let Some(value) = value {
                    told[name] = value;
                }
            }
            let at = GeometryValue::new_point(self.frame.degrees(vertex.at())?);
            features.push(feature(at, told));
        }
        Ok(features)
    }
}
