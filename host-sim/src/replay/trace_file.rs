//! The samples of a trace that `run --trace` wrote: the oracle's, and those of the steps.

use anyhow::{Result, anyhow, bail};
use planner_core::Label;
use serde::Deserialize;

use crate::replay::rows::{Layout, Rows};

/// The fields of a record that are read here; the contract of the trace is in ARCHITECTURE.md. All kinds share one
/// structure. With a tagged enumeration serde would not understand numbers if another crate makes it keep their digits.
#[derive(Deserialize)]
struct Record {
    #[serde(rename = "record")]
    kind: Kind,
    oracle: Option<Vec<Given>>,
    p: Option<f64>,
    pose: Option<Pose>,
    label: Option<i8>,
    #[serde(default)]
    trusted: bool,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Start,
    Step,
    End,
}

#[derive(Deserialize)]
struct Given {
    x: f64,
    z: f64,
    label: i8,
}

#[derive(Deserialize)]
struct Pose {
    x: f64,
    z: f64,
}

/// The rows of a trace. A reading on the boundary itself has no side, and is left out.
///
/// # Errors
/// Names the file and the line, what was found and what was expected.
pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Rows> {
    let Layout { columns, delimiter, threshold, crs, .. } = layout;
    if columns.is_some() || delimiter.is_some() || threshold.is_some() || crs.is_some() {
        bail!(
            "{name}: found a trace, expected no --columns, --delimiter, --threshold and --crs with it"
        );
    }
    let mut rows = Rows::default();
    for (line, record) in (1..).zip(text.split(|byte| *byte == b'\n')) {
        if record.trim_ascii().is_empty() {
            continue;
        }
        let expected =
            format!("{name}:{line}: expected a record of a trace, as run --trace writes it");
        let record: Record =
            serde_json::from_slice(record).map_err(|error| anyhow!("{expected}: {error}"))?;
        match (record.kind, rows.p) {
            (Kind::Start, None) => {
                let (Some(oracle), Some(p)) = (record.oracle, record.p) else {
                    bail!("{expected}: found a start without oracle or p")
                };
                rows.p = Some(p);
                rows.certain = (0..oracle.len()).collect();
                for given in oracle {
                    take(&mut rows, [given.x, given.z], given.label, line)
                        .map_err(|error| anyhow!("{name}:{line}: {error}"))?;
                }
            }
            (Kind::Start, Some(_)) => {
                bail!("{name}:{line}: found a second start, expected the trace of one mission")
            }
            (_, None) => {
                bail!("{name}:{line}: found no start, expected a trace, which begins with it")
            }
            (Kind::Step, _) => {
                let Some(pose) = record.pose else {
                    bail!("{expected}: found a step without pose")
                };
                let Some(label) = record.label.filter(|label| *label != 0) else { continue };
                if record.trusted {
                    rows.certain.push(rows.labels.len());
                }
                take(&mut rows, [pose.x, pose.z], label, line)
                    .map_err(|error| anyhow!("{name}:{line}: {error}"))?;
            }
            (Kind::End, _) => {}
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
