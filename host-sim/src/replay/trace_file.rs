//! The samples of a trace that `run --trace` wrote: the oracle's, and those of the steps.

use anyhow::{Result, anyhow, bail};
use planner_core::Label;

use crate::mission::trace::Record;
use crate::replay::rows::{Layout, Rows, Traced};

/// The rows of a trace. A reading on the boundary itself has no side, and is left out.
///
/// # Errors
/// Names the file and the line, what was found and what was expected.
pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Rows> {
    let mut rows = Rows::default();
    for (line, record) in (1..).zip(text.split(|byte| *byte == b'\n')) {
        if record.trim_ascii().is_empty() {
            continue;
        }
        let record = Record::read(record).map_err(|error| {
            anyhow!(
                "{name}:{line}: expected a record of a trace, as run --trace writes it: {error}"
            )
        })?;
        take(&mut rows, record, line).map_err(|error| anyhow!("{name}:{line}: {error}"))?;
    }
    let Layout { columns, delimiter, threshold, crs, .. } = layout;
    if columns.is_some() || delimiter.is_some() || threshold.is_some() || crs.is_some() {
        bail!(
            "{name}: found a trace, expected no --columns, --delimiter, --threshold and --crs with it"
        );
    }
    Ok(rows)
}

fn take(rows: &mut Rows, record: Record<'_>, line: usize) -> Result<()> {
    match (record, rows.mission.as_mut()) {
        (Record::Start(start), None) => {
            rows.p = Some(start.p);
            rows.certain = (0..start.oracle.len()).collect();
            for given in &start.oracle {
                rows.push([given.x, given.z], label(given.label)?, line);
            }
            let start = start.into_owned();
            rows.mission = Some(Box::new(Traced { start, steps: Vec::new(), reason: None }));
        }
        (Record::Start(_), Some(_)) => {
            bail!("found a second start, expected the trace of one mission")
        }
        (_, None) => bail!("found no start, expected a trace, which begins with it"),
        (Record::Step(step), Some(_)) => {
            for it in step.readings.iter().take(step.passed().count()) {
                // What was left out told the planner nothing.
                if it.cuts && it.label != 0 {
                    rows.push([it.x, it.z], label(it.label)?, line);
                }
            }
            if let Some(read) = step.label.filter(|read| *read != 0) {
                if step.trusted == Some(true) {
                    rows.certain.push(rows.samples.len());
                }
                rows.push([step.pose.x, step.pose.z], label(read)?, line);
            }
            if let Some(mission) = &mut rows.mission {
                mission.steps.push(step.into_owned());
            }
        }
        (Record::End(end), Some(mission)) => mission.reason = Some(end.into_owned().reason),
    }
    Ok(())
}

fn label(read: i8) -> Result<Label> {
    match read {
        1 => Ok(Label::Positive),
        -1 => Ok(Label::Negative),
        other => bail!("label: found {other}, expected -1 or 1"),
    }
}
