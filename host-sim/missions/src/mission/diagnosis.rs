//! The record of a mission whose labels no straight, still line explains.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::fitting::explanation::Cause;
use crate::mission::line_record::LineRecord;

/// Why no straight, still line explains the labels of a mission.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct DiagnosisRecord {
    /// The label that no line left has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refuting: Option<RefutingRecord>,
    /// The line that the fewest labels disagree with.
    pub line: LineRecord,
    /// All labels, those of given samples included.
    pub labels: usize,
    /// How many of them disagree with that line.
    pub disagreeing: usize,
    /// The share of them.
    pub share: f64,
    /// The steps of those that do. Others are given samples.
    pub steps: Vec<usize>,
    /// What explains the labels: `bend`, `drift`, `two boundaries`, `stuck`, `inverted`, `stuck or inverted` (both read the same), `late`, `random`,
    /// `line` (a straight line does all the same), `cannot tell`.
    pub cause: Cause,
    /// Where labels are true: the probability of each cause, if all are alike beforehand.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub shares: BTreeMap<Cause, f64>,
    /// The tolerance that covers a bend or a drift as the labels have it, metres: with probability 0.9 where labels are
    /// true. It is there if one of the two may be the cause.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
}

/// A label that no line left has.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct RefutingRecord {
    /// The step that read it.
    pub step: usize,
    /// Metres.
    pub x: f64,
    /// Metres.
    pub z: f64,
    /// The label that was read.
    pub label: i8,
    /// The label that all lines left have there.
    pub expected: i8,
}
