//! The trace of a mission so far: it grows on disc beside its place and outlives this program.
//!
//! It needs no record of which mission it belongs to, as a mission is the same whenever it is flown. To resume, the
//! steps are computed again. Each must reproduce the line in the file, or the file is no trace of this mission.

use std::io::{Read as _, Write as _};
use std::path::Path;

use anyhow::{Context as _, Result, anyhow, bail};
use planner_core::{Label, Reading};
use serde_json::Value;

use crate::mission::results::{End, Start, StepResult};
use crate::mission::trace::{self, Record};
use crate::output::file::place_for;
use crate::output::partial::{Begin, Partial};

/// What was sensed in a step.
#[derive(Clone, Debug)]
pub struct Sensed {
    /// On the way, in order.
    pub on_the_way: Vec<Reading>,
    /// At the end.
    pub at_end: Option<Reading>,
}

/// The trace of a mission that is being flown.
#[derive(Debug)]
pub struct Logbook {
    partial: Partial,
}

impl Logbook {
    /// Begins a logbook, or continues an existing one. `make` computes the mission's next step again. It gets the labels
    /// in the file, which the chip's own sensor may have read.
    ///
    /// # Errors
    /// Names the file and the line that is not of this mission, or the file that cannot be read or written.
    pub fn open(
        path: &Path,
        start: &Start,
        mut make: impl FnMut(Sensed) -> Result<String>,
    ) -> Result<Self> {
        let place = place_for(path)?;
        let header = trace::start(start);
        let goes_on = "the same command with --resume goes on with them";
        let begin = Begin { holds: "steps", goes_on, resume: true };
        let mut partial = Partial::open(path, &place, &header, begin)?;
        let mut text = Vec::new();
        let name = partial.name().to_owned();
        partial.reader()?.read_to_end(&mut text).with_context(|| name.clone())?;
        let mut lines = text.split_inclusive(|byte| *byte == b'\n').zip(1..);
        let first = lines.next().map_or(&[][..], |(line, _)| line);
        begins(first, &header).with_context(|| format!("{name}:1"))?;
        let mut kept = first.len() as u64;
        for (line, number) in lines {
            // A line without an end was cut off while it was written.
            let Some(line) = line.strip_suffix(b"\n") else { break };
            if !follow(line, &mut make).with_context(|| format!("{name}:{number}"))? {
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
        self.partial.complete()
    }

    /// Where to find what is finished.
    pub(crate) fn farewell(&self) -> String {
        self.partial.farewell()
    }
}

/// Checks that the first line is the start of this mission's trace.
///
/// # Errors
/// Names the first key that has another value, or says that the line is no start at all.
fn begins(line: &[u8], header: &str) -> Result<()> {
    const NONE: &str = "found something else than the start of this mission's trace, expected that start: remove the \
        file to begin the mission anew";
    let whole =
        line.strip_suffix(b"\n").and_then(|line| str::from_utf8(line).ok()).context(NONE)?;
    let Ok(Record::Start(_)) = Record::read(whole.as_bytes()) else { bail!(NONE) };
    same(whole, header)
}

/// Computes the step of a line again. Returns `false` if the line is the mission's end, which is written anew.
fn follow(line: &[u8], make: impl FnOnce(Sensed) -> Result<String>) -> Result<bool> {
    let line = str::from_utf8(line).context("expected a step")?;
    let step = match Record::read(line.as_bytes()).context("expected a step")? {
        Record::End(_) => return Ok(false),
        Record::Step(step) => step,
        Record::Start(_) => bail!("expected a step"),
    };
    let at_end = match step.label {
        Some(-1) => Some(Reading::Side(Label::Negative)),
        Some(0) => Some(Reading::Boundary),
        Some(1) => Some(Reading::Side(Label::Positive)),
        _ => None,
    };
    let on_the_way = step.passed().map(|(_, reading)| reading).collect();
    same(line, &make(Sensed { on_the_way, at_end })?).map(|()| true)
}

/// Checks that a line is the expected one.
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
