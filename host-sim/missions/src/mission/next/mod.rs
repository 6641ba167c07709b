//! `next`: what a robot is to do next, from text to text. The contract is in docs/reference/next.md.
//!
//! Nothing is kept between two calls. The answer has a state that the next request gives back: the motions that were made
//! and what was read. Planners decide the same again from the same, so all of them are planned anew.

mod answer;
mod place;
mod request;
mod state;

use std::path::Path;

use anyhow::{Context as _, Result, anyhow};
use serde_json::{Map, Value};

use crate::mission::definition::Mission;
use crate::mission::next::answer::{Answer, Known, Next, Why};
use crate::mission::next::place::{reading, readings_of, told};
use crate::mission::next::request::{NAME, Request, keys, settings};
use crate::mission::next::state::{Done, State};
use crate::mission::read_out::{Expectation, Knowledge};
use crate::mission::recording::beside_truth;
use crate::mission::results::Ending;
use crate::mission::scenario::{self, Overrides};
use crate::mission::session::Session;
use crate::mission::setting;
use crate::mission::strict::wrong;

/// Keys that may be others in a later request: what may change under way, and what no planner is told.
const FREE: [&str; 6] = ["steps", "labels", "stop", "price", "truth", "sensor"];

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

impl Conversation {
    /// Reads a request, and makes what its state says.
    ///
    /// # Errors
    /// As [`answer`].
    pub fn begin(request: &str, scenario: Option<(&str, &str, &Path)>) -> Result<Self> {
        let mut keys = keys(request)?;
        let mut request = Request::taken(&mut keys).context(NAME)?;
        let state = request.state.take();
        let is_first = state.is_none();
        let mut begun = Self::open(&request, state, keys, scenario)?;
        if !is_first {
            begun.take(&request).context(NAME)?;
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
        Self::open(&Request { samples: Vec::new(), ..request }, Some(state), keys, scenario)
    }

    fn open(
        request: &Request,
        state: Option<State>,
        keys: Map<String, Value>,
        scenario: Option<(&str, &str, &Path)>,
    ) -> Result<Self> {
        let start = state.as_ref().map_or(request.pose, |it| it.start);
        let start = start.map(serde_json::to_value).transpose()?;
        let start = start.map(|it| Map::from_iter([("start".to_owned(), it)]));
        let mut set = settings("the request: ", keys);
        set.extend(start.into_iter().flat_map(|it| settings("the request: pose as ", it)));
        let (name, text, folder) = scenario.unwrap_or((NAME, "", Path::new("")));
        let overrides = Overrides { set: &set, ..Overrides::default() };
        let mission = scenario::parse_real(name, text, folder, overrides)?;
        let mut table: toml::Table = toml::from_str(&setting::put(&set, text)?)?;
        table.retain(|key, _| !FREE.contains(&key));
        Self::made(request, state, mission, toml::to_string(&table)?).context(NAME)
    }

    /// The mission, after what a state says.
    fn made(
        request: &Request,
        state: Option<State>,
        mission: Mission,
        scenario: String,
    ) -> Result<Self> {
        let state = match state {
            Some(state) if state.check != state.sum(&scenario) => {
                let expected = "that of the last answer to the same scenario, unchanged";
                return wrong("state", "another one", expected);
            }
            Some(_) if !request.samples.is_empty() => {
                return wrong("samples", "some beside a state", "all in the first request");
            }
            Some(state) => state,
            None => request.first_state(mission.lake.as_deref())?,
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
        let request = Request::taken(&mut keys(arrival)?).context(NAME)?;
        self.take(&request).context(NAME)
    }

    fn take(&mut self, request: &Request) -> Result<()> {
        let lake = self.session.mission().lake.clone();
        let lake = lake.as_deref();
        let Some(pose) = request.pose else {
            return wrong("pose", "none", "where the last motion ended");
        };
        let Some(heading) = pose.heading else {
            return wrong(
                "pose.heading",
                "none",
                "radians from the x axis, where the motion ended",
            );
        };
        let label = match &request.label {
            None if self.session.plan().is_ok_and(|it| it.wants_label) => {
                let expected = "-1, 0 on the boundary, or 1, as the motion asked for one; null if \
                                none could be read";
                return wrong("label", "none", expected);
            }
            None | Some(Value::Null) => None,
            Some(label) => {
                let number = label.as_i64().and_then(|it| i8::try_from(it).ok());
                let Some(number) = number.filter(|it| reading("label", *it).is_ok()) else {
                    return wrong("label", label, "-1, 0 on the boundary, 1, or null");
                };
                Some(number)
            }
        };
        let on_the_way = told("on_the_way", &request.on_the_way, lake)?;
        let [x, z] = pose.at("pose", lake)?;
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
