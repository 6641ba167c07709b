//! `next`: what a robot is to do next, from text to text. The contract is in docs/reference/next.md.
//!
//! Nothing is kept between two calls. The answer has a state that the next request gives back: the motions that were made
//! and what was read. Planners decide the same again from the same, so all of them are planned anew.

use std::path::Path;

use anyhow::{Context as _, Result, anyhow};
use crc::{CRC_32_ISO_HDLC, Crc};
use nalgebra::Point2;
use planner_core::{Heading, Label, Motion, Pose, Reading, Site};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use serde_with::skip_serializing_none;

use crate::mission::definition::Mission;
use crate::mission::lake::Lake;
use crate::mission::read_out::{Expectation, Knowledge};
use crate::mission::recording::beside_truth;
use crate::mission::results::{End, Ending, EstimateRecords, StepResult, stage_name};
use crate::mission::scenario::{self, Overrides};
use crate::mission::session::{Arrival, Session};
use crate::mission::setting::{self, Setting};
use crate::mission::strict::wrong;
use crate::mission::terrain::on_map;

/// What a request has beside the keys of a scenario.
struct Request {
    /// Where the robot is: `x`, `z` and `heading`, or `lat`, `lon` and `heading`; in the first request [default: `start`]
    pose: Option<Place>,
    /// What it read there, after a motion that wants a label: -1, 0 on the boundary, 1, or null if it could read none
    label: Option<Value>,
    /// What it read on the way, in order, each with its place and its `label` [default: none]
    on_the_way: Vec<Place>,
    /// In the first request: labels of others, each with its place. They may be wrong where labels may; those of `oracle` may not [default: none]
    samples: Vec<Place>,
    /// In all requests but the first: the `state` of the answer before
    state: Option<State>,
}

/// A place as a request gives it, with a heading or with a label.
#[skip_serializing_none]
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Place {
    x: Option<f64>,
    z: Option<f64>,
    lat: Option<f64>,
    lon: Option<f64>,
    heading: Option<f64>,
    label: Option<i8>,
}

/// What was done so far.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct State {
    /// Of the scenario and of what follows.
    check: u32,
    /// Where it began, if the first request said so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    start: Option<Place>,
    /// Labels of others.
    samples: Vec<Told>,
    /// The motions.
    done: Vec<Done>,
}

/// Metres on the lattice, and a label.
type Told = (f64, f64, i8);

/// A motion that was made: where it ended, what was read there, and on the way.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Done {
    x: f64,
    z: f64,
    heading: f64,
    label: Option<i8>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    on_the_way: Vec<Told>,
}

/// What is to be done, and what is known.
#[derive(Serialize)]
struct Answer<'a> {
    /// The motion to make next; null at the end.
    next: Option<Next>,
    /// What is expected of its label: the `chance` that it is 1, and the `bits` that it tells on average; null if none is wanted.
    why: Option<Why>,
    /// The reason why the mission has ended, as in the trace; null before.
    stop: Option<&'static str>,
    /// What is known: `bits`, `slope_arcs` and `intercept` as in a step of the trace, `estimates` as at its end.
    known: Known,
    /// The step that was just made, as the trace has it; null before the first.
    step: Option<&'a StepResult>,
    /// The end, as the trace has it; null before.
    end: Option<&'a End>,
    /// For the next request; `host-sim next` always prints it.
    #[serde(skip_serializing_if = "Option::is_none")]
    state: Option<&'a State>,
    /// Of an area from a map: the place, in the map's coordinates, from which the metres of `known`, `step` and `end` are counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<[f64; 2]>,
}

/// A motion: where it ends, and how to come there.
#[derive(Serialize)]
struct Next {
    /// Where it ends, `x` and `z` or `lat` and `lon`, as the request has them.
    #[serde(flatten)]
    at: At,
    /// The heading there, radians.
    heading: f64,
    /// Radians to turn: on the spot before the drive, or along the arc of a car.
    turn: f32,
    /// Metres to drive.
    drive: f32,
    /// Whether a label is wanted there.
    label: bool,
    /// What the motion is for, as in the trace.
    problem: Option<&'static str>,
    /// Its number in the vehicle's grid.
    index: u32,
}

/// In the coordinates of the request.
#[derive(Serialize)]
#[serde(untagged)]
enum At {
    Metres { x: f64, z: f64 },
    Degrees { lat: f64, lon: f64 },
}

#[derive(Serialize)]
struct Why {
    chance: f64,
    bits: f64,
}

#[derive(Serialize)]
struct Known {
    bits: f64,
    slope_arcs: Vec<[f64; 2]>,
    intercept: Option<[f64; 2]>,
    estimates: EstimateRecords,
}

/// Keys that may be others in a later request.
const FREE: [&str; 4] = ["steps", "labels", "stop", "price"];

/// What a request is called in messages.
const NAME: &str = "the request";

/// A mission whose motions are made by whoever asks for them, in JSON.
pub struct Conversation {
    session: Session,
    state: State,
    /// What the check sum of the state is of.
    scenario: String,
}

/// Answers a request. Its keys of a scenario take the place of those of a scenario file, if there is one: its name, its text
/// and its folder.
///
/// # Errors
/// Names the key, what was found and what was expected.
pub fn answer(request: &str, scenario: Option<(&str, &str, &Path)>) -> Result<String> {
    Conversation::begin(request, scenario)?.answer()
}

/// The keys of an object in JSON.
fn keys(text: &str) -> Result<Map<String, Value>> {
    serde_json::from_str(text).map_err(|error| {
        let at = error.line();
        anyhow!("{NAME}:{at}: expected a JSON object, as {{\"oracle\": [], ...}} ({error})")
    })
}

impl Conversation {
    /// Reads a request, and makes what its state says.
    ///
    /// # Errors
    /// As [`answer`].
    pub fn begin(request: &str, scenario: Option<(&str, &str, &Path)>) -> Result<Self> {
        let mut keys = keys(request)?;
        let request = Request::taken(&mut keys).context(NAME)?;
        let (is_first, pose) = (request.state.is_none(), request.pose);
        let label = request.label.clone();
        let on_the_way = request.on_the_way.clone();
        let mut begun = Self::open(request, keys, scenario)?;
        if !is_first {
            begun.take(pose, label, &on_the_way).context(NAME)?;
        }
        Ok(begun)
    }

    /// As [`begin`](Self::begin) by the first request, and goes on after what a state in JSON says.
    ///
    /// # Errors
    /// As [`answer`].
    pub fn resume(first: &str, scenario: Option<(&str, &str, &Path)>, state: &str) -> Result<Self> {
        let mut keys = keys(first)?;
        let request = Request::taken(&mut keys).context(NAME)?;
        let state = serde_json::from_str(state).map_err(|why| anyhow!("{NAME}: state: {why}"))?;
        let request = Request { state: Some(state), samples: Vec::new(), ..request };
        Self::open(request, keys, scenario)
    }

    fn open(
        request: Request,
        keys: Map<String, Value>,
        scenario: Option<(&str, &str, &Path)>,
    ) -> Result<Self> {
        let start = request.state.as_ref().map_or(request.pose, |it| it.start);
        let start = start.map(serde_json::to_value).transpose()?;
        let start = start.map(|it| Map::from_iter([("start".to_owned(), it)]));
        let mut set = settings("the request: ", keys);
        set.extend(start.into_iter().flat_map(|it| settings("the request: pose as ", it)));
        let (name, text, folder) = scenario.unwrap_or((NAME, "", Path::new("")));
        let overrides = Overrides { set: &set, ..Overrides::default() };
        let mission = scenario::parse_real(name, text, folder, overrides)?;
        let mut table: toml::Table = toml::from_str(&setting::put(&set, text)?)?;
        table.retain(|key, _| !FREE.contains(&key));
        Self::made(request, mission, toml::to_string(&table)?).context(NAME)
    }

    /// The mission, after what the state of a request says.
    fn made(request: Request, mission: Mission, scenario: String) -> Result<Self> {
        let state = match request.state {
            Some(state) if state.check != state.sum(&scenario) => {
                let expected = "that of the last answer to the same scenario, unchanged";
                return wrong("state", "another one", expected);
            }
            Some(_) if !request.samples.is_empty() => {
                return wrong("samples", "some beside a state", "all in the first request");
            }
            Some(state) => state,
            None if request.label.is_some() || !request.on_the_way.is_empty() => {
                let expected = "none in the first request: labels of others stand in samples";
                return wrong("label", "one without a state", expected);
            }
            None => {
                let samples = told("samples", &request.samples, mission.lake.as_deref())?;
                State { check: 0, start: request.pose, samples, done: Vec::new() }
            }
        };
        let samples = readings_of("state.samples", &state.samples)?;
        let mut it = Self { session: Session::new(mission, &samples)?, state, scenario };
        for (k, done) in it.state.done.iter().enumerate() {
            it.session.arrive(&done.arrival(&format!("state.done[{k}]"))?)?;
        }
        Ok(it)
    }

    /// Takes in what the next motion came to, from an object with `pose`, `label` and `on_the_way` as a request has them.
    ///
    /// # Errors
    /// As [`answer`]. The conversation is not to be gone on with then.
    pub fn arrive(&mut self, arrival: &str) -> Result<()> {
        let mut keys = keys(arrival)?;
        let Request { pose, label, on_the_way, .. } = Request::taken(&mut keys).context(NAME)?;
        self.take(pose, label, &on_the_way).context(NAME)
    }

    fn take(
        &mut self,
        pose: Option<Place>,
        label: Option<Value>,
        on_the_way: &[Place],
    ) -> Result<()> {
        let lake = self.session.mission().lake.clone();
        let Some(pose) = pose else {
            return wrong("pose", "none", "where the last motion ended");
        };
        if label.is_none() && self.session.plan().is_ok_and(|it| it.wants_label) {
            let expected = "-1 or 1, as the motion asked for one; null if none could be read";
            return wrong("label", "none", expected);
        }
        let label = label.unwrap_or_default();
        let number = label.as_i64().and_then(|it| i8::try_from(it).ok());
        if number.is_none() && !label.is_null() {
            return wrong("label", label, "-1, 0 on the boundary, 1, or null");
        }
        let label = number;
        label.map(|it| reading("label", it)).transpose()?;
        let on_the_way = told("on_the_way", on_the_way, lake.as_deref())?;
        let [x, z] = pose.at("pose", lake.as_deref())?;
        let heading = pose.heading.unwrap_or_default();
        let done = Done { x, z, heading, label, on_the_way };
        self.session.arrive(&done.arrival("pose")?)?;
        self.state.done.push(done);
        Ok(())
    }

    /// The state, in JSON.
    ///
    /// # Errors
    /// None that is known: when it cannot be written as JSON.
    pub fn state(&mut self) -> Result<String> {
        self.state.check = self.state.sum(&self.scenario);
        Ok(serde_json::to_string(&self.state)?)
    }

    /// What is to be done next, what is known, and the state.
    ///
    /// # Errors
    /// As [`state`](Self::state).
    pub fn answer(&mut self) -> Result<String> {
        self.told(true)
    }

    /// The same without the state, which grows with the mission.
    ///
    /// # Errors
    /// As [`state`](Self::state).
    pub fn brief_answer(&mut self) -> Result<String> {
        self.told(false)
    }

    fn told(&mut self, has_state: bool) -> Result<String> {
        let next = self.session.plan();
        if has_state {
            self.state.check = self.state.sum(&self.scenario);
        }
        let Self { session, state, .. } = self;
        let (mission, belief) = (session.mission(), session.belief());
        let Knowledge { slope_arcs, intercept, bits, .. } = belief.knowledge();
        let world = mission.world.after(state.done.len());
        let estimates = beside_truth(mission, &world, belief.estimates());
        let why = next.ok().filter(|it| it.wants_label).map(|it| {
            let Expectation { chance, bits } = belief.expects(it.target.site);
            Why { chance, bits }
        });
        let end = next.err().map(|ending| session.recording(ending).results.end);
        let answer = Answer {
            next: next.ok().map(|it| Next::of(&it, mission.lake.as_deref())),
            why,
            stop: next.err().map(Ending::name),
            known: Known { bits, slope_arcs, intercept, estimates },
            step: session.last(),
            end: end.as_ref(),
            state: has_state.then_some(&*state),
            origin: mission.lake.as_ref().and_then(|it| it.frame.origin),
        };
        Ok(serde_json::to_string(&answer)? + "\n")
    }

    /// The mission as it has come so far.
    pub const fn session(&self) -> &Session {
        &self.session
    }
}

/// The mission of a simulated world, by keys of a scenario in JSON and a scenario file as of [`answer`].
///
/// # Errors
/// As [`answer`].
pub fn simulated(request: &str, scenario: Option<(&str, &str, &Path)>) -> Result<Mission> {
    let set = settings("", keys(request)?);
    let (name, text, folder) = scenario.unwrap_or(("the scenario", "", Path::new("")));
    scenario::parse_in(name, text, folder, Overrides { set: &set, ..Overrides::default() })
}

/// The keys of a scenario, by who gives them.
fn settings(by: &'static str, keys: Map<String, Value>) -> Vec<Setting> {
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

/// A key of a request, which is taken out of it.
fn take<T: DeserializeOwned>(keys: &mut Map<String, Value>, key: &str) -> Result<Option<T>> {
    let value = keys.remove(key).filter(|it| !it.is_null());
    value.map(|it| of_json(key, it)).transpose()
}

fn of_json<T: DeserializeOwned>(key: &str, value: Value) -> Result<T> {
    serde_json::from_value(value).map_err(|why| anyhow!("{key}: {why}"))
}

impl Request {
    fn taken(keys: &mut Map<String, Value>) -> Result<Self> {
        Ok(Self {
            pose: take(keys, "pose")?,
            label: keys.remove("label"),
            on_the_way: take(keys, "on_the_way")?.unwrap_or_default(),
            samples: take(keys, "samples")?.unwrap_or_default(),
            state: take(keys, "state")?,
        })
    }
}

fn told(field: &str, places: &[Place], lake: Option<&Lake>) -> Result<Vec<Told>> {
    let each = places.iter().enumerate();
    each.map(|(k, it)| it.told(&format!("{field}[{k}]"), lake)).collect()
}

impl State {
    fn sum(&self, scenario: &str) -> u32 {
        let all = (scenario, &self.start, &self.samples, &self.done);
        let bytes = serde_json::to_vec(&all).unwrap_or_default();
        Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(&bytes)
    }
}

impl Place {
    /// Metres on the lattice.
    fn at(mut self, field: &str, lake: Option<&Lake>) -> Result<[f64; 2]> {
        on_map(field, lake, [&mut self.x, &mut self.z], [self.lat, self.lon])?;
        match (self.x, self.z) {
            (Some(x), Some(z)) => Ok([x, z]),
            _ => wrong(field, "a part of a position", "x and z"),
        }
    }

    fn told(self, field: &str, lake: Option<&Lake>) -> Result<Told> {
        let [x, z] = self.at(field, lake)?;
        let key = format!("{field}.label");
        let Some(label) = self.label else {
            return wrong(
                &key,
                "none",
                "-1, 0 on the boundary, or 1; leave out what could not be read",
            );
        };
        reading(&key, label)?;
        Ok((x, z, label))
    }
}

fn site(field: &str, x: f64, z: f64) -> Result<Site> {
    Site::try_from(Point2::new(x, z)).map_err(|why| anyhow!("{field}: {why}"))
}

fn reading(key: &str, label: i8) -> Result<Reading> {
    Ok(match label {
        1 => Label::Positive.into(),
        -1 => Label::Negative.into(),
        0 => Reading::Boundary,
        other => return wrong(key, other, "-1, 0 on the boundary, or 1"),
    })
}

fn readings_of(field: &str, told: &[Told]) -> Result<Vec<(Site, Reading)>> {
    let one = |(k, &(x, z, label)): (usize, &Told)| {
        let field = format!("{field}[{k}]");
        Ok((site(&field, x, z)?, reading(&format!("{field}.label"), label)?))
    };
    told.iter().enumerate().map(one).collect()
}

impl Done {
    fn arrival(&self, field: &str) -> Result<Arrival> {
        let heading = Heading::from_radians(self.heading);
        let heading = heading.map_err(|why| anyhow!("{field}.heading: {why}"))?;
        Ok(Arrival {
            pose: Pose { site: site(field, self.x, self.z)?, heading },
            reading: self.label.map(|it| reading(&format!("{field}.label"), it)).transpose()?,
            passed: readings_of(field, &self.on_the_way)?,
        })
    }
}

impl Next {
    fn of(motion: &Motion, lake: Option<&Lake>) -> Self {
        let at = Point2::<f64>::from(motion.target.site);
        let at = match lake {
            None => At::Metres { x: at.x, z: at.y },
            Some(lake) => {
                let [first, second] = lake.frame.exactly(at);
                if lake.frame.is_geographic() {
                    At::Degrees { lat: first, lon: second }
                } else {
                    At::Metres { x: first, z: second }
                }
            }
        };
        Self {
            at,
            heading: motion.target.heading.radians(),
            turn: motion.control.turn_rad,
            drive: motion.control.distance_m,
            label: motion.wants_label,
            problem: motion.stage.map(stage_name),
            index: motion.action.0,
        }
    }
}
