//! `sensor` of a scenario file: how the simulated sensor fails. The trace has the same keys.

use anyhow::Result;
use planner_core::Label;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

use crate::mission::strict::{beyond, wrong};
use crate::world::faults::{Fault, FaultKind};

/// One fault: one kind, and the labels that it spoils, by their numbers from 1.
#[skip_serializing_none]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FaultTable {
    /// `true`: no reading
    off: Option<bool>,
    /// This label, -1 or 1
    stuck: Option<i64>,
    /// `true`: either label, each with probability 1/2
    garbage: Option<bool>,
    /// `true`: the opposite label
    inverted: Option<bool>,
    /// The label of the place so many metres before the end of the motion, 0 to 1024, or of its start if that is nearer
    slow: Option<f64>,
    /// The reading of the label that was asked for so many labels before; none for the first of them
    delayed: Option<i64>,
    /// No reading with this probability
    dropouts: Option<f64>,
    /// The first label that is spoilt, counted from 1 [default: 1]
    from: Option<i64>,
    /// The last one [default: no last one]
    to: Option<i64>,
}

/// The most faults of a sensor.
const MOST: usize = 16;

/// The longest way by which a sensor is slow, metres.
const FURTHEST: f64 = 1024.0;

/// The faults of some tables.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub(crate) fn faults<'a>(
    tables: impl ExactSizeIterator<Item = &'a FaultTable>,
) -> Result<Vec<Fault>> {
    if tables.len() > MOST {
        return wrong("sensor", format!("{} faults", tables.len()), format!("at most {MOST}"));
    }
    tables.enumerate().map(|(i, table)| table.fault(&format!("sensor[{i}]"))).collect()
}

impl FaultTable {
    fn fault(&self, field: &str) -> Result<Fault> {
        let name = |key: &str| format!("{field}.{key}");
        let is_on = |key: &str, value: bool, kind: FaultKind| {
            if value { Ok(kind) } else { beyond(&name(key), "false") }
        };
        let kinds = [
            self.off.map(|it| is_on("off", it, FaultKind::Off)),
            self.stuck.map(|it| match it {
                1 => Ok(FaultKind::Stuck(Label::Positive)),
                -1 => Ok(FaultKind::Stuck(Label::Negative)),
                other => beyond(&name("stuck"), other),
            }),
            self.garbage.map(|it| is_on("garbage", it, FaultKind::Garbage)),
            self.inverted.map(|it| is_on("inverted", it, FaultKind::Inverted)),
            self.slow.map(|it| match it {
                0.0..=FURTHEST => Ok(FaultKind::Slow(it)),
                _ => beyond(&name("slow"), it),
            }),
            self.delayed.map(|it| Ok(FaultKind::Delayed(count(&name("delayed"), it, 1)?))),
            self.dropouts.map(|it| match it {
                0.0..=1.0 => Ok(FaultKind::Dropouts(it)),
                _ => beyond(&name("dropouts"), it),
            }),
        ];
        let mut kinds = kinds.into_iter().flatten();
        let kind = match (kinds.next(), kinds.next()) {
            (Some(kind), None) => kind?,
            (none, _) => {
                let found = if none.is_none() { "no kind" } else { "more than one kind" };
                let expected = "one of off, stuck, garbage, inverted, slow, delayed and dropouts";
                return wrong(field, found, expected);
            }
        };
        let from = self.from.map_or(Ok(1), |it| count(&name("from"), it, 1))?;
        let to = self.to.map_or(Ok(u32::MAX), |it| count(&name("to"), it, from))?;
        Ok(Fault { kind, from, to })
    }
}

fn count(field: &str, value: i64, least: u32) -> Result<u32> {
    let count = u32::try_from(value).ok().filter(|count| (least..u32::MAX).contains(count));
    count.map_or_else(
        || wrong(field, value, format!("a whole number of labels, {least} or more")),
        Ok,
    )
}

impl From<&Fault> for FaultTable {
    fn from(&Fault { kind, from, to }: &Fault) -> Self {
        let table = Self {
            from: (from > 1).then_some(from.into()),
            to: (to < u32::MAX).then_some(to.into()),
            ..Self::default()
        };
        match kind {
            FaultKind::Off => Self { off: Some(true), ..table },
            FaultKind::Stuck(label) => Self { stuck: Some(label.sign().into()), ..table },
            FaultKind::Garbage => Self { garbage: Some(true), ..table },
            FaultKind::Inverted => Self { inverted: Some(true), ..table },
            FaultKind::Slow(metres) => Self { slow: Some(metres), ..table },
            FaultKind::Delayed(labels) => Self { delayed: Some(labels.into()), ..table },
            FaultKind::Dropouts(probability) => Self { dropouts: Some(probability), ..table },
        }
    }
}

/// The fault in words, as `stuck at +1 from label 5 on`.
impl std::fmt::Display for FaultTable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kinds = [
            self.off.map(|_| "off".to_owned()),
            self.stuck.map(|label| format!("stuck at {label:+}")),
            self.garbage.map(|_| "either label by chance".to_owned()),
            self.inverted.map(|_| "inverted".to_owned()),
            self.slow.map(|metres| format!("slow by {metres} m")),
            self.delayed.map(|labels| {
                format!("late by {labels} label{}", if labels == 1 { "" } else { "s" })
            }),
            self.dropouts.map(|share| format!("no reading with probability {share}")),
        ];
        f.write_str(&kinds.into_iter().flatten().collect::<String>())?;
        match (self.from, self.to) {
            (None, None) => Ok(()),
            (Some(from), None) => write!(f, " from label {from} on"),
            (from, Some(to)) => write!(f, " from label {} to {to}", from.unwrap_or(1)),
        }
    }
}
