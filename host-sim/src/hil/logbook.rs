//! The trace of a mission as far as it has been flown: it grows on disc beside its place, and outlives this program.
//!
//! It needs no record of which mission it is of. A mission is the same whenever it is flown, so its steps are made
//! again, and each makes the line that is there, or this is no trace of it.

use std::io::{Read as _, Write as _};
use std::path::Path;

use anyhow::{Context as _, Result, anyhow, bail};
use planner_core::belief::sample::{Label, Reading};
use serde_json::Value;

use crate::mission::results::{End, Start, StepResult};
use crate::output::file::place_for;
use crate::output::partial::{Begin, Partial};
use crate::report::trace;

/// The trace of a mission that is being flown.
#[derive(Debug)]
pub struct Logbook {
    partial: Partial,
}

impl Logbook {
    /// Begins one, or goes on with the one that is there: `make` makes the mission's next step again, given what a
    /// chip's own sensor may have read at its end.
    ///
    /// # Errors
    /// Names the file and the line that is not of this mission, or the file that cannot be read or written.
    pub fn open(
        path: &Path,
        start: &Start,
        mut make: impl FnMut(Option<Reading>) -> Result<String>,
    ) -> Result<Self> {
        let place = place_for(path)?;
        let header = trace::start(start);
        let begin = Begin { holds: "steps", header: &header, record: None, resume: true };
        let mut partial = Partial::open(path, &place, begin)?;
        let mut text = Vec::new();
        let name = partial.name().to_owned();
        partial.reader(u64::MAX)?.read_to_end(&mut text).with_context(|| name.clone())?;
        let mut kept = 0;
        // What has no end was cut off as it was written.
        for (line, number) in text.split_inclusive(|byte| *byte == b'\n').zip(1..) {
            let Some(line) = line.strip_suffix(b"\n") else { break };
            let is_one = std::str::from_utf8(line).ok().map_or(Ok(false), |line| {
                if number == 1 {
                    same(line, &header).map(|()| true)
                } else {
                    follow(line, &mut make)
                }
            });
            if !is_one.with_context(|| format!("{name}:{number}"))? {
                break;
            }
            kept += line.len() as u64 + 1;
        }
        partial.cut(kept).with_context(|| name)?;
        partial.announce();
        Ok(Self { partial })
    }

    /// Takes down a step.
    ///
    /// # Errors
    /// Names the file that could not be written.
    pub(crate) fn take(&mut self, step: &StepResult) -> Result<()> {
        let written = self.partial.write_all(trace::step(step).as_bytes());
        written.with_context(|| self.partial.name().to_owned())
    }

    /// The mission is over: the trace takes its place.
    ///
    /// # Errors
    /// Names the file that could not be written or moved.
    pub fn complete(mut self, end: &End) -> Result<()> {
        let written = self.partial.write_all(trace::end(end).as_bytes());
        written.with_context(|| self.partial.name().to_owned())?;
        self.partial.complete(|_| None)
    }

    /// Where to find what is finished.
    pub(crate) fn farewell(&self) -> String {
        self.partial.farewell()
    }
}

/// Has the step of a line made again; `false` if that is the mission's end, which is told once more.
fn follow(line: &str, make: impl FnOnce(Option<Reading>) -> Result<String>) -> Result<bool> {
    let found: Value = serde_json::from_str(line).context("expected a step")?;
    match found["record"].as_str() {
        Some("end") => return Ok(false),
        Some("step") => {}
        _ => bail!("expected a step"),
    }
    let read = match found["label"].as_i64() {
        Some(-1) => Some(Reading::Side(Label::Negative)),
        Some(0) => Some(Reading::Boundary),
        Some(1) => Some(Reading::Side(Label::Positive)),
        _ => None,
    };
    same(line, &make(read)?).map(|()| true)
}

/// Whether a line is the one that it should be.
///
/// # Errors
/// Names the first key that has another value.
fn same(found: &str, expected: &str) -> Result<()> {
    if found == expected.trim_end() {
        return Ok(());
    }
    let [there, here]: [Value; 2] = [
        serde_json::from_str(found).context("expected a record")?,
        serde_json::from_str(expected)?,
    ];
    let keys = here.as_object().into_iter().flat_map(|it| it.keys());
    let differs = keys.into_iter().find(|key| there[*key] != here[*key]);
    Err(match differs {
        Some(key) => {
            anyhow!("found {key} {}, expected {}: of another mission", there[key], here[key])
        }
        None => anyhow!("found what is not of this mission, expected {}", expected.trim_end()),
    })
}
