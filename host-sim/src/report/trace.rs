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
    let steps = results.steps.iter().map(step);
    std::iter::once(start(&results.start)).chain(steps).chain([end(&results.end)]).collect()
}

/// The line that it begins with.
pub fn start(start: &Start) -> String {
    json(&Record::Start(start))
}

/// The line of a step.
pub fn step(step: &StepResult) -> String {
    json(&Record::Step(step))
}

/// The line that it ends with.
pub fn end(end: &End) -> String {
    json(&Record::End(end))
}
