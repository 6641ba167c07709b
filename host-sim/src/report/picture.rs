//! The content of a figure: plain data, made from a mission's results and the final knowledge.

use nalgebra::{Point2, Rotation2, Vector2};
use planner_core::lattice::{LIMIT, UNITS_PER_METRE};
use planner_core::link::message::MissionArea;
use planner_core::watch::Alarm;
use planner_core::{
    AnyVehicle, Area, Label, Line, PosteriorView, Reading, Sample, Site, Stage, Vector, estimate,
};
use serde::Serialize;

use crate::mission::definition::{Mission, Table};
use crate::mission::map::State;
use crate::mission::read_out::LEVEL;
use crate::mission::recording::Recording;
use crate::mission::results::StepResult;
use crate::report::ground::{CERTAIN, Ground, REFUTED};
use crate::report::look::{self, AGAINST, MISSING, Mark, REFUTES, SMALL_WRONG, UNREAD, WRONG};
use crate::report::pieces::Pieces;
use crate::report::style::{
    BOUND, CANDIDATES, ESTIMATE, FEWEST, FRONT, PAST_TRUTH, PRINTED, Stroke, TRUE_FRONT, TRUTH,
};
use crate::world::extent::around;
use crate::world::polygon::Polygon;
use crate::world::reading;
use crate::world::way::Way;

/// What a map shows: the one description that figures, pages and logs draw.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The title.
    pub title: String,
    /// What the legend says of the samples, if anything.
    pub note: String,
    /// The ground to show.
    pub area: MissionArea,
    /// The shores of a lake that motions stay in.
    pub(crate) shores: Vec<Way>,
    /// What is known of it.
    pub ground: Ground,
    /// What the legend says of ground that has a label, and of the white rest.
    pub says: [&'static str; 2],
    /// Where labels may be wrong, if that is to be seen.
    pub doubtful: Polygon,
    /// The samples, with the labels that were seen.
    pub samples: Vec<Dot>,
    /// How many of them were given, not taken on the way.
    pub given: usize,
    /// Where a mission began.
    pub start: Option<Point2<f64>>,
    /// The ends of its steps.
    pub stops: Vec<Stop>,
    /// The true boundary, where known.
    pub truth: Vec<Drawn>,
    /// Other lines, with their names.
    pub lines: Vec<Drawn>,
    /// Short words beside places.
    pub words: Vec<(String, Point2<f64>)>,
    /// Whether it is of a front, whether or not that was found.
    pub follows: bool,
    /// The map of a front, if one was followed.
    pub front: Pieces,
}

/// A sample.
#[derive(Clone, Copy, Debug)]
pub struct Dot {
    /// Where.
    pub at: Point2<f64>,
    /// How it is marked, by its label.
    pub(crate) mark: Mark,
    /// A ring about it, if it has one.
    pub(crate) ring: Option<Mark>,
}

impl Dot {
    /// A sample without a ring.
    pub(crate) fn new(at: impl Into<Point2<f64>>, mark: Mark) -> Self {
        Self { at: at.into(), mark, ring: None }
    }
}

/// The end of a step.
#[derive(Clone, Debug)]
pub struct Stop {
    /// Places on the way there, the last of them the end.
    pub way: Vec<Point2<f64>>,
    /// Where, by what the robot reports.
    pub at: Point2<f64>,
    /// Where it truly was, if it errs.
    pub truly: Option<Point2<f64>>,
    /// Radians.
    pub heading: f64,
    /// How it is marked, where no label is.
    pub(crate) mark: Option<Mark>,
}

/// A line or a boundary.
#[derive(Clone, Debug, Serialize)]
pub struct Drawn {
    /// What it is, for the legend.
    pub name: String,
    /// How it is drawn.
    pub(crate) stroke: Stroke,
    /// Its parts in the area.
    pub ways: Vec<Way>,
    /// A short word beside it, if any.
    #[serde(skip)]
    pub beside: Option<String>,
}

impl Drawn {
    /// Some ways.
    pub(crate) fn new(name: impl Into<String>, stroke: Stroke, ways: Vec<Way>) -> Self {
        Self { name: name.into(), stroke, ways, beside: None }
    }

    /// A straight line across an area.
    pub(crate) fn across(
        area: &MissionArea,
        line: impl Into<Line>,
        stroke: Stroke,
        name: impl Into<String>,
    ) -> Self {
        let chord = Polygon::from(*area).chord(&line.into());
        Self::new(name, stroke, chord.into_iter().map(Vec::from).collect())
    }

    /// The same with a short word beside it.
    pub(crate) fn beside(self, word: impl Into<String>) -> Self {
        Self { beside: Some(word.into()), ..self }
    }
}

/// The boundary of a mission's world. One that moves is drawn twice: at the start, and at the end after so many motions.
/// Without a number of motions the second has a name but no ways: each scene has them.
pub(crate) fn truth(mission: &Mission, motions: Option<usize>) -> Vec<Drawn> {
    let (world, area) = (&mission.world, &mission.config.area);
    let there = if mission.algorithm.seeks_line() { TRUTH } else { TRUE_FRONT };
    if let Some(line) = world.line() {
        return vec![Drawn::across(area, *line, there, "true line")];
    }
    if !world.is_known() {
        return Vec::new();
    }
    let what = if world.is_line() && world.moves() { "true line" } else { "true boundary" };
    let at = |motions, when, stroke| {
        let ways = world.after(motions).ways(&Polygon::from(*area));
        Drawn::new(format!("{what}{when}"), stroke, ways)
    };
    if !world.moves() {
        return vec![at(0, "", there)];
    }
    let now = || Drawn::new(format!("{what} at this step"), there, Vec::new());
    let second = motions.map_or_else(now, |motions| at(motions, " at the end", there));
    vec![at(0, " at the start", PAST_TRUTH), second]
}

impl Picture {
    /// The bare area.
    pub(crate) fn bare(title: &str, note: impl Into<String>, area: impl Into<MissionArea>) -> Self {
        Self {
            title: title.to_owned(),
            note: note.into(),
            area: area.into(),
            shores: Vec::new(),
            ground: Ground::Plain,
            says: CERTAIN,
            doubtful: Polygon(Vec::new()),
            samples: Vec::new(),
            given: 0,
            start: None,
            stops: Vec::new(),
            truth: Vec::new(),
            lines: Vec::new(),
            words: Vec::new(),
            follows: false,
            front: Pieces::default(),
        }
    }

    /// The same with another note.
    #[must_use]
    pub(crate) fn noting(self, note: &str) -> Self {
        Self { note: note.to_owned(), ..self }
    }

    /// A mission: what is certain, the path, the labels, the lines.
    pub fn of(title: &str, recording: &Recording) -> Self {
        let Recording { mission, results, belief, .. } = recording;
        let area = &mission.config.area;
        let mut lines = Vec::new();
        if let Some(centre) = belief.estimates().centre {
            let estimate = |name| Drawn::across(area, centre, ESTIMATE, name);
            let space = belief.version_space();
            lines.extend(space.map(|_| estimate("estimate: centre of the version space")));
            let table = belief.hypotheses();
            lines.extend(table.map(|_| estimate("estimate: posterior mean")));
        }
        lines.extend(belief.hypotheses().into_iter().flat_map(|table| bounding(table, area)));
        let diagnosis = results.end.diagnosis.as_deref();
        let fewest = diagnosis.and_then(|it| {
            let [a, b, c] = it.line.coefficients;
            Line::from_coefficients(a, b, c)
        });
        let name = "line that the fewest labels disagree with";
        lines.extend(fewest.map(|line| Drawn::across(area, line, FEWEST, name)));
        // What each step read.
        let steps = (1..).zip(recording.steps.iter().zip(&results.steps));
        let of_steps = steps.flat_map(|(number, (step, result))| {
            let end = step.reading.map(|reading| (step.pose.site, reading));
            result.passed().chain(end).map(move |it| (number, it))
        });
        let before = mission.read_before.iter().map(|it| (0, *it));
        let taken = before.chain(of_steps).filter_map(|(number, it)| Some((number, sample(it)?)));
        let taken: Vec<(usize, Sample)> = taken.collect();
        let mut ahead = &taken[..];
        let mut number = |s: &Sample| {
            let k = ahead.iter().position(|(_, it)| it == s)?;
            let number = ahead[k].0;
            ahead = &ahead[k + 1..];
            Some(number)
        };
        // Samples of bounds lie far outside of the picture. A belief in a front keeps none.
        let (oracle, first) = (mission.oracle(), mission.given.samples().len());
        let (follows, moves) = (belief.front().is_some(), mission.world.moves());
        let kept = belief.samples().iter().skip(first);
        // Of a boundary that stands still it does not matter which step it was.
        let read: Vec<_> = if follows {
            taken.clone()
        } else {
            kept.map(|s| (moves.then(|| number(s)).flatten().unwrap_or(0), *s)).collect()
        };
        let disagrees = |s: &Sample| {
            let is_above = |line: &Line| line.distance(s.site.into()) > 0.0;
            fewest.as_ref().is_some_and(|it| is_above(it) != (s.label == Label::Positive))
        };
        let dot = |s: &Sample, number, mark: fn(Label) -> Mark| {
            let is_wrong = !mission.world.after(number).agrees(s.site, s.label);
            let wrong = is_wrong.then_some(if follows { SMALL_WRONG } else { WRONG });
            let ring = wrong.or_else(|| disagrees(s).then_some(AGAINST));
            Dot { ring, ..Dot::new(s.site, mark(s.label)) }
        };
        let of_step = |(number, s): (usize, Sample)| {
            let step = number.checked_sub(1).and_then(|it| results.steps.get(it));
            let seeks = step.is_some_and(|it| it.problem.as_deref() == Some("seek"));
            let of_front = if seeks { look::sought } else { look::small };
            dot(&s, number, if follows { of_front } else { look::read })
        };
        // No belief takes in the labels of an audit.
        let audit = results.end.goal.and_then(|goal| goal.audit);
        let refuted = audit.filter(|it| !it.is_by_alarm).and_then(|it| it.refuted);
        let audited = (1..).zip(&recording.steps).filter_map(|(number, step)| {
            let is_of_audit = step.motion.stage == Some(Stage::Audit);
            let s = sample((step.pose.site, step.reading.filter(|_| is_of_audit)?))?;
            let dot = of_step((number, s));
            Some(if refuted == Some(number) { Dot { ring: Some(REFUTES), ..dot } } else { dot })
        });
        let given = oracle.iter().map(|s| dot(s, 0, look::given));
        let samples = given.chain(read.into_iter().map(of_step));
        Self {
            shores: mission
                .lake
                .iter()
                .flat_map(|it| it.polygons.iter().flatten().cloned())
                .collect(),
            ground: Ground::of(&**belief, *area),
            says: if audit.is_some_and(|it| it.refuted.is_some()) { REFUTED } else { CERTAIN },
            samples: samples.chain(audited).collect(),
            given: oracle.len(),
            start: Some(Point2::from(mission.start.site)),
            stops: stops(recording),
            truth: truth(mission, Some(recording.steps.len())),
            lines,
            follows,
            front: Pieces::of(results),
            ..Self::bare(title, note(recording), *area)
        }
    }

    /// A front without a mission, of the area around its samples and its map. Of very many vertices it shows some. `None`
    /// without an area.
    pub(crate) fn of_front(
        title: &str,
        note: String,
        samples: Vec<Dot>,
        front: Pieces,
    ) -> Option<Self> {
        let front = front.some();
        let places = samples.iter().map(|it| it.at).chain(front.ways().flatten());
        let area = area_of(places)?;
        Some(Self { samples, follows: true, front, ..Self::bare(title, note, area) })
    }

    /// The same with the paper's printed estimate, the bisector, before the recommended one. Of labels that may
    /// err the paper prints none.
    #[must_use]
    pub fn with_printed_estimate(mut self, recording: &Recording) -> Self {
        let belief = &recording.belief;
        let bisector = belief.version_space().and_then(|_| belief.estimates().bisector);
        let name = "estimate as printed: bisector";
        let printed = bisector.map(|line| Drawn::across(&self.area, line, PRINTED, name));
        self.lines.splice(0..0, printed);
        self
    }

    /// The lines that violate the fewest labels of a noisy mission, with their numbers of violations. The first is the
    /// one that a plain maximum margin would choose.
    pub fn of_candidates(title: &str, recording: &Recording) -> Option<Self> {
        let table = recording.belief.hypotheses()?;
        let taken = &table.samples()[table.given().len()..];
        let violations = |line: &Line| {
            taken.iter().filter(|s| reading(line, s.site) != Reading::Side(s.label)).count()
        };
        let mut candidates: Vec<_> = table
            .iter()
            .filter_map(|h| {
                let widest = Line::from(estimate::maximum_margin(table.lines(h))?);
                let margin =
                    table.samples().iter().map(|s| widest.distance(Point2::from(s.site)).abs());
                Some((violations(&widest), widest, margin.fold(f64::INFINITY, f64::min)))
            })
            .collect();
        candidates.sort_by(|a, b| a.0.cmp(&b.0).then(b.2.total_cmp(&a.2)));
        let all = Self::of(title, recording);
        let lines = candidates.into_iter().zip(CANDIDATES).map(|((n, line, _), stroke)| {
            let is_first = stroke == CANDIDATES[0];
            let what = if is_first { "plain maximum margin" } else { "another candidate" };
            let name = format!("{what}; violations: {n}");
            Drawn::across(&all.area, line, stroke, name).beside(n.to_string())
        });
        let lines = lines.collect();
        let all = Self { ground: Ground::Plain, start: None, stops: Vec::new(), lines, ..all };
        Some(all.noting("Lines that the fewest labels contradict, and beside each how many do"))
    }

    /// The mean front of its map.
    pub(crate) fn mapped(&self) -> Drawn {
        let moves = self.truth.iter().any(|it| it.stroke == PAST_TRUTH);
        let mapped = if moves { "as it was when it was mapped" } else { "as it is mapped" };
        Drawn::new(format!("the front {mapped}"), FRONT, self.front.ways().collect())
    }

    /// Places of the track and of the map, which may lie outside the area.
    pub(crate) fn places(&self) -> Vec<Point2<f64>> {
        let of_path = self.stops.iter().flat_map(|stop| stop.way.iter().copied().chain(stop.truly));
        let of_front = self.front.ground().flatten().flatten();
        let of_samples = self.samples.iter().map(|dot| dot.at);
        self.start.into_iter().chain(of_path).chain(of_samples).chain(of_front).collect()
    }
}

/// The ends of the steps.
fn stops(Recording { mission, results, .. }: &Recording) -> Vec<Stop> {
    let mut from = Point2::from(mission.start.site);
    let stop = |step: &StepResult| {
        let stop = Stop::of(mission, from, step);
        from = stop.at;
        stop
    };
    results.steps.iter().map(stop).collect()
}

impl Stop {
    /// The end of a step that began at a place.
    pub(crate) fn of(mission: &Mission, from: Point2<f64>, step: &StepResult) -> Self {
        let at = Point2::new(step.pose.x, step.pose.z);
        let is_car = matches!(mission.vehicle, AnyVehicle::Car(_));
        Self {
            way: arc(from, at, if is_car { step.action.w.into() } else { 0.0 }),
            at,
            truly: step.true_pose.map(|pose| Point2::new(pose.x, pose.z)),
            heading: step.pose.heading,
            mark: match (step.label, step.expected) {
                (None, Some(_)) => Some(MISSING),
                (None | Some(0), _) => Some(UNREAD).filter(|_| mission.algorithm.seeks_line()),
                _ => None,
            },
        }
    }
}

/// A reading as a sample, if it is of one side.
fn sample((site, reading): (Site, Reading)) -> Option<Sample> {
    if let Reading::Side(label) = reading { Some(Sample { site, label }) } else { None }
}

/// The caption of a mission's figure, in one line.
fn note(Recording { mission, results, .. }: &Recording) -> String {
    let labels = if mission.noise.is_some() { ", labels may be wrong" } else { "" };
    let (steps, planner) = (results.steps.len(), mission.algorithm.title());
    let plural = if steps == 1 { "" } else { "s" };
    let is_refuted =
        results.end.goal.is_some_and(|goal| goal.audit.is_some_and(|it| it.refuted.is_some()));
    let ending = match &results.end.alarm {
        _ if is_refuted => "; no straight line fits",
        Some(alarm) if alarm.evidence >= Alarm::ALARM => "; labels raise an alarm",
        Some(_) => "; labels raise a warning",
        None => "",
    };
    if let Some(map) = &results.end.front {
        let what = match map.state {
            State::Followed => "follows a front",
            State::Closed => "has gone round a closed front",
            State::Lost => "has lost a front",
            State::Sought => "looks for a front",
        };
        return format!("A robot {what}{labels}: {steps} step{plural}, {:.0} m mapped", map.metres);
    }
    format!(
        "A robot looks for the straight boundary of +1 and -1{labels}: {planner}, {steps} step{plural}{ending}"
    )
}

/// Places along the arc from one place to another, with this turn. A straight way has its end alone.
fn arc(from: Point2<f64>, to: Point2<f64>, turn: f64) -> Vec<Point2<f64>> {
    const PARTS: u32 = 12;
    if turn == 0.0 {
        return vec![to];
    }
    let place = |part: u32| {
        let half = turn / 2.0 * f64::from(part) / f64::from(PARTS);
        let share = libm::sin(half) / libm::sin(turn / 2.0);
        from + Rotation2::new(half - turn / 2.0) * (to - from) * share
    };
    (1..PARTS).map(place).chain([to]).collect()
}

/// The lines at the two ends of a credible set's slopes: the paper's `l1` and `l2`.
fn bounding(table: &Table, area: &MissionArea) -> Vec<Drawn> {
    let posterior = PosteriorView::new(table);
    let set = posterior.credible(LEVEL);
    let bounds = || posterior.members(&set).flat_map(|h| table.lines(h).bounds());
    let ends = [("l1", set.slope_arc.from()), ("l2", set.slope_arc.to())];
    let named = |(name, end): (&str, Vector)| {
        let bound = bounds().find(|bound| bound.along.cross(end) == 0)?;
        let meaning = "l1 and l2, which bound the credible slopes";
        Some(Drawn::across(area, bound, BOUND, meaning).beside(name))
    };
    ends.into_iter().filter_map(named).collect()
}

/// The smallest area that shows all samples with a margin, for samples without a mission. Where the lattice
/// ends there is no margin.
pub fn area_around(samples: &[Sample]) -> Option<Area> {
    area_of(samples.iter().map(|s| s.site.into()))
}

/// The same of any places.
fn area_of(places: impl Iterator<Item = Point2<f64>>) -> Option<Area> {
    const END: f64 = (LIMIT - 1) as f64 / UNITS_PER_METRE as f64;
    let [min, max] = around(places)?;
    let margin = Vector2::repeat(0.1 * (max - min).amax());
    let corner = |at: Point2<f64>| Site::try_from(at.map(|m| m.clamp(-END, END))).ok();
    Area::new(corner(min - margin)?, corner(max + margin)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::standard_field;
    use crate::mission::algorithm::Algorithm;

    #[test]
    fn certain_ground_is_on_one_side_of_every_bound() {
        for number in 0..300 {
            let mission = standard_field::standard(9, number, Algorithm::Cfc, 12);
            let recording = Recording::of(&mission).unwrap();
            let Some(space) = recording.belief.version_space() else { continue };
            let support: Vec<_> = space.support().collect();
            let area = mission.config.area;
            for label in [Label::Positive, Label::Negative] {
                let side = f64::from(label.sign());
                let clipped = space.bounds().fold(Polygon::from(area), |ground, bound| {
                    ground.clip(&Line::from(bound), side)
                });
                let certain = Polygon::certain(area, &support, label);
                // Either may begin at another corner, and have one twice by rounding.
                for (one, other) in [(&certain, &clipped), (&clipped, &certain)] {
                    let near = |p: &Point2<f64>| other.0.iter().any(|q| (p - q).norm() < 1e-6);
                    assert!(one.0.iter().all(near), "field {number}: {certain:?} for {clipped:?}");
                }
                let share = certain.area() / clipped.area();
                assert!((share - 1.0).abs() < 1e-9, "field {number}: {share}");
            }
        }
    }
}
