//! Rows as they were recorded, and how a file of them is to be read.

use anyhow::{Result, bail};
use planner_core::Label;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::mission::results::{Name, Start, StepResult};
use crate::replay::columns::Columns;
use crate::world::crs::Crs;

/// How a file is to be read, as far as flags say.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    /// Its columns.
    pub columns: Option<Columns>,
    /// The delimiter between them.
    pub delimiter: Option<u8>,
    /// The place that becomes the origin of positions.
    pub origin: Option<[f64; 2]>,
    /// The coordinate system of positions in metres.
    pub crs: Option<Crs>,
    /// Labels are measured values: above this they are +1.
    pub threshold: Option<f64>,
    /// A row without a value is an error.
    pub strict: bool,
    /// What else the rows say is kept.
    pub keeps: bool,
}

/// What the rows of a file are called, and what numbers them from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Unit {
    /// A row, by the line on which it begins.
    #[default]
    Line,
    /// A feature of `GeoJSON`, by its place among the features.
    Feature,
}

impl Unit {
    /// The file and the place in it.
    pub(crate) fn place(self, file: &str, number: usize) -> String {
        match self {
            Self::Line => format!("{file}:{number}"),
            Self::Feature => format!("{file}: feature {number}"),
        }
    }

    /// What is skipped.
    pub(crate) const fn row(self) -> &'static str {
        match self {
            Self::Line => "row",
            Self::Feature => "feature",
        }
    }

    /// What numbers it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Feature => "feature",
        }
    }
}

/// What a row says beside its position, by the titles of its columns or the names of its properties.
pub(crate) type Told = Map<String, Value>;

/// Rows without a value, which are no samples.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Skipped {
    #[serde(rename = "rows")]
    pub(crate) count: usize,
    /// The line of the first, or its feature.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) first: Option<usize>,
    /// What the first lacks.
    #[serde(skip)]
    pub(crate) lacks: String,
}

/// A sample as it was recorded.
#[derive(Debug)]
pub(crate) struct Recorded {
    /// Metres, or latitude and longitude.
    pub(crate) position: [f64; 2],
    pub(crate) label: Label,
    /// What the label was measured as, of each sample or of none.
    pub(crate) value: Option<f64>,
    /// The line of the file on which it begins, or the number of its feature.
    pub(crate) line: usize,
    /// What else its row says, if that is kept.
    pub(crate) told: Told,
}

/// Rows as they were recorded.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    pub(crate) samples: Vec<Recorded>,
    /// A row whose value is far outside the range of all others: its place, the value, that range.
    pub(crate) odd: Option<(usize, f64, [f64; 2])>,
    /// Rows of an earlier time than the row before: how many, and the place of the first.
    pub(crate) backwards: Option<(usize, usize)>,
    pub(crate) unit: Unit,
    pub(crate) skipped: Skipped,
    /// The rows whose labels are certain, whatever `p` is.
    pub(crate) certain: Vec<usize>,
    /// How often the others are true, if the file says.
    pub(crate) p: Option<f64>,
    pub(crate) is_geographic: bool,
    /// The titles of the columns of positions, of a table that has titles.
    pub(crate) titles: Option<[String; 2]>,
    /// The mission, of a trace.
    pub(crate) mission: Option<Box<Traced>>,
}

/// The mission of a trace: also its steps without a label.
#[derive(Debug)]
pub(crate) struct Traced {
    pub(crate) start: Start,
    pub(crate) steps: Vec<StepResult>,
    /// Why it ended, if the trace has its end.
    pub(crate) reason: Option<Name>,
}

impl Rows {
    pub(crate) fn push(&mut self, position: [f64; 2], label: Label, line: usize) {
        self.samples.push(Recorded { position, label, value: None, line, told: Told::new() });
    }

    /// Counts a row that is no sample in a strict file either, such as one of units or of titles.
    pub(crate) fn heading(&mut self, line: usize, what: &str) {
        self.skipped.count += 1;
        if self.skipped.first.is_none() {
            (self.skipped.first, self.skipped.lacks) = (Some(line), what.to_owned());
        }
    }

    /// Leaves a row out, which lacks something.
    ///
    /// # Errors
    /// What it lacks, where the layout is strict.
    pub(crate) fn skip(&mut self, layout: &Layout, line: usize, lacks: &str) -> Result<()> {
        if layout.strict {
            bail!("{lacks}, expected a value in each {}, as --strict says", self.unit.row());
        }
        self.heading(line, lacks);
        Ok(())
    }
}
