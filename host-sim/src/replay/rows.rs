//! Rows as they were recorded, and how a file of them is to be read.

use planner_core::belief::sample::Label;

use crate::replay::columns::Columns;
use crate::replay::delimiter::Delimiter;

/// How a file is to be read, as far as one says so.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    /// Its columns.
    pub columns: Option<Columns>,
    /// What is between them.
    pub delimiter: Option<Delimiter>,
    /// The place that positions are taken about.
    pub origin: Option<[f64; 2]>,
}

/// Rows as they were recorded.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    /// Metres, or latitude and longitude.
    pub(crate) positions: Vec<[f64; 2]>,
    pub(crate) labels: Vec<Label>,
    /// The line of the file on which each begins.
    pub(crate) lines: Vec<usize>,
    /// The rows whose labels are certain, whatever `p` is.
    pub(crate) certain: Vec<usize>,
    /// How often the others are true, where the file tells it.
    pub(crate) p: Option<f64>,
    pub(crate) is_geographic: bool,
}

impl Rows {
    pub(crate) fn push(&mut self, position: [f64; 2], label: Label, line: usize) {
        self.positions.push(position);
        self.labels.push(label);
        self.lines.push(line);
    }
}
