//! The trace: a mission's results as JSON Lines. The contract is in ARCHITECTURE.md.

use serde::Serialize;

use crate::mission::results::{End, Results, Start, StepResult};
use crate::output::file::json;

#[derive(Serialize)]
#[serde(tag = "record", rename_all = "lowercase")]
enum Record<'a> {
    Start(&'a Start),
    Step(&'a StepResult),
    End(&'a End),
}

/// The trace of a mission, a record a line.
pub fn lines(results: &Results) -> String {
    let start = std::iter::once(Record::Start(&results.start));
    let steps = results.steps.iter().map(Record::Step);
    let end = std::iter::once(Record::End(&results.end));
    start.chain(steps).chain(end).map(|record| json(&record)).collect()
}
