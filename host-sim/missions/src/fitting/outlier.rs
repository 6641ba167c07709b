//! Which row is to blame if no line separates a record.
//!
//! The first row that leaves no line need not be the wrong one: after a wrong label early in a file, a true one
//! contradicts it sooner or later. But consider a row without which a line separates the rest. It is part of every set
//! of rows that no line separates. A smallest such set has four rows at most where positions are true (Kirchberger's
//! theorem). So the search finds one such set, and leaves each of its rows out of the record once.

use planner_core::{Label, Sample};

use crate::fitting::halving::last_good;
use crate::fitting::hull::{Hull, Row};

/// Samples that repeat each other, by their indices: one leaves them out together.
pub type Repeats = Vec<usize>;

/// The samples each of which, left out alone, leaves both labels and a line that separates them.
///
/// `rows` are the rows [in order](crate::fitting::hull::in_order) of the samples, and no line separates them.
/// `are_separable` says whether a line separates some rows in order. It is asked for all rows a few times.
pub fn outliers(
    samples: &[Sample],
    rows: &[Row],
    are_separable: impl Fn(&[Row]) -> bool,
) -> Vec<Repeats> {
    let explains = |row: &Row| {
        let rest: Vec<_> = rows.iter().filter(|other| *other != row).copied().collect();
        let has = |label| rest.iter().any(|row| row.sample.label == label);
        has(Label::Positive) && has(Label::Negative) && are_separable(&rest)
    };
    let repeats = |row: Row| {
        let is_it = |index: &usize| samples[*index] == row.sample;
        (row.index..samples.len()).filter(is_it).collect()
    };
    let contradicting = smallest_contradiction(rows, &are_separable);
    let mut found: Vec<Repeats> = contradicting.into_iter().filter(explains).map(repeats).collect();
    found.sort();
    found
}

/// Rows that no line separates, while one separates them without any one of them.
fn smallest_contradiction(rows: &[Row], are_separable: impl Fn(&[Row]) -> bool) -> Vec<Row> {
    // What lies within the hulls changes nothing.
    let corners = |label| Hull::of(rows.iter(), label).corners().collect::<Vec<_>>();
    let mut others = [corners(Label::Positive), corners(Label::Negative)].concat();
    let mut needed: Vec<Row> = Vec::new();
    let agree = |needed: &[Row], others: &[Row]| {
        let mut some = [needed, others].concat();
        some.sort_unstable_by_key(|row| (row.site().x(), row.site().z(), row.sample.label.sign()));
        are_separable(&some)
    };
    while agree(&needed, &[]) && !others.is_empty() {
        // The first `good` of the others agree with those that are needed, and one more does not.
        let good = last_good(others.len(), |count| agree(&needed, &others[..count]));
        needed.push(others[good]);
        others.truncate(good);
    }
    needed
}
