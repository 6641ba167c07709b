//! The samples of a trace that `run --trace` wrote: the oracle's, and those of the steps.

use anyhow::{Result, anyhow, bail};
use planner_core::belief::sample::Label;
use serde::Deserialize;

use crate::replay::rows::{Layout, Rows};

/// As much of a record as is read here; see the contract of the trace in ARCHITECTURE.md.
#[derive(Deserialize)]
#[serde(tag = "record", rename_all = "lowercase")]
enum Record {
    Start { oracle: Vec<Given>, p: f64 },
    Step(Step),
    End {},
}

#[derive(Deserialize)]
struct Given {
    x: f64,
    z: f64,
    label: i8,
}

#[derive(Deserialize)]
struct Step {
    pose: Pose,
    label: Option<i8>,
    #[serde(default)]
    trusted: bool,
}

#[derive(Deserialize)]
struct Pose {
    x: f64,
    z: f64,
}

/// Whether a text is one: its first character begins a record.
pub(crate) fn is_one(text: &[u8]) -> bool {
    text.trim_ascii_start().first() == Some(&b'{')
}

/// The rows of a trace. What was sensed on the boundary itself tells no side, and is left out.
///
/// # Errors
/// Names the file and the line, what was found and what was expected.
pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Rows> {
    if layout.columns.is_some() || layout.delimiter.is_some() {
        bail!("{name}: found a trace, expected no --columns and no --delimiter with it");
    }
    let mut rows = Rows::default();
    for (line, record) in (1..).zip(text.split(|byte| *byte == b'\n')) {
        if record.trim_ascii().is_empty() {
            continue;
        }
        let record = serde_json::from_slice(record).map_err(|error| {
            anyhow!(
                "{name}:{line}: expected a record of a trace, as run --trace writes it: {error}"
            )
        })?;
        match (record, rows.p) {
            (Record::Start { oracle, p }, None) => {
                rows.p = Some(p);
                rows.certain = (0..oracle.len()).collect();
                for given in oracle {
                    take(&mut rows, [given.x, given.z], given.label, line)
                        .map_err(|error| anyhow!("{name}:{line}: {error}"))?;
                }
            }
            (Record::Start { .. }, Some(_)) => {
                bail!("{name}:{line}: found a second start, expected the trace of one mission")
            }
            (_, None) => bail!("{name}:{line}: found no start, expected it as the first record"),
            (Record::Step(step), _) => {
                let Some(label) = step.label.filter(|label| *label != 0) else { continue };
                if step.trusted {
                    rows.certain.push(rows.labels.len());
                }
                take(&mut rows, [step.pose.x, step.pose.z], label, line)
                    .map_err(|error| anyhow!("{name}:{line}: {error}"))?;
            }
            (Record::End {}, _) => {}
        }
    }
    Ok(rows)
}

fn take(rows: &mut Rows, position: [f64; 2], label: i8, line: usize) -> Result<()> {
    let label = match label {
        1 => Label::Positive,
        -1 => Label::Negative,
        other => bail!("label: found {other}, expected -1 or 1"),
    };
    rows.push(position, label, line);
    Ok(())
}
