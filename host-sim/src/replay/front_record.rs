//! The front along a recorded track, as a record.

use planner_core::Label;
use serde::Serialize;

use crate::mission::front::{FrontTable, VertexRecord};
use crate::mission::map::MapRecord;
use crate::mission::results::PTold;
use crate::replay::front_map::FrontMap;
use crate::replay::record::SkippedRecord;

/// The front along a track.
#[derive(Serialize)]
pub struct FrontRecord {
    samples: usize,
    skipped: SkippedRecord,
    front: FrontTable,
    p: PTold,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    /// The front counts as found where its half-width is below this, metres.
    found_within: f64,
    /// What its numbers are: `row` (the line of the file, or its feature) or `step`.
    numbers: &'static str,
    map: MapRecord,
    /// The label of all ground, where no front was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    one_label: Option<i8>,
    /// After which the front was sought anew.
    alarms: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    crs: Option<String>,
    vertices: Vec<MappedRecord>,
}

/// A vertex.
#[derive(Serialize)]
pub(crate) struct MappedRecord {
    pub(crate) number: usize,
    pub(crate) piece: usize,
    #[serde(flatten)]
    pub(crate) vertex: VertexRecord,
    /// In the coordinates of the file, if these are others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) in_file: Option<[f64; 2]>,
    /// Whose it is, if several robots made the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) robot: Option<usize>,
}

impl FrontMap {
    /// What the track maps, as a record.
    pub fn record(&self) -> FrontRecord {
        let frame = &self.file.frame;
        let mapped = |(piece, number, vertex): (usize, usize, &VertexRecord)| MappedRecord {
            number,
            piece,
            vertex: *vertex,
            in_file: frame.origin().map(|_| frame.recorded(vertex.at())),
            robot: None,
        };
        FrontRecord {
            samples: self.file.samples.len(),
            skipped: (&self.file.skipped).into(),
            front: self.front.into(),
            p: self.p,
            tolerance: (self.tolerance > 0.0).then_some(self.tolerance),
            found_within: self.width,
            numbers: self.number(),
            map: self.map,
            one_label: self.one_label.map(Label::sign),
            alarms: self.alarms.clone(),
            origin: frame.origin(),
            crs: frame.crs().map(ToString::to_string),
            vertices: self.pieces.vertices().map(mapped).collect(),
        }
    }
}
