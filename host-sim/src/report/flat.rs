//! The steps of a mission as flat records, for data frames: every key on every line, and no lists.
//!
//! Rows are made from the trace. Keys are those of the trace, and each part of a list or an object there has a key of
//! its own here. So a new field of a step needs nothing here.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

use crate::mission::results::{Results, Start, StepResult};
use crate::mission::trace;
use crate::output::file::json;

/// The keys that every row has, in their order. Keys that only some missions have come after them.
const KEYS: &str = "algorithm seed p truth_angle truth_slope truth_intercept step problem recovery index v w x z \
    heading true_x true_z true_heading label trusted slope_from slope_to intercept_from intercept_to bits entropy \
    hypotheses pruned_mass examined proven control_cost metres";

/// A step: its keys in their order, with null where it has no value.
#[derive(Clone, Debug)]
pub(crate) struct Row(Vec<(String, Value)>);

impl Row {
    /// The value under a key, null if there is none.
    pub(crate) fn get(&self, wanted: &str) -> &Value {
        self.0.iter().find(|(key, _)| key == wanted).map_or(&Value::Null, |(_, value)| value)
    }

    /// The keys that only some missions have.
    pub(crate) fn added(&self) -> impl Iterator<Item = &str> {
        self.0.iter().skip(KEYS.split(' ').count()).map(|(key, _)| key.as_str())
    }
}

impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

/// The steps of a mission, one a line.
pub fn lines(results: &Results) -> String {
    rows(results).iter().map(json).collect()
}

/// The steps of a mission.
pub(crate) fn rows(results: &Results) -> Vec<Row> {
    let steps = results.steps.iter().map(|step| parts(&results.start, step));
    let steps: Vec<_> = steps.collect();
    let usual = KEYS.split(' ').map(ToOwned::to_owned);
    let added: BTreeSet<_> = steps.iter().flat_map(BTreeMap::keys).cloned().collect();
    let added = added.into_iter().filter(|key| !KEYS.split(' ').any(|usual| usual == key));
    let keys: Vec<_> = usual.chain(added).collect();
    let value = |step: &BTreeMap<_, _>, key| step.get(key).cloned().unwrap_or(Value::Null);
    let row = |step| Row(keys.iter().map(|key| (key.clone(), value(step, key))).collect());
    steps.iter().map(row).collect()
}

/// The parts of a step's record, and what the trace has once for all steps.
fn parts(
    Start { algorithm, seed, p, truth, .. }: &Start,
    step: &StepResult,
) -> BTreeMap<String, Value> {
    // From its line in the trace, as single precision has its own digits there.
    let mut record: Map<_, _> = serde_json::from_str(&trace::step(step)).expect("an object");
    let pose = record.remove("true_pose");
    let readings = record.remove("readings").map(|_| step.readings.len());
    let cuts = readings.map(|_| step.readings.iter().filter(|it| it.cuts).count());
    record.retain(|key, _| !["record", "slope_arcs"].contains(&key.as_str()));
    let more = json!({
        "algorithm": algorithm,
        "seed": seed,
        "p": p,
        "truth": truth,
        "slope": interval(&step.slope_arcs),
        "true": pose,
        "readings": readings,
        "readings_cut": cuts,
        "proven": step.proven.unwrap_or(true),
        "control_cost": step.control_cost,
        "metres": step.metres,
    });
    record.extend(more.as_object().cloned().unwrap_or_default());
    let mut parts = BTreeMap::new();
    for (key, value) in record {
        match value {
            Value::Null => {}
            Value::Object(of) if ["pose", "action"].contains(&key.as_str()) => parts.extend(of),
            Value::Object(of) => {
                parts.extend(of.into_iter().map(|(part, value)| (format!("{key}_{part}"), value)));
            }
            Value::Array(ends) => {
                let ends = ["from", "to"].map(|end| format!("{key}_{end}")).into_iter().zip(ends);
                parts.extend(ends);
            }
            value => drop(parts.insert(key, value)),
        }
    }
    parts
}

/// Slopes as one interval, degrees; across the vertical it ends beyond 90.
fn interval(intervals: &[[f64; 2]]) -> Option<[f64; 2]> {
    match *intervals {
        [[_, to], [from, _]] => Some([from, to + 180.0]),
        ref one => one.first().copied(),
    }
}
