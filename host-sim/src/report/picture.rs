//! The content of a figure: plain data, made from a mission's results and the final knowledge.

use nalgebra::{Point2, Rotation2, Vector2};
use planner_core::belief::estimate;
use planner_core::belief::evidence::Alarm;
use planner_core::geometry::lattice::{LIMIT, UNITS_PER_METRE, Vector};
use planner_core::link::message::MissionArea;
use planner_core::{
    AnyVehicle, Area, Label, Line, LocalLine, PosteriorView, Reading, Sample, Site, Stage,
};

use crate::mission::definition::{Mission, Table};
use crate::mission::map::State;
use crate::mission::read_out::LEVEL;
use crate::mission::recording::Recording;
use crate::mission::results::StepResult;
pub use crate::report::ground::Ground;
use crate::report::ribbon::Ribbon;
use crate::world::extent::around;
use crate::world::polygon::Polygon;
use crate::world::reading;
use crate::world::way::Way;

/// What to draw.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The title.
    pub title: String,
    /// What the legend says of the samples, if anything.
    pub note: Option<String>,
    /// The ground to show.
    pub area: MissionArea,
    /// What is known of it.
    pub ground: Ground,
    /// Whether a label contradicts that.
    pub is_refuted: bool,
    /// The samples, with the labels that were seen.
    pub samples: Vec<Dot>,
    /// How many of them were given, not taken on the way.
    pub given: usize,
    /// Where a mission began, and the ends of its steps.
    pub path: Option<(Point2<f64>, Vec<Stop>)>,
    /// The true boundary, where known.
    pub truth: Option<Truth>,
    /// Other lines, with their names.
    pub lines: Vec<Named>,
    /// Whether it is of a front, whether or not that was found.
    pub follows: bool,
    /// The map of a front, if one was followed.
    pub front: Ribbon,
}

/// A sample.
#[derive(Clone, Copy, Debug)]
pub struct Dot {
    /// Where.
    pub at: Point2<f64>,
    /// The label that was seen.
    pub label: Label,
    /// Why it has a ring, if it has one.
    pub ring: Option<Ring>,
    /// Whether it was read where a front was sought.
    pub sought: bool,
}

/// What a ring about a sample says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ring {
    /// The label is known to be false.
    Wrong,
    /// The label disagrees with the line. The truth is not known.
    Disagrees,
    /// The label disagrees with the line that the fewest do.
    Against,
    /// No line left has this label here.
    Refutes,
}

/// The true boundary.
#[derive(Clone, Debug)]
pub enum Truth {
    /// A line that stays where it is.
    Line(Line),
    /// Any other.
    Drawn(Vec<Outline>),
}

/// A boundary at some time.
#[derive(Clone, Debug)]
pub struct Outline {
    /// What it is, for the legend.
    pub name: &'static str,
    /// Whether it is no longer there in the end.
    pub is_past: bool,
    /// Its parts in the area.
    pub ways: Vec<Way>,
}

impl Truth {
    /// The boundary of a mission's world: a line that moves at the start and after so many motions.
    fn of(mission: &Mission, motions: usize) -> Option<Self> {
        let world = &mission.world;
        if let Some(line) = world.line() {
            return Some(Self::Line(*line));
        }
        let area = Polygon::from(mission.config.area);
        let at = |motions, name, is_past| {
            let ways = world.after(motions).ways(&area);
            Outline { name, is_past, ways }
        };
        let outlines = if world.moves() {
            let names = if world.is_line() {
                ["true line at the start", "true line at the end"]
            } else {
                ["true boundary at the start", "true boundary at the end"]
            };
            vec![at(0, names[0], true), at(motions, names[1], false)]
        } else {
            vec![at(0, "true boundary", false)]
        };
        world.is_known().then_some(Self::Drawn(outlines))
    }

    /// The line, if it is one that stays where it is.
    pub const fn line(&self) -> Option<Line> {
        match self {
            Self::Line(line) => Some(*line),
            Self::Drawn(_) => None,
        }
    }

    /// What else is drawn.
    pub fn outlines(&self) -> &[Outline] {
        match self {
            Self::Line(_) => &[],
            Self::Drawn(outlines) => outlines,
        }
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
    /// Whether a side of the boundary was sensed there.
    pub sensed: bool,
    /// Whether a label was asked for there, and the sensor read nothing.
    pub lacks_reading: bool,
}

/// A line with a name for the legend.
#[derive(Clone, Debug)]
pub struct Named {
    /// The name.
    pub name: String,
    /// The line.
    pub line: Line,
    /// What it is.
    pub kind: Kind,
    /// A short word beside it, if any.
    pub beside: Option<String>,
}

/// The kind of a line, for its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The estimate that is recommended.
    Estimate,
    /// The paper's printed estimate.
    Printed,
    /// An end of the credible slopes.
    Bound,
    /// The plain maximum margin.
    MaximumMargin,
    /// The second-best candidate.
    SecondBest,
    /// The third-best candidate.
    ThirdBest,
    /// The line that the fewest labels disagree with, if no line explains them all.
    Fewest,
}

impl Named {
    /// The estimate that is recommended.
    pub fn estimate(name: &str, line: Option<LocalLine>) -> Option<Self> {
        let (name, kind) = (format!("estimate: {name}"), Kind::Estimate);
        Some(Self { name, line: line?.into(), kind, beside: None })
    }
}

impl Picture {
    /// A mission: what is certain, the path, the labels, the lines.
    pub fn of(title: &str, recording: &Recording) -> Self {
        let Recording { mission, results, belief, .. } = recording;
        let area = mission.config.area;
        let centre = belief.estimates().centre;
        let mut lines = Vec::new();
        if belief.version_space().is_some() {
            lines.extend(Named::estimate("centre of the version space", centre));
        }
        if let Some(table) = belief.hypotheses() {
            lines.extend(Named::estimate("posterior mean", centre));
            lines.extend(bounding(table));
        }
        let diagnosis = results.end.diagnosis.as_deref();
        let fewest = diagnosis.and_then(|it| as_line(it.line.coefficients));
        lines.extend(fewest.map(|line| Named {
            name: "line that the fewest labels disagree with".to_owned(),
            line,
            kind: Kind::Fewest,
            beside: None,
        }));
        // The number of the step that took a sample; given ones were true at the start.
        let steps = (1..).zip(recording.steps.iter().zip(&results.steps));
        let taken: Vec<_> = steps
            .flat_map(|(number, (step, result))| {
                let end = step.reading.map(|reading| (step.pose.site, reading));
                result.passed().chain(end).map(move |label| (number, label))
            })
            .collect();
        let mut next = taken.iter();
        let number = |s: &Sample| {
            let mut ahead = next.clone();
            let found = ahead.find(|(_, label)| *label == (s.site, s.label.into()));
            found.map_or(0, |(number, _)| {
                next = ahead;
                *number
            })
        };
        // Those of bounds lie far outside of the picture.
        let (given, first) = (mission.oracle().len(), mission.given.samples().len());
        let heard: Vec<_>; // a belief in a front keeps no samples
        let follows = belief.front().is_some();
        let (oracle, read) = if follows {
            heard = taken.iter().filter_map(|(_, label)| sample(*label)).collect();
            (&mission.given.samples()[..given], &heard[..])
        } else {
            (&belief.samples()[..given], &belief.samples()[first..])
        };
        let samples = oracle.iter().chain(read);
        let numbers: Vec<usize> = if follows || mission.world.moves() {
            let of_steps = samples.clone().skip(given).map(number);
            std::iter::repeat_n(0, given).chain(of_steps).collect()
        } else {
            vec![0; given + read.len()]
        };
        let disagrees = |s: &Sample| {
            let is_above = |line: &Line| line.distance(s.site.into()) > 0.0;
            fewest.as_ref().is_some_and(|it| is_above(it) != (s.label == Label::Positive))
        };
        let dot = |(s, number): (&Sample, usize)| {
            let is_wrong = !mission.world.after(number).agrees(s.site, s.label);
            let wrong = is_wrong.then_some(Ring::Wrong);
            let ring = wrong.or_else(|| disagrees(s).then_some(Ring::Against));
            let step = number.checked_sub(1).and_then(|it| results.steps.get(it));
            let seeks = step.is_some_and(|it| it.problem.as_deref() == Some("seek"));
            Dot { at: s.site.into(), label: s.label, ring, sought: follows && seeks }
        };
        // No belief takes in the labels of an audit.
        let audit = results.end.goal.and_then(|goal| goal.audit);
        let refuted = audit.filter(|it| !it.is_by_alarm).and_then(|it| it.refuted);
        let audited = (1..).zip(&recording.steps).filter_map(|(number, step)| {
            let is_of_audit = step.motion.stage == Some(Stage::Audit);
            let Some(Reading::Side(label)) = step.reading.filter(|_| is_of_audit) else {
                return None;
            };
            let site = step.pose.site;
            let dot = dot((&Sample { site, label }, number));
            let refutes = (refuted == Some(number)).then_some(Ring::Refutes);
            Some(Dot { ring: refutes.or(dot.ring), ..dot })
        });
        Self {
            title: title.to_owned(),
            note: Some(note(recording)),
            area,
            ground: Ground::of(&**belief, area),
            is_refuted: audit.is_some_and(|it| it.refuted.is_some()),
            samples: samples.zip(numbers).map(dot).chain(audited).collect(),
            given,
            path: Some((Point2::from(mission.start.site), stops(recording))),
            truth: Truth::of(mission, recording.steps.len()),
            lines,
            follows,
            front: Ribbon::of(results),
        }
    }

    /// The same with the paper's printed estimate, the bisector, before the recommended one. Of labels that may
    /// err the paper prints none.
    #[must_use]
    pub fn with_printed_estimate(mut self, recording: &Recording) -> Self {
        let belief = &recording.belief;
        let bisector = belief.version_space().and_then(|_| belief.estimates().bisector);
        let named = bisector.map(|line| Named {
            name: "estimate as printed: bisector".to_owned(),
            line: line.into(),
            kind: Kind::Printed,
            beside: None,
        });
        self.lines.splice(0..0, named);
        self
    }

    /// The lines that violate the fewest labels of a noisy mission, with their numbers of violations. The first is the
    /// one that a plain maximum margin would choose.
    pub fn of_candidates(title: &str, recording: &Recording) -> Option<Self> {
        const KINDS: [Kind; 3] = [Kind::MaximumMargin, Kind::SecondBest, Kind::ThirdBest];
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
        let lines = candidates.into_iter().zip(KINDS).map(|((n, line, _), kind)| Named {
            name: match kind {
                Kind::MaximumMargin => format!("plain maximum margin; violations: {n}"),
                _ => format!("another candidate; violations: {n}"),
            },
            line,
            kind,
            beside: Some(format!("{n}")),
        });
        let lines = lines.collect();
        let note =
            "Lines that the fewest labels contradict, and beside each how many do".to_owned();
        let all = Self::of(title, recording);
        Some(Self { note: Some(note), ground: Ground::Plain, path: None, lines, ..all })
    }
}

/// The ends of the steps.
fn stops(Recording { mission, results, .. }: &Recording) -> Vec<Stop> {
    let mut from = Point2::from(mission.start.site);
    let stop = |step: &StepResult| Stop {
        way: {
            let to = Point2::new(step.pose.x, step.pose.z);
            let is_car = matches!(mission.vehicle, AnyVehicle::Car(_));
            let turn = if is_car { step.action.w.into() } else { 0.0 };
            arc(std::mem::replace(&mut from, to), to, turn)
        },
        at: Point2::new(step.pose.x, step.pose.z),
        truly: step.true_pose.map(|pose| Point2::new(pose.x, pose.z)),
        heading: step.pose.heading,
        sensed: step.label.is_some_and(|label| label != 0),
        lacks_reading: step.label.is_none() && step.expected.is_some(),
    };
    results.steps.iter().map(stop).collect()
}

fn as_line([a, b, c]: [f64; 3]) -> Option<Line> {
    Line::from_coefficients(a, b, c)
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
fn bounding(table: &Table) -> Vec<Named> {
    let posterior = PosteriorView::new(table);
    let set = posterior.credible(LEVEL);
    let bounds = || posterior.members(&set).flat_map(|h| table.lines(h).bounds());
    let ends = [("l1", set.slope_arc.from()), ("l2", set.slope_arc.to())];
    let named = |(name, end): (&str, Vector)| {
        let bound = bounds().find(|bound| bound.along.cross(end) == 0)?;
        Some(Named {
            name: "l1 and l2, which bound the credible slopes".to_owned(),
            line: bound.into(),
            kind: Kind::Bound,
            beside: Some(name.to_owned()),
        })
    };
    ends.into_iter().filter_map(named).collect()
}

/// The smallest area that shows all samples with a margin, for samples without a mission. Where the lattice
/// ends there is no margin.
pub fn area_around(samples: &[Sample]) -> Option<Area> {
    area_of(samples.iter().map(|s| s.site.into()))
}

/// The same of any places.
pub(crate) fn area_of(places: impl Iterator<Item = Point2<f64>>) -> Option<Area> {
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
