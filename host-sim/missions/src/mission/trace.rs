//! The trace: a mission's results as JSON Lines, written and read. The contract is in docs/reference/trace.md.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use serde_json::{Error, from_slice};

use crate::mission::results::{End, Results, Start, StepResult};
use crate::output::file::json;

/// A line of the trace.
#[derive(Serialize)]
#[serde(tag = "record", rename_all = "lowercase")]
pub enum Record<'a> {
    /// What the mission began with.
    Start(Cow<'a, Start>),
    /// A step.
    Step(Cow<'a, StepResult>),
    /// How it ended.
    End(Cow<'a, End>),
}

impl Record<'static> {
    /// A line as it was read.
    ///
    /// # Errors
    /// When it is no record, or lacks what no reader can do without.
    pub fn read(line: &[u8]) -> Result<Self, Error> {
        #[derive(Deserialize)]
        #[serde(rename_all = "lowercase")]
        enum Kind {
            Start,
            Step,
            End,
        }
        #[derive(Deserialize)]
        struct Tag {
            record: Kind,
        }
        // First the kind alone. Serde's own way to read a tagged enumeration does not understand numbers where another
        // crate makes `serde_json` keep their digits.
        Ok(match from_slice::<Tag>(line)?.record {
            Kind::Start => Self::Start(from_slice(line)?),
            Kind::Step => Self::Step(from_slice(line)?),
            Kind::End => Self::End(from_slice(line)?),
        })
    }
}

/// The trace of a mission, a record a line.
pub fn lines(results: &Results) -> String {
    let steps = results.steps.iter().map(step);
    std::iter::once(start(&results.start)).chain(steps).chain([end(&results.end)]).collect()
}

/// The line that it begins with.
pub fn start(start: &Start) -> String {
    json(&Record::Start(Cow::Borrowed(start)))
}

/// The line of a step.
pub fn step(step: &StepResult) -> String {
    json(&Record::Step(Cow::Borrowed(step)))
}

/// The line that it ends with.
pub fn end(end: &End) -> String {
    json(&Record::End(Cow::Borrowed(end)))
}
