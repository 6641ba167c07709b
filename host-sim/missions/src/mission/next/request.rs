//! A request: the keys of a scenario, and what the robot says of its last motion.

use anyhow::{Result, anyhow};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::mission::lake::Lake;
use crate::mission::next::place::{Place, told};
use crate::mission::next::state::State;
use crate::mission::setting::Setting;
use crate::mission::strict::wrong;

/// What a request is called in messages.
pub(super) const NAME: &str = "the request";

/// What a request has beside the keys of a scenario.
pub(super) struct Request {
    /// Where the robot is: `x` and `z`, or `lat` and `lon`, and `heading` [default: in the first request `start`]
    pub(super) pose: Option<Place>,
    /// What it read there: -1, 1, 0 on the boundary, or null if it could read nothing
    pub(super) label: Option<Value>,
    /// What it read on the way, in order: places, each with its `label` [default: none]
    pub(super) on_the_way: Vec<Place>,
    /// In the first request: places that others have sensed, each with its `label` [default: none]
    pub(super) samples: Vec<Place>,
    /// In all requests but the first: the `state` of the answer before
    pub(super) state: Option<State>,
}

/// A key of a request, which is taken out of it.
fn take<T: DeserializeOwned>(keys: &mut Map<String, Value>, key: &str) -> Result<Option<T>> {
    let value = keys.remove(key).filter(|it| !it.is_null());
    value.map(|it| of_json(key, it)).transpose()
}

fn of_json<T: DeserializeOwned>(key: &str, value: Value) -> Result<T> {
    serde_json::from_value(value).map_err(|why| anyhow!("{key}: {why}"))
}

impl Request {
    pub(super) fn taken(keys: &mut Map<String, Value>) -> Result<Self> {
        Ok(Self {
            pose: take(keys, "pose")?,
            label: keys.remove("label"),
            on_the_way: take(keys, "on_the_way")?.unwrap_or_default(),
            samples: take(keys, "samples")?.unwrap_or_default(),
            state: take(keys, "state")?,
        })
    }

    /// The state of a first request: nothing is done yet.
    ///
    /// # Errors
    /// Names the key that a first request cannot have, or the place that is none.
    pub(super) fn first_state(&self, lake: Option<&Lake>) -> Result<State> {
        let is_told = self.label.as_ref().is_some_and(|it| !it.is_null());
        if is_told || !self.on_the_way.is_empty() {
            let expected = "none in the first request: labels of others stand in samples";
            return wrong("label", "one without a state", expected);
        }
        self.pose.map(|it| it.at("pose", lake)).transpose()?;
        let samples = told("samples", &self.samples, lake)?;
        Ok(State { check: 0, start: self.pose, samples, done: Vec::new() })
    }
}

/// The keys of an object in JSON.
pub(super) fn keys(text: &str) -> Result<Map<String, Value>> {
    serde_json::from_str(text).map_err(|error| {
        let at = error.line();
        anyhow!("{NAME}:{at}: expected a JSON object, as {{\"oracle\": [], ...}} ({error})")
    })
}

/// The keys of a scenario, by who gives them.
pub(super) fn settings(by: &'static str, keys: Map<String, Value>) -> Vec<Setting> {
    let set = |(key, value)| Some(Setting::new(by, key, toml(value)?));
    keys.into_iter().filter_map(set).collect()
}

/// A value as TOML has it; `None` of null.
fn toml(value: Value) -> Option<toml::Value> {
    Some(match value {
        Value::Null => return None,
        Value::Bool(it) => it.into(),
        Value::Number(it) => match it.as_i64() {
            Some(whole) => whole.into(),
            None => it.as_f64()?.into(),
        },
        // JSON has no such number.
        Value::String(it) if it == "inf" => f64::INFINITY.into(),
        Value::String(it) => it.into(),
        Value::Array(all) => all.into_iter().filter_map(toml).collect::<Vec<_>>().into(),
        Value::Object(all) => {
            let entry = |(key, value)| Some((key, toml(value)?));
            all.into_iter().filter_map(entry).collect::<toml::Table>().into()
        }
    })
}
