//! Scenario files: what a mission is, in TOML. The contract is in docs/reference/scenario.md.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context as _, Error, Result, anyhow};
use nalgebra::Point2;
use planner_core::link::message::{MissionArea, Settings};
use planner_core::{
    AnyReliability, AnyVehicle, EffortWeight, Following, Goal, Heading, Label, Noise, Pose,
    Reliability, Site, Tolerance, UnknownReliability, Workspace as _,
};
use serde::Deserialize;

use crate::mission::algorithm::Algorithm;
use crate::mission::allowance::{self, Allowance};
use crate::mission::asking::{AskTable, Asking, Price};
use crate::mission::bounds::Bounds;
use crate::mission::chords;
use crate::mission::definition::Mission;
use crate::mission::doubts;
use crate::mission::front::{self, FrontTable};
use crate::mission::given::{CAPACITY, Lines};
use crate::mission::given::{SampleTable, given, given_of_front};
use crate::mission::lake::Lake;
use crate::mission::lawnmower;
use crate::mission::names::{CrossingName, FanName, FollowingName, PolicyName, PriorName};
use crate::mission::seeking::{self, SeekTable};
use crate::mission::sensor::{self, FaultTable};
use crate::mission::setting::{self, Setting};
use crate::mission::stop::StopTable;
use crate::mission::strict::{Table, beyond, checked, no_angle, wrong};
use crate::mission::terrain::{self, AreaTable, KeepOutTable, Terrain, on_map, site};
use crate::mission::truth::TruthTable;
use crate::mission::vehicle::{self, Source, VehicleTable};
use crate::mission::wording::{SCENARIO, at_its_line, check_toml, expected, of_toml};
use crate::output::kind;
use crate::world::World;
use crate::world::errors::{CUT, Errors};
use crate::world::noise::{Extent, NoiseModel, limit};

/// The paper's noiseless example (Section V).
pub const PAPER_NOISELESS: &str = include_str!("../../../scenarios/paper-noiseless.toml");

/// The paper's noisy example (Section V).
pub const PAPER_NOISY: &str = include_str!("../../../scenarios/paper-noisy.toml");

/// The keys of a scenario file. Their comments are the tables of `docs/reference/scenario.md`, as are those of the tables
/// below them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    /// Who plans: `cfc`, `scc`, `lookahead`, `chords`, `margin`, `random`, `lawnmower`, `track` [default: `cfc`]
    #[serde(default)]
    algorithm: Algorithm,
    /// Motions at most, 1 to 10000; fewer where labels may be wrong [default: 10]
    #[serde(default = "defaults::steps")]
    steps: u32,
    /// Readings of a motion, 1 to 50, evenly spread over it; the last is the label at its end [default: 1]
    #[serde(default = "defaults::readings")]
    readings: u32,
    /// Seed of whatever is random [default: 1]
    #[serde(default = "defaults::seed")]
    seed: u64,
    /// The weight of driving against a label, 0 to below 1 [default: 0.1; `lookahead` 0.002]
    varrho: Option<f64>,
    /// Rays of the unicycle: `paper`, 10 mrad apart, or `fine`, 1 urad [default: `paper`; `lookahead`, `chords` and `track` `fine`]
    fan: Option<FanName>,
    /// What moves [default: the unicycle of the fan]
    vehicle: Option<Table<VehicleTable>>,
    /// How P1 looks for the opposite label: `anyhow`, `along-oracle`, `across-bisector` [default: `anyhow`]
    #[serde(default)]
    crossing: CrossingName,
    /// How P2 follows the boundary: `along-bisector`, `anyhow` [default: `along-bisector`; `scc` `anyhow`]
    following: Option<FollowingName>,
    /// How hypotheses choose together (`scc`): `mixture-of-own`, `mixture-of-start`, `joint` [default: `mixture-of-own`]
    #[serde(default)]
    policy: PolicyName,
    /// How hypotheses are weighed beforehand: `area`, `sequences` (the paper's) [default: `area`]
    #[serde(default)]
    prior: PriorName,
    /// How often labels are true [default: always]
    noise: Option<Table<NoiseTable>>,
    /// Standard deviations of the simulated robot [default: 0]
    #[serde(default)]
    errors: Table<ErrorsTable>,
    /// Faults of the simulated sensor, 16 at most [default: none]
    #[serde(default)]
    sensor: Vec<Table<FaultTable>>,
    /// How far a reported position may be off, metres [default: 3 `errors.position`]
    tolerance: Option<f64>,
    /// Added to the tolerance [default: nothing]
    #[serde(default)]
    allow: Table<Allowance>,
    /// What is enough to know (`lookahead`, `track`) [default: nothing]
    stop: Option<Table<StopTable>>,
    /// What a label costs, metres driven up to 16384, or `"none"` (`lookahead`) [default: see below]
    price: Option<Price>,
    /// Labels at ends of motions, at most [default: no limit]
    labels: Option<u32>,
    /// Which labels are read (`lookahead`) [default: all]
    #[serde(default)]
    ask: Table<AskTable>,
    /// Where positions stay [default: a square of 20 m]
    #[serde(default)]
    area: Table<AreaTable>,
    /// What no motion touches, 8 at most [default: nothing]
    #[serde(default)]
    keep_out: Vec<Table<KeepOutTable>>,
    /// Where the mission begins [default: the first oracle point, heading 0]
    #[serde(default)]
    start: Table<StartTable>,
    /// The boundary that the simulated sensor reads; required, but for `fly`
    truth: Option<Table<TruthTable>>,
    /// Points whose labels are known; required, `[]` if there are none
    oracle: Vec<Table<SampleTable>>,
    /// What else is known of the line [default: nothing]
    #[serde(default)]
    bounds: Table<Bounds>,
    /// What is known of a front (`track`) [default: it stands still]
    front: Option<Table<FrontTable>>,
    /// What is known of a boundary that is sought from nothing [default: its usual]
    seek: Option<Table<SeekTable>>,
}

mod defaults {
    pub(super) fn steps() -> u32 {
        10
    }
    pub(super) fn readings() -> u32 {
        1
    }
    pub(super) fn seed() -> u64 {
        1
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NoiseTable {
    /// Labels are true with this probability, above 0.5; or `[a, b]`: nobody knows, and planners are told the prior Beta(a, b)
    p: Told,
    /// What the simulated sensor does, whatever planners are told [default: `p`, or the mean of the prior]
    true_p: Option<f64>,
    /// Within this distance of the oracle's points labels are certain, metres [default: 0]
    trusted_radius: Option<f64>,
    /// The paper's band: labels err within this distance of the line alone, metres. Planners are told `p` alone
    band: Option<f64>,
}

impl NoiseTable {
    /// How often labels are true, as far as anybody says.
    fn mean(&self) -> f64 {
        let told = match self.p {
            Told::Number(p) => p,
            Told::Beta([a, b]) => a / (a + b),
        };
        self.true_p.unwrap_or(told)
    }
}

/// How often labels are true, as planners are told.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "expected a probability, or the [a, b] of a Beta prior")]
enum Told {
    Number(f64),
    Beta([f64; 2]),
}

/// Standard deviations, metres and radians.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct ErrorsTable {
    /// Where a motion ends, metres an axis
    motion: f64,
    /// How far a motion turns, radians
    turn: f64,
    /// The position that is reported, metres an axis
    position: f64,
    /// The heading that is reported, radians
    heading: f64,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct StartTable {
    /// Metres [default: that of the first oracle point]
    x: Option<f64>,
    /// Metres [default: that of the first oracle point]
    z: Option<f64>,
    /// Degrees, where the area is from a map
    lat: Option<f64>,
    /// Degrees, where the area is from a map
    lon: Option<f64>,
    /// Radians from the x axis to the z axis [default: 0]
    #[serde(default)]
    heading: f64,
}

/// What flags put in place of the file's values.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides<'a> {
    /// Who plans.
    pub algorithm: Option<Algorithm>,
    /// Steps at most.
    pub steps: Option<u32>,
    /// Seed of whatever is random.
    pub seed: Option<u64>,
    /// Any other key.
    pub set: &'a [Setting],
}

/// The mission that a scenario file describes, to be flown in a simulated world.
///
/// # Errors
/// One message with the file, the line or field, what was found and what was expected.
pub fn read(path: &Path, overrides: Overrides<'_>) -> Result<Mission> {
    parse_in(&path.display().to_string(), &content(path)?, beside(path), overrides)
}

/// As [`read`], for a real vehicle: the file need not have a `truth`, and its `sensor` is not simulated.
///
/// # Errors
/// As [`read`].
pub fn read_real(path: &Path, overrides: Overrides<'_>) -> Result<Mission> {
    parse_real(&path.display().to_string(), &content(path)?, beside(path), overrides)
}

/// As [`read_real`], from the text of the file called `name` in a folder.
///
/// # Errors
/// As [`read`].
pub fn parse_real(
    name: &str,
    text: &str,
    folder: &Path,
    overrides: Overrides<'_>,
) -> Result<Mission> {
    let mission = any(name, text, folder, overrides)?;
    Ok(Mission { sensor: Vec::new(), ..mission })
}

/// As [`read`], from the text of the file called `name`. Other files are sought in the current folder.
///
/// # Errors
/// As [`read`].
pub fn parse(name: &str, text: &str, overrides: Overrides<'_>) -> Result<Mission> {
    parse_in(name, text, Path::new(""), overrides)
}

/// The same with its other files in a folder.
///
/// # Errors
/// As [`parse`].
pub fn parse_in(
    name: &str,
    text: &str,
    folder: &Path,
    overrides: Overrides<'_>,
) -> Result<Mission> {
    let mission = any(name, text, folder, overrides)?;
    if !mission.world.is_known() {
        let found = wrong("truth", "none", BOUNDARY);
        return found.with_context(|| name.to_owned());
    }
    Ok(mission)
}

/// What a simulated world is divided by.
const BOUNDARY: &str = "the boundary to simulate, as truth = { slope = 0.4, intercept = 3.5 }";

/// The folder of a file.
pub fn beside(path: &Path) -> &Path {
    path.parent().unwrap_or(path)
}

/// What is in a scenario file.
///
/// # Errors
/// Names the file and what was found in its place.
pub fn content(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|error| {
        anyhow!("{}: found {}, expected {SCENARIO}", path.display(), kind::unread(&error))
    })
}

/// The mission, whether it says what is true or not.
fn any(name: &str, text: &str, folder: &Path, overrides: Overrides<'_>) -> Result<Mission> {
    check_toml(name, text)?;
    let set = setting::put(overrides.set, text)?;
    let placed = |why: String| {
        let key = why.split(": ").next().unwrap_or_default();
        match overrides.set.iter().rfind(|it| it.gives(key)) {
            // A wrong number in a flag is reported as the flag's.
            _ if why.starts_with("--") => anyhow!(why),
            Some(setting) => anyhow!("{}{why}", setting.by()),
            None => at_its_line(name, text, why),
        }
    };
    let file: Result<File, _> = toml::from_str(&set);
    let mut file = file.map_err(|error| placed(of_toml(&set, &error)))?;
    mission(&mut file, folder, overrides).map_err(|error| placed(format!("{error:#}")))
}

/// The most steps of a mission whose labels are true: a version space makes room for more.
const MOST: u32 = 10_000;

/// The most steps of a mission with an audit where labels may be wrong. Labels of an audit take no room.
const MOST_WITH_AUDIT: u32 = 1_000;

/// The most readings of a motion.
const MOST_READINGS: u32 = 50;

/// What the labels of a mission take room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Room {
    /// True labels: only those that bound the lines left.
    OfTrue,
    /// Labels that may be wrong and are limited by themselves: each, however many steps there are.
    Apart,
    /// Labels that may be wrong: each, but for those of an audit.
    ButAudit,
    /// Labels that may be wrong: each.
    OfEach,
}

impl Room {
    /// That of a mission, by whether its belief weighs labels, how it asks for them, and whether it audits.
    pub fn of(weighs: bool, asking: &Asking, audits: bool) -> Self {
        match () {
            () if !weighs => Self::OfTrue,
            () if asking.is_apart() => Self::Apart,
            () if audits => Self::ButAudit,
            () => Self::OfEach,
        }
    }
}

impl File {
    /// Brings positions of a map to the lattice: the ground of the area, if it is from a map.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    fn on_map(&mut self, folder: &Path) -> Result<Option<Lake>> {
        let lake = self.area.0.lake(folder)?;
        let map = lake.as_ref();
        let StartTable { x, z, lat, lon, .. } = &mut self.start.0;
        on_map("start", map, [x, z], [*lat, *lon])?;
        for (k, Table(SampleTable { x, z, lat, lon, .. })) in self.oracle.iter_mut().enumerate() {
            on_map(&format!("oracle[{k}]"), map, [x, z], [*lat, *lon])?;
        }
        for (k, Table(KeepOutTable { x, z, lat, lon, .. })) in self.keep_out.iter_mut().enumerate()
        {
            on_map(&format!("keep_out[{k}]"), map, [x, z], [*lat, *lon])?;
        }
        Ok(lake)
    }

    /// What may be meant otherwise.
    ///
    /// # Errors
    /// Names the area if it cannot be in metres.
    fn doubts(
        &self,
        area: &MissionArea,
        (algorithm, vehicle): (Algorithm, &AnyVehicle),
    ) -> Result<Vec<String>> {
        let (start, errors) = (&self.start.0, &self.errors.0);
        let turn_step = self.vehicle.as_ref().and_then(|it| it.0.turn_step());
        let mut all = doubts::of_angles([
            ("start.heading", start.heading, std::f64::consts::TAU),
            ("errors.turn", errors.turn, 0.2),
            ("errors.heading", errors.heading, 0.2),
            ("vehicle.turn_step", turn_step.unwrap_or_default(), 0.5),
        ]);
        let points = self.oracle.iter().filter_map(|it| it.0.at()).collect::<Vec<_>>();
        all.extend(doubts::of_points(&points, vehicle));
        all.extend(self.doubted_slope(area));
        all.extend(doubts::of_area(area, vehicle)?);
        let front = self.front.as_ref().map(|it| it.0).unwrap_or_default();
        if front.radius.is_some_and(f64::is_finite) {
            all.push("front.radius: no effect: the planner learns how the front bends".to_owned());
        }
        let p = self.noise.as_ref().map_or(1.0, |it| it.0.mean());
        if p < 1.0 && algorithm.seeks_line() && !algorithm.weighs(true) {
            let name = algorithm.name();
            all.push(format!(
                "noise: {name} takes labels to be true, so a wrong one may cut the true line off; scc and lookahead \
                 weigh them"
            ));
        }
        Ok(all)
    }

    fn doubted_slope(&self, area: &MissionArea) -> Option<String> {
        let base = self.truth.as_ref().and_then(|it| it.0.base());
        doubts::of_slope(&(*area).into(), base?)
    }

    /// Given points, or why they are refused, with what may be wrong with the truth.
    fn doubting<T>(&self, area: &MissionArea, given: Result<T>) -> Result<T> {
        given.map_err(|error| match self.doubted_slope(area) {
            Some(doubt) => anyhow!("{error} ({doubt})"),
            None => error,
        })
    }

    /// The goal of a line, and whether a front is to be gone round.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    fn end(&self, algorithm: Algorithm) -> Result<(Option<Goal>, bool)> {
        let stop = self.stop.as_ref().map(|table| &table.0);
        Ok(if algorithm.seeks_line() {
            (stop.map(|it| it.goal(algorithm, self.noise.is_some())).transpose()?, false)
        } else {
            (None, stop.map_or(Ok(true), StopTable::until_closed)?)
        })
    }

    /// Whether an audit comes before a goal's promise.
    fn audits(&self) -> bool {
        self.stop.as_ref().is_some_and(|table| table.0.audits())
    }
}

/// The most labels of a mission, by whether its belief weighs labels: as many as there is room for beside the oracle's
/// samples.
///
/// # Errors
/// Names the oracle, the number of its points and the limit.
pub fn most_labels(oracle: usize, weighs: bool) -> Result<u32> {
    let room = CAPACITY.saturating_sub(oracle);
    if room == 0 {
        let expected = format!(
            "at most {}: a planner holds {CAPACITY} samples, and so many leave room for one step",
            CAPACITY - 1
        );
        return wrong("oracle", format!("{oracle} points"), expected);
    }
    Ok(if weighs { room as u32 } else { MOST })
}

/// Whether a mission may have this many steps.
///
/// # Errors
/// Names `field`, the number and the limit.
pub fn check_steps(field: &str, steps: u32, oracle: usize, labels: Room) -> Result<()> {
    let (most, why) = match labels {
        Room::OfTrue | Room::Apart => (MOST, String::new()),
        Room::ButAudit => (MOST_WITH_AUDIT, String::new()),
        Room::OfEach => {
            let why = format!(
                " where labels may be wrong (the planner holds {CAPACITY} samples, {oracle} of them the oracle's)"
            );
            (most_labels(oracle, true)?, why)
        }
    };
    if !(1..=most).contains(&steps) {
        return wrong(field, steps, format!("1 to {most}{why}"));
    }
    Ok(())
}

/// Whether a motion can have so many readings.
///
/// # Errors
/// Names `field`, the number and the limit.
pub fn check_readings(field: &str, readings: u32) -> Result<()> {
    checked(field, readings, (1..=MOST_READINGS).contains(&readings)).map(drop)
}

/// Whether a planner copes with a fan.
fn check_fan(algorithm: Algorithm, grid: FanName) -> Result<()> {
    if algorithm.copes_with(grid) {
        return Ok(());
    }
    let found = format!("\"fine\" with algorithm {}", algorithm.name());
    wrong("fan", found, "\"paper\", as it tries every action")
}

fn mission(file: &mut File, folder: &Path, overrides: Overrides<'_>) -> Result<Mission> {
    let steps = overrides.steps.unwrap_or(file.steps);
    check_readings("readings", file.readings)?;
    let algorithm = overrides.algorithm.unwrap_or(file.algorithm);
    let weight = file.varrho.map_or_else(|| Ok(algorithm.weight()), weight)?;
    let grid = file.fan.unwrap_or(algorithm.grid());
    check_fan(algorithm, grid)?;
    let has_fan = file.fan.is_some();
    let vehicle = file.vehicle.as_ref().map_or_else(
        || Ok(grid.into()),
        |it| it.0.vehicle(Source::File, algorithm, has_fan, grid),
    )?;
    let lake = file.on_map(folder)?.map(Arc::new);
    let area = terrain::area(&file.area.0, lake.as_deref(), &file.keep_out)?;
    let terrain = Terrain::new(area, lake.as_ref().map(|it| it.chart));
    let doubts = file.doubts(&area, (algorithm, &vehicle))?;
    match algorithm {
        Algorithm::Lawnmower => lawnmower::check_area(&terrain)?,
        Algorithm::Chords => chords::check_area(&terrain)?,
        _ => {}
    }
    let asked = file.ask.0.with(file.price, file.labels);
    let names = ["price", "labels", "ask.worth"];
    let noise = file.noise.as_ref().map(|table| noise(&table.0)).transpose()?;
    let (noise, p_told) = noise.map_or((None, None), |(noise, p_told)| (Some(noise), p_told));
    let trusts = check_trust(noise, &file.bounds.0)?;
    // Nobody knows what a label can carry if nobody knows how often it is true.
    let bits = noise.filter(|_| p_told.is_none()).map_or(1.0, |noise| limit(noise.p));
    let weighs = algorithm.weighs(file.noise.is_some());
    let bounds = file.bounds.0;
    let given_count = file.oracle.len() + bounds.len();
    let most = most_labels(given_count, weighs)?;
    let asking = Asking::of(names, asked, (algorithm, &area, &vehicle), (steps, most, bits))?;
    let steps_name = if overrides.steps.is_some() { "--steps" } else { "steps" };
    let room = Room::of(weighs, &asking, file.audits());
    check_steps(steps_name, steps, given_count, room)?;
    let world = file
        .truth
        .as_ref()
        .map_or(Ok(World::UNKNOWN), |it| it.0.world(&area, lake.as_deref(), folder))?;
    let reads = if algorithm.seeks_line() { given } else { given_of_front };
    let given = file.doubting(&area, reads(&file.oracle, &bounds, &terrain, &world))?;
    if algorithm == Algorithm::Chords {
        chords::ends(&given.samples()[..file.oracle.len()])?;
    }
    if trusts && algorithm.seeks_line() && given.lines().is_none() {
        let expected =
            "points of both labels, as labels are trusted around them, or trusted_radius = 0.0";
        return wrong("oracle", "no points of both labels", expected);
    }
    let (front, watch) = front::front(file.front.as_ref(), algorithm, (&vehicle, area.bounds()))?;
    let seeking = seeking::seeking(file.seek.as_ref())?;
    let first = file.oracle.first().map(|_| given.samples()[0].site);
    let is_on_globe = lake.as_ref().is_some_and(|it| it.frame.is_geographic());
    let start = start(&file.start.0, first, &terrain, is_on_globe)?;
    let errors = errors(&file.errors.0)?;
    let allowance = file.allow.0;
    allowance.check("allow.")?;
    let position = position("tolerance", file.tolerance, errors)?;
    let tolerance = allowance.tolerance("tolerance", position)?;
    let words = || allowance::sum(position, &allowance);
    let lines = given.lines().filter(|_| algorithm.seeks_line());
    check_tolerance("tolerance", tolerance, words, lines, &area)?;
    if matches!(p_told, Some(AnyReliability::Unknown(_))) {
        check_unknown("noise.p", tolerance, algorithm)?;
    }
    let following = file.following.map_or(algorithm.following(), Following::from);
    let config = Settings { area, weight, crossing: file.crossing.into(), following, tolerance };
    vehicle::check_room(Source::File, &vehicle, &config)?;
    let (goal, until_closed) = file.end(algorithm)?;
    let mission = Mission {
        lake,
        algorithm,
        steps,
        readings: file.readings,
        seed: overrides.seed.unwrap_or(file.seed),
        config,
        allowance,
        vehicle,
        start,
        world,
        given,
        bounds,
        read_before: Vec::new(),
        noise,
        p_told,
        errors,
        sensor: sensor::faults(file.sensor.iter().map(|table| &table.0))?,
        policy: file.policy.into(),
        prior: file.prior.into(),
        goal,
        audits: file.stop.as_ref().is_none_or(|table| table.0.audits()),
        asking,
        front,
        seeking,
        watch,
        until_closed,
        doubts,
    };
    mission.check_patch()?;
    Ok(mission)
}

/// Whether labels are trusted around what the oracle has seen. A bound was seen by nobody.
fn check_trust(noise: Option<NoiseModel>, bounds: &Bounds) -> Result<bool> {
    let trusts =
        noise.is_some_and(|it| !matches!(it.extent, Extent::OutsideBalls(radius) if radius <= 0.0));
    if trusts && !bounds.is_empty() {
        let expected = "none, as labels are trusted around given points: trusted_radius = 0.0";
        return wrong("bounds", "some with a trusted radius or a band", expected);
    }
    Ok(trusts)
}

fn weight(weight: f64) -> Result<EffortWeight> {
    EffortWeight::new(weight).or_else(|_| beyond("varrho", weight))
}

fn errors(table: &ErrorsTable) -> Result<Errors> {
    let &ErrorsTable { motion, turn, position, heading } = table;
    for (name, value) in [("motion", motion), ("position", position)] {
        deviation(&format!("errors.{name}"), value)?;
    }
    for (name, value) in [("turn", turn), ("heading", heading)] {
        if !(0.0..=1.0).contains(&value) {
            return no_angle(&format!("errors.{name}"), value);
        }
    }
    Ok(Errors { motion, turn, position, heading })
}

/// Whether this is a standard deviation of a place.
///
/// # Errors
/// Names `field` and the number.
pub fn deviation(field: &str, metres: f64) -> Result<f64> {
    checked(field, metres, (0.0..=100.0).contains(&metres))
}

/// The part of the planner's tolerance for positions, metres: as given, otherwise as much as covers the robot's errors.
///
/// # Errors
/// Names `field` and the number.
pub fn position(field: &str, metres: Option<f64>, errors: Errors) -> Result<f64> {
    let metres = metres.unwrap_or(CUT * errors.position);
    checked(field, metres, Tolerance::new(metres).is_ok())
}

/// Whether something is left to find out under a tolerance.
///
/// # Errors
/// Names `field`, the tolerance by `words`, and what it is too much for.
pub fn check_tolerance(
    field: &str,
    tolerance: Tolerance,
    words: impl Fn() -> String,
    given: Option<&Lines>,
    area: &MissionArea,
) -> Result<()> {
    let found = words;
    if !terrain::leaves_any(area, tolerance.metres()) {
        return wrong(field, found(), "less than half the breadth of the area");
    }
    let Some(given) = given else { return Ok(()) };
    let of = |label| {
        given
            .samples()
            .iter()
            .filter(move |s| s.label == label)
            .map(|s| Point2::<f64>::from(s.site))
    };
    let apart = of(Label::Negative)
        .flat_map(|n| of(Label::Positive).map(move |p| (p - n).norm()))
        .fold(0.0, f64::max);
    if tolerance.metres() >= apart || given.clone().with_tolerance(tolerance).is_err() {
        let expected = format!(
            "less than the oracle's points of different labels are apart, {apart:.3} m, and directions of the line \
             to within 88 degrees of their middle"
        );
        return wrong(field, found(), expected);
    }
    Ok(())
}

fn noise(table: &NoiseTable) -> Result<(NoiseModel, Option<AnyReliability>)> {
    let true_p = table.true_p.map(|p| probability("noise.true_p", p)).transpose()?;
    let (p, p_told) = match table.p {
        Told::Number(p) => {
            let p = told("noise.p", p)?;
            // It is what the planner believes, if the sensor does otherwise.
            let differs = true_p.is_some_and(|true_p| true_p.to_bits() != p.to_bits());
            let told = differs.then(|| Reliability::new(p)).transpose().map_err(Error::msg)?;
            (true_p.unwrap_or(p), told.map(AnyReliability::Known))
        }
        Told::Beta(parameters) => {
            let prior = p_prior("noise.p", parameters)?;
            (true_p.unwrap_or(prior.mean()), Some(AnyReliability::Unknown(prior)))
        }
    };
    let extent = match (table.trusted_radius, table.band) {
        (Some(_), Some(_)) => {
            return wrong("noise", "both trusted_radius and band", "one of them");
        }
        (None, Some(half)) if half >= 0.0 && half.is_finite() => Extent::Band(half),
        (None, Some(half)) => return beyond("noise.band", half),
        (radius, None) => {
            Extent::OutsideBalls(trusted("noise.trusted_radius", radius.unwrap_or(0.0))?)
        }
    };
    Ok((NoiseModel { p, extent }, p_told))
}

/// The prior of a reliability that nobody knows.
///
/// # Errors
/// Names `field` and the parameters.
pub fn p_prior(field: &str, [a, b]: [f64; 2]) -> Result<UnknownReliability> {
    UnknownReliability::beta(a, b).or_else(|_| {
        let expected = "the a and b of a Beta prior, from 0.5 to 1000 with a > b: its mean a / (a + b) is above one half";
        wrong(field, format!("[{a}, {b}]"), expected)
    })
}

/// Whether a planner can do with a reliability that nobody knows.
///
/// # Errors
/// Names `field`, and what it does not go with.
pub fn check_unknown(field: &str, tolerance: Tolerance, algorithm: Algorithm) -> Result<()> {
    if !algorithm.seeks_line() {
        return Ok(());
    }
    if tolerance != Tolerance::NONE {
        let found = format!("a prior, and a tolerance of {:.3} m", tolerance.metres());
        return wrong(field, found, "a number where positions err, or exact positions");
    }
    if !algorithm.weighs(true) {
        let found = format!("a prior with algorithm {}", algorithm.name());
        return wrong(field, found, "scc or lookahead: cfc takes labels to be true");
    }
    Ok(())
}

/// How often labels are true, as a planner is told it: more often than not. Of an inverted sensor the labels are swapped.
///
/// # Errors
/// Names `field` and the number.
pub fn told(field: &str, p: f64) -> Result<f64> {
    if Noise::new(p).is_err() {
        return wrong(field, p, expected("p").unwrap_or_default());
    }
    Ok(p)
}

/// Whether this is a probability.
///
/// # Errors
/// Names `field` and the number.
pub fn probability(field: &str, p: f64) -> Result<f64> {
    checked(field, p, Reliability::new(p).is_ok())
}

/// Whether this is a radius of trusted balls.
///
/// # Errors
/// Names `field` and the number.
pub fn trusted(field: &str, radius: f64) -> Result<f64> {
    checked(field, radius, Noise::radius(radius).is_some())
}

/// Where it starts: at the oracle's first point, unless the file says otherwise.
fn start(
    table: &StartTable,
    first: Option<Site>,
    area: &Terrain,
    is_on_globe: bool,
) -> Result<Pose> {
    let Ok(heading) = Heading::from_radians(table.heading) else {
        return beyond("start.heading", table.heading);
    };
    let first = first.map(Point2::<f64>::from);
    let place = |told: Option<f64>, first: Option<f64>| told.or(first);
    let (x, z) = (place(table.x, first.map(|it| it.x)), place(table.z, first.map(|it| it.y)));
    let (Some(x), Some(z)) = (x, z) else {
        let found = if is_on_globe { "no lat and lon" } else { "no x and z" };
        return wrong("start", found, "both, as the oracle gives no point to start at");
    };
    let site = site("start", x, z)?;
    terrain::check_inside("start", site, area)?;
    Ok(Pose { site, heading })
}

#[cfg(test)]
mod tests {
    use super::{Overrides, parse};

    fn told(front: &str) -> Result<Option<f64>, String> {
        let text = format!(
            "algorithm = \"track\"\nsteps = 5\narea = {{ x = [0, 40], z = [0, 30] }}\n\
             start = {{ x = 5, z = 5 }}\noracle = []\ntruth = {{ slope = 0, intercept = 15 }}\nfront = {front}\n"
        );
        parse("", &text, Overrides::default()).map(|it| it.watch).map_err(|it| format!("{it:#}"))
    }

    #[test]
    fn a_stretch_to_watch_is_shorter_than_the_area() {
        assert_eq!(told("{ radius = 40 }"), Ok(None));
        assert_eq!(told("{ radius = 40, watch = 30 }"), Ok(Some(30.0)));
        assert_eq!(told("{ watch = 50.0 }"), Ok(Some(50.0)));
        for watch in ["0", "-3", "nan", "inf", "50.1", "1e300"] {
            let why = told(&format!("{{ watch = {watch} }}")).expect_err(watch);
            assert!(why.contains("front.watch") && why.contains("0.1 to 50.0"), "{why}");
        }
    }
}
