//! Convex hulls of recorded positions, exact.

use planner_core::lattice::orient;
use planner_core::{Label, Sample, Site};

/// A sample and its row in the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// The sample.
    pub sample: Sample,
    /// Its number in the recording.
    pub index: usize,
}

impl Row {
    /// Where it is.
    pub fn site(self) -> Site {
        self.sample.site
    }
}

/// The rows of a record by their positions; of those that repeat a sample, the first.
pub fn in_order(samples: &[Sample]) -> Vec<Row> {
    let mut rows: Vec<_> =
        samples.iter().enumerate().map(|(index, sample)| Row { sample: *sample, index }).collect();
    let place = |row: &Row| (row.site().x(), row.site().z(), row.sample.label.sign());
    rows.sort_unstable_by_key(|row| (place(row), row.index));
    rows.dedup_by_key(|row| place(row));
    rows
}

/// A convex hull as two chains of corners between its first and its last in order, both of which are in both
/// chains; no three of its corners are on one line.
#[derive(Debug)]
pub struct Hull {
    /// From the first to the last, counter-clockwise.
    pub lower: Vec<Row>,
    /// On from the last to the first.
    pub upper: Vec<Row>,
}

impl Hull {
    /// The hull of those of some rows in order that have a label (Andrew's monotone chain).
    pub fn of<'a>(rows: impl DoubleEndedIterator<Item = &'a Row> + Clone, label: Label) -> Self {
        let rows = rows.copied().filter(|row| row.sample.label == label);
        Self { lower: chain(rows.clone()), upper: chain(rows.rev()) }
    }

    /// The corners, counter-clockwise.
    pub fn corners(&self) -> impl Iterator<Item = Row> + '_ {
        let back = self.upper.get(1..self.upper.len().max(2) - 1).unwrap_or_default();
        self.lower.iter().chain(back).copied()
    }
}

fn chain(rows: impl Iterator<Item = Row>) -> Vec<Row> {
    let mut chain: Vec<Row> = Vec::new();
    for row in rows {
        while let [.., a, b] = chain[..]
            && orient(a.site(), b.site(), row.site()) <= 0
        {
            chain.pop();
        }
        chain.push(row);
    }
    chain
}
