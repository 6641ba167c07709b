//! The map of a front along a recorded track.
//!
//! A follower takes in row after row, as in a mission in which another drives. The places that it has passed come on the
//! map.

use std::path::Path;

use anyhow::Result;
use planner_core::{Front, Label, Sample};

use crate::mission::front::{PassedRecord, VertexRecord};
use crate::mission::map::{MapRecord, Mapped, State, pieces};
use crate::mission::read_out::rest;
use crate::mission::results::PTold;
use crate::output::notes::progress;
use crate::replay::answer::Trust;
use crate::replay::rows::Layout;
use crate::replay::sample_file::SampleFile;
use crate::replay::track::RecordedTrack;
use crate::report::pieces::Pieces;

/// Rows that are taken in between two looks at the progress.
const ROWS: usize = 1_000;

/// Samples from a file, and the front that they map.
pub struct FrontMap {
    pub(crate) file: SampleFile,
    /// What is told of the front.
    pub(crate) front: Front,
    pub(crate) p: PTold,
    /// Metres.
    pub(crate) tolerance: f64,
    /// The front counts as found where its half-width is below this, metres.
    pub(crate) width: f64,
    pub(crate) pieces: Pieces,
    /// What it came to. Its numbers are those of rows.
    pub(crate) map: MapRecord,
    /// Rows after which the front was sought anew.
    pub(crate) alarms: Vec<usize>,
    /// The label of all ground, where no front was found and most likely none is there.
    pub(crate) one_label: Option<Label>,
}

impl FrontMap {
    /// Reads a file of any length and maps the front along it, as far as its samples are trusted.
    ///
    /// # Errors
    /// Names the file and the line, what was found and what was expected.
    pub fn read(path: &Path, layout: &Layout, front: Front, trust: Trust) -> Result<Self> {
        Self::of(SampleFile::read(path, layout)?, front, trust)
    }

    fn of(file: SampleFile, front: Front, trust: Trust) -> Result<Self> {
        let RecordedTrack { rows, mut known, width, p, is_closed } =
            RecordedTrack::of(&file, front, trust)?;
        let bar = progress(rows.len() as u64, "rows")?;
        let (mut alarms, mut after) = (Vec::new(), Vec::with_capacity(rows.len()));
        for (k, row) in rows.iter().enumerate() {
            if known.take(row)? {
                alarms.push(row.number);
            }
            let (number, metres) = (row.number, row.driven);
            let passed = |it| PassedRecord::of(it, number);
            let vertices = known.curve().mapped().iter().copied().map(passed).collect();
            let is_known = known.is_found();
            after.push(Mapped { number, metres, is_known, vertices });
            if k % ROWS == 0 {
                bar.set_position(k as u64);
            }
        }
        bar.finish_and_clear();
        if let Some(last) = after.last_mut() {
            let passed = |it| PassedRecord::of(it, last.number);
            last.vertices.extend(rest(known.curve()).into_iter().map(passed));
        }
        let pieces = Pieces::from(pieces(&after));
        let map = MapRecord::after(&after, is_closed);
        let one_label = known.one_label().map(|it| it.label).or_else(|| one_label(&file.samples));
        let one_label = one_label.filter(|_| map.state == State::Sought);
        Ok(Self {
            file,
            front,
            p,
            tolerance: trust.tolerance,
            width: width.into(),
            pieces,
            map,
            alarms,
            one_label,
        })
    }

    /// The number of a row is that of a step.
    pub(crate) fn is_of_trace(&self) -> bool {
        self.file.mission.is_some()
    }

    /// What numbers the rows of the track, in the titles of columns and records.
    pub(crate) fn number(&self) -> &'static str {
        if self.is_of_trace() { "step" } else { "row" }
    }

    /// The map as a file of vertices. If positions have an origin, each vertex has its coordinates in the file as well.
    ///
    /// # Errors
    /// When a row could not be written.
    pub fn csv(&self) -> Result<String> {
        let frame = &self.file.frame;
        let titles = if frame.is_geographic() { ["lat", "lon"] } else { ["file_x", "file_z"] };
        let recorded = |it: &VertexRecord| frame.recorded(it.at());
        self.pieces.csv(self.number(), frame.origin().map(|_| (titles, &recorded as _)))
    }

    /// What the file is called.
    pub fn name(&self) -> &str {
        &self.file.name
    }
}

/// The label of all samples, if they have one.
fn one_label(samples: &[Sample]) -> Option<Label> {
    let first = samples.first()?.label;
    samples.iter().all(|it| it.label == first).then_some(first)
}
