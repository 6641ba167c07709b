//! The map of a front along a recorded track.
//!
//! A tracker takes in row after row: that time has passed, and the label. After each of them at which the front is found
//! the map has a vertex. Of rows close together it takes in some. Where the labels raise an alarm, the front is sought
//! anew nearby, as a follower does.

use std::path::Path;

use anyhow::Result;
use planner_core::{Front, Label};

use crate::mission::front::{PassedRecord, VertexRecord};
use crate::mission::map::{MapRecord, Mapped, State, pieces};
use crate::mission::results::PTold;
use crate::output::notes::progress;
use crate::replay::answer::Trust;
use crate::replay::rows::Layout;
use crate::replay::sample_file::SampleFile;
use crate::replay::track::{RecordedTrack, Row};
use crate::report::pieces::Pieces;

/// There is no front if that has a higher probability.
const ABSENT: f32 = 0.5;

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
    /// Rows that were taken in, and how far apart they are at least, metres.
    pub(crate) taken: usize,
    pub(crate) apart: f64,
    pub(crate) pieces: Pieces,
    /// What it came to. Its numbers are those of rows.
    pub(crate) map: MapRecord,
    /// Rows after which the front was sought anew.
    pub(crate) alarms: Vec<usize>,
    /// Where no front was found and the labels say that there is none: the label of all ground, and the probability.
    pub(crate) one_label: Option<(Label, f64)>,
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
        let RecordedTrack { rows, apart, mut known, width, near, area, p, is_closed } =
            RecordedTrack::of(&file, front, trust)?;
        let bar = progress(rows.len() as u64, "rows")?;
        let (mut alarms, mut after) = (Vec::new(), Vec::with_capacity(rows.len()));
        for (k, row) in rows.iter().enumerate() {
            if known.take(row, near, area)? {
                alarms.push(row.number);
            }
            let (number, metres) = (row.number, row.driven);
            let passed = |it| PassedRecord::of(it, number);
            let vertices = known.mapped(width).into_iter().map(passed).collect();
            let is_known = known.found(width).is_some();
            after.push(Mapped { number, metres, is_known, vertices });
            if k % ROWS == 0 {
                bar.set_position(k as u64);
            }
        }
        bar.finish_and_clear();
        if let Some(last) = after.last_mut() {
            let passed = |it| PassedRecord::of(it, last.number);
            last.vertices.extend(known.rest().into_iter().map(passed));
        }
        let pieces = Pieces::from(pieces(&after));
        let map = MapRecord::after(&after, is_closed);
        let absent = known.share_nowhere();
        let one_label = one_label(&rows, absent).filter(|_| map.state == State::Sought);
        Ok(Self {
            file,
            front,
            p,
            tolerance: trust.tolerance,
            width: width.into(),
            apart,
            taken: rows.len(),
            pieces,
            map,
            alarms,
            one_label: one_label.map(|label| (label, absent.into())),
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

/// The label of all ground, if all rows have it, or if there is more likely no front than one.
fn one_label(rows: &[Row], absent: f32) -> Option<Label> {
    let labels = || rows.iter().filter_map(|row| row.label);
    let (all, positive) = (labels().count(), labels().filter(|it| *it == Label::Positive).count());
    let usual = if 2 * positive > all { Label::Positive } else { Label::Negative };
    let is_one = absent > ABSENT || positive == 0 || positive == all;
    (is_one && all > 0).then_some(usual)
}
