//! A mission's results: plain data, recorded once. Serialised, they are the records of the trace, whose contract is in
//! docs/reference/trace.md, with the comments of these fields; the same types read a trace again. Fields that only reports use
//! are not serialised.
//!
//! A new field of a step is added here and in [`Recorder::take`](crate::mission::recording::Recorder::take). Flat rows
//! and the log take it over from the trace.

use std::borrow::Cow;

use nalgebra::Point2;
use planner_core::dynamics::Control;
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::link::message::MissionArea;
use planner_core::watch::Suspect;
use planner_core::{
    AnyReliability, Estimates, KeepOut, Label, Line, LocalLine, Motion, Pose, Reading, Recovery,
    Sample, Site, Stage, StopReason, Workspace as _,
};
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

use crate::mission::algorithm::Algorithm;
use crate::mission::allowance::ToleranceRecord;
use crate::mission::bounds::Bounds;
use crate::mission::diagnosis::DiagnosisRecord;
use crate::mission::from_nothing::SeekRecord;
use crate::mission::front::{FrontTable, PassedRecord, VertexRecord};
use crate::mission::legs::{Leg, Legs};
pub use crate::mission::line_record::{LineError, LineRecord};
use crate::mission::map::{MapRecord, Mapped};
use crate::mission::read_out::Expectation;
use crate::mission::seeking::SeekTable;
use crate::mission::sensor::FaultTable;
use crate::mission::stop::GoalRecord;
use crate::mission::vehicle::VehicleTable;
use crate::world::boundary::BoundaryRecord;
use crate::world::survey::Fit;

/// The results of a mission: its start, its steps and its end.
#[derive(Clone, Debug)]
pub struct Results {
    /// What it began with.
    pub start: Start,
    /// What happened.
    pub steps: Vec<StepResult>,
    /// How it ended.
    pub end: End,
}

impl Results {
    /// What the map has of the mission's steps.
    pub fn mapped(&self) -> Vec<Mapped> {
        mapped(&self.steps, &self.end.mapped)
    }
}

/// What the map has of a mission's steps, and of the places at its end. Where nobody has said what the map has, that is where
/// the front was beside the robot.
pub fn mapped(steps: &[StepResult], rest: &[PassedRecord]) -> Vec<Mapped> {
    let follows = !rest.is_empty() || steps.iter().any(|it| !it.mapped.is_empty());
    let of_step = |it: &StepResult| Mapped {
        number: it.step,
        metres: it.metres,
        is_known: it.front.is_some(),
        vertices: if follows {
            it.mapped.clone()
        } else {
            let here = |vertex| PassedRecord { passed: it.step, begins: false, vertex };
            it.front.map(here).into_iter().collect()
        },
    };
    let mut steps: Vec<_> = steps.iter().map(of_step).collect();
    if let Some(last) = steps.last_mut() {
        last.vertices.extend(rest);
    }
    steps
}

/// The version of the trace, which its start says. Fields that are added do not change it.
pub const VERSION: u32 = 1;

/// What a mission began with.
#[skip_serializing_none]
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Start {
    /// The version of the trace: 1.
    #[serde(default)]
    pub version: u32,
    /// Who planned, as in a scenario file.
    #[serde(default)]
    pub algorithm: Algorithm,
    /// Seed of whatever was random.
    #[serde(default)]
    pub seed: u64,
    /// The weight of the control.
    #[serde(default)]
    pub varrho: f64,
    /// Where positions stayed: `x` and `z`, each from and to, and `polygon` if it is one: its corners, counter-clockwise.
    #[serde(default)]
    pub area: AreaRecord,
    /// What no motion touches: all within a `radius` of a `polygon`, or of a point.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keep_out: Vec<KeepOutRecord>,
    /// The oracle's samples.
    pub oracle: Vec<SampleRecord>,
    /// What an operator or another robot read before the first step. It may be wrong as any label of the mission.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub samples: Vec<SampleRecord>,
    /// What is known of the line beside them, as in a scenario file.
    pub bounds: Option<Bounds>,
    /// What moved, with all keys of its kind in a scenario file, unless it is the unicycle of a fan.
    pub vehicle: Option<VehicleTable>,
    /// The tolerance and its parts, if it allows for more than positions that err.
    pub tolerance: Option<ToleranceRecord>,
    /// Where the agent began.
    #[serde(default)]
    pub pose: PoseRecord,
    /// The true line, if there is one that stays where it is.
    #[serialize_always]
    pub truth: Option<LineRecord>,
    /// The true boundary, if it is no fixed line: the keys of `truth` in a scenario file, and a base or moving line as `line`.
    pub boundary: Option<BoundaryRecord>,
    /// How the sensor fails, as in a scenario file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensor: Vec<FaultTable>,
    /// Labels are true with this probability.
    pub p: f64,
    /// What planners are told instead: a number, or `[a, b]` of a prior.
    pub p_told: Option<PTold>,
    /// What a label costs, metres driven, if labels are sought beyond one motion.
    pub price: Option<f64>,
    /// Labels at most, if they are limited by themselves.
    pub labels: Option<u32>,
    /// Bits that a label must be expected to carry.
    pub worth: Option<f64>,
    /// What is told of the front, if one is followed, as in a scenario file.
    pub front: Option<FrontTable>,
    /// What is told of a boundary that is sought, if it is not the usual, as in a scenario file.
    pub seek: Option<SeekTable>,
    /// Readings a motion, if there are several.
    pub readings: Option<u32>,
    /// Whether they may err.
    #[serde(skip)]
    pub labels_err: bool,
    /// Steps at most.
    #[serde(skip)]
    pub steps: u32,
    /// The slopes that the oracle's samples leave, as intervals of degrees.
    #[serde(skip)]
    pub slope_arcs: Vec<[f64; 2]>,
}

/// A step: what was done, what was expected of it, what was read, and what was known after it.
#[skip_serializing_none]
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StepResult {
    /// Its number, from 1.
    #[serde(default)]
    pub step: usize,
    /// What the motion is for: the paper's `P1` to `P4`, or `audit`, `seek`, `follow`, `pass` (a keep-out on the front), `return`;
    /// `None` of planners that pose no problem.
    #[serialize_always]
    pub problem: Option<Name>,
    /// The rung of the recovery ladder: `undirected`, `reorient`, `transit`; `None` if it was not climbed.
    #[serialize_always]
    pub recovery: Option<Name>,
    /// What was done: its `index` in the grid, `v`, the length of the motion in metres, and `w`, the turn in radians.
    #[serde(default)]
    pub action: ActionRecord,
    /// Where it ended, as the robot reports it.
    pub pose: PoseRecord,
    /// Where the motion should have ended, if it ended elsewhere.
    pub target: Option<PoseRecord>,
    /// Where the robot truly was, if it errs.
    pub true_pose: Option<PoseRecord>,
    /// What was sensed there: -1, 0 on the boundary, 1; `None` if nothing was.
    #[serialize_always]
    pub label: Option<i8>,
    /// All readings of the motion in order, its label at the end included, where there are readings on the way.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub readings: Vec<ReadingRecord>,
    /// The slopes left, as intervals of degrees: two across the vertical. Of labels that may be wrong those of the 90 % credible
    /// set, of a front its directions within 90 %.
    #[serde(default)]
    pub slope_arcs: Vec<[f64; 2]>,
    /// The intercepts left, metres; `None` when unbounded.
    #[serialize_always]
    pub intercept: Option<[f64; 2]>,
    /// Bits learnt since the start. Of labels that may be wrong, the divergence of the posterior from the uniform distribution;
    /// of a front, what is known now.
    #[serde(default)]
    pub bits: f64,
    /// Actions whose position was looked at to find this one.
    #[serde(default)]
    pub examined: u32,
    /// `false` if the plan used up its looks, and so took the best action so far.
    pub proven: Option<bool>,
    /// Where the front is known best beside the robot, if one is followed and found.
    pub front: Option<VertexRecord>,
    /// Places that the map has more, if a front is followed. Labels change them no more. Each has the keys of `front` too.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mapped: Vec<PassedRecord>,
    /// Where labels may err: whether the sample lies in a trusted ball.
    pub trusted: Option<bool>,
    /// Where labels may err: the number of hypotheses.
    pub hypotheses: Option<usize>,
    /// Where labels may err: the probability given up as the table was full, at most.
    pub pruned_mass: Option<f64>,
    /// Where labels may err: the entropy over the hypotheses, bits.
    pub entropy: Option<f64>,
    /// The evidence against a straight, still line, from a warning on (20).
    pub evidence: Option<f32>,
    /// How a real vehicle made it.
    pub flown: Option<Leg>,
    /// What a perfect sensor reads there, if the true line is known.
    #[serde(skip)]
    pub fact: Option<i8>,
    /// What was expected of its label before it was read, if one was asked for.
    #[serde(skip)]
    pub expected: Option<Expectation>,
    /// Control cost up to and with this step.
    #[serde(skip)]
    pub control_cost: f64,
    /// Metres travelled up to and with this step.
    #[serde(skip)]
    pub metres: f64,
}

/// A name that the trace gives: ours, or one that was read.
pub type Name = Cow<'static, str>;

/// How a mission ended, and what was known then.
#[skip_serializing_none]
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct End {
    /// Why it ended, see below.
    pub reason: Name,
    /// As of a step: the places that the robot passed last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mapped: Vec<PassedRecord>,
    /// The estimates of the line, each null where there is none.
    pub estimates: EstimateRecords,
    /// The straight line that misclassifies least, where the true boundary is no fixed line.
    pub fit: Option<Box<FitRecord>>,
    /// Where labels may err: the paper's outcome, by the paper's prior.
    pub best: Option<BestRecord>,
    /// Where labels may err: the credible set, by the chosen prior.
    pub credible: Option<CredibleRecord>,
    /// What labels have shown of a reliability that nobody knows.
    pub reliability: Option<ReliabilityRecord>,
    /// The map of the front, if one was followed.
    pub front: Option<MapRecord>,
    /// What seeking the boundary came to, if the mission began from nothing.
    pub seek: Option<SeekRecord>,
    /// Its goal, if it had one.
    pub goal: Option<GoalRecord>,
    /// The most that spoke against a straight, still line, from a warning on.
    pub alarm: Option<AlarmRecord>,
    /// What explains the labels, if something speaks against a straight, still line.
    pub diagnosis: Option<Box<DiagnosisRecord>>,
    /// How near to its targets a real vehicle came.
    pub flown: Option<Legs>,
}

/// How often labels are true, as planners are told: a number, or the parameters of a Beta prior.
///
/// It is read from a value, as an untagged enum cannot read a number where a program has `serde_json` keep all digits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, try_from = "serde_json::Value")]
pub enum PTold {
    /// They are told this.
    Number(f64),
    /// Nobody knows; this is the prior.
    Beta([f64; 2]),
}

impl TryFrom<serde_json::Value> for PTold {
    type Error = &'static str;

    fn try_from(told: serde_json::Value) -> Result<Self, Self::Error> {
        let beta = || match told.as_array()?.as_slice() {
            [a, b] => Some(Self::Beta([a.as_f64()?, b.as_f64()?])),
            _ => None,
        };
        let number = told.as_f64().map(Self::Number);
        number.or_else(beta).ok_or("expected a probability, or the [a, b] of a Beta prior")
    }
}

impl From<AnyReliability> for PTold {
    fn from(told: AnyReliability) -> Self {
        match told {
            AnyReliability::Known(reliability) => {
                // Its logarithm of the odds is kept to 10^-10.
                Self::Number((reliability.probability() * 1e9).round() / 1e9)
            }
            AnyReliability::Unknown(prior) => Self::Beta(prior.parameters()),
        }
    }
}

/// What is known of a reliability in the end.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct ReliabilityRecord {
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// What speaks against a straight, still line and a sensor as described.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct AlarmRecord {
    /// The step after which it was the most.
    pub step: usize,
    /// The e-value then.
    pub evidence: f32,
    /// What explains the labels best: `coin`, `inverted`, `stuck`.
    pub suspect: Suspect,
}

/// The most likely hypothesis.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct BestRecord {
    /// The slopes of its lines, as intervals of degrees.
    pub slope_arcs: Vec<[f64; 2]>,
    /// The intercepts of its lines, metres; `None` when unbounded.
    pub intercept: Option<[f64; 2]>,
    /// Its probability.
    pub probability: f64,
    /// Whether the true line is among its lines, if there is one.
    #[serde(skip)]
    pub holds: Option<bool>,
}

/// A credible set.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct CredibleRecord {
    /// The probability that was asked for.
    pub level: f64,
    /// The slopes of its lines, as intervals of degrees.
    pub slope_arcs: Vec<[f64; 2]>,
    /// The intercepts of its lines, metres; `None` when unbounded.
    pub intercept: Option<[f64; 2]>,
    /// Its probability, which is at least the level.
    pub probability: f64,
    /// Number of its hypotheses, where there are hypotheses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<usize>,
    /// Number of all hypotheses.
    #[serde(skip)]
    pub hypotheses: usize,
    /// Whether the true line is among its lines, if there is one.
    #[serde(skip)]
    pub holds: Option<bool>,
}

/// An area, metres.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct AreaRecord {
    /// From and to.
    pub x: [f64; 2],
    /// From and to.
    pub z: [f64; 2],
    /// Its corners, if it is not that rectangle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub polygon: Option<Vec<[f64; 2]>>,
}

/// What is kept out of, metres: all within a radius of a convex polygon, or of a point.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct KeepOutRecord {
    /// The corners.
    pub polygon: Vec<[f64; 2]>,
    /// The radius.
    pub radius: f64,
}

/// A sample.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct SampleRecord {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub z: f64,
    /// -1 or 1; of `samples` 0 on the boundary too.
    pub label: i8,
}

/// A reading of a motion that has several.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct ReadingRecord {
    /// Where, metres.
    pub x: f64,
    /// Metres.
    pub z: f64,
    /// -1, 0 on the boundary, or 1.
    pub label: i8,
    /// Whether it told something. A true label does if it rules out lines. A label that may be wrong does if it was taken in.
    pub cuts: bool,
}

/// A pose.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct PoseRecord {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub z: f64,
    /// Radians.
    pub heading: f64,
}

/// An action.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct ActionRecord {
    /// Its name in the grid.
    pub index: u32,
    /// Length of the motion, metres. In the paper it is the speed over a unit of time.
    pub v: f32,
    /// Turn, radians.
    pub w: f32,
}

/// The straight line that misclassifies least.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct FitRecord {
    /// As of any line; `None` of a vertical one.
    pub slope: Option<f64>,
    /// As of any line, metres; `None` of a vertical one.
    pub intercept: Option<f64>,
    /// Degrees within [-90, 90].
    pub angle: f64,
    /// The share of the area that it misclassifies.
    pub misclassified: f64,
    /// The shares that the estimates misclassify.
    #[serde(default)]
    pub estimates: EstimateRecords<f64>,
    /// The line.
    #[serde(skip)]
    pub line: LineRecord,
}

/// The three estimates, `None` where there is none.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct EstimateRecords<L = LineRecord> {
    /// The paper's; of labels that may be wrong, as they were seen.
    pub bisector: Option<L>,
    /// The centre of the version space, or the posterior mean.
    pub centre: Option<L>,
    /// The hard-margin separator; of labels that may be wrong, that of the most likely hypothesis.
    pub maximum_margin: Option<L>,
}

impl StepResult {
    /// What was read on the way, before the label at the end.
    pub fn passed(&self) -> impl Iterator<Item = (Site, Reading)> + '_ {
        let at_end = usize::from(self.label.is_some());
        let passed = self.readings.len().saturating_sub(at_end);
        self.readings.iter().take(passed).filter_map(|it| {
            let reading = match it.label {
                1 => Label::Positive.into(),
                -1 => Label::Negative.into(),
                _ => Reading::Boundary,
            };
            Some((Site::try_from(Point2::new(it.x, it.z)).ok()?, reading))
        })
    }

    /// Whether what was sensed is not what a perfect sensor reads, as far as that is known.
    pub fn is_wrong(&self) -> bool {
        self.label.zip(self.fact).is_some_and(|(seen, fact)| seen != fact)
    }
}

/// The control cost of a motion, the paper's `|u|^2 = v^2 + w^2`.
pub fn cost(control: Control) -> f64 {
    let (v, w) = (f64::from(control.distance_m), f64::from(control.turn_rad));
    v * v + w * w
}

impl Results {
    /// Samples taken on the way.
    pub fn samples(&self) -> usize {
        self.steps.iter().filter(|step| step.label.is_some()).count()
    }

    /// Readings of motions that have several, and how many of them told something.
    pub fn readings(&self) -> (usize, usize) {
        let all = self.steps.iter().flat_map(|step| &step.readings);
        (all.clone().count(), all.filter(|it| it.cuts).count())
    }

    /// Metres travelled.
    pub fn travelled(&self) -> f64 {
        self.steps.last().map_or(0.0, |last| last.metres)
    }

    /// The control cost.
    pub fn cost(&self) -> f64 {
        self.steps.last().map_or(0.0, |last| last.control_cost)
    }
}

impl From<MissionArea> for AreaRecord {
    fn from(area: MissionArea) -> Self {
        let [min, max] = [area.bounds().min(), area.bounds().max()].map(Point2::<f64>::from);
        let polygon = area.sides().next().map(|_| corners(area.corners()));
        Self { x: [min.x, max.x], z: [min.y, max.y], polygon }
    }
}

impl<const C: usize> From<&KeepOut<C>> for KeepOutRecord {
    fn from(KeepOut { hull, radius }: &KeepOut<C>) -> Self {
        let radius = f64::from(*radius) / f64::from(UNITS_PER_METRE);
        Self { polygon: corners(hull.corners()), radius }
    }
}

fn corners(sites: &[Site]) -> Vec<[f64; 2]> {
    sites.iter().map(|site| Point2::<f64>::from(*site).into()).collect()
}

impl ReadingRecord {
    /// A reading at a site.
    pub fn of(site: Site, reading: Reading, cuts: bool) -> Self {
        let at = Point2::<f64>::from(site);
        Self { x: at.x, z: at.y, label: reading.sign(), cuts }
    }
}

impl From<&Sample> for SampleRecord {
    fn from(&Sample { site, label }: &Sample) -> Self {
        (&(site, Reading::Side(label))).into()
    }
}

impl From<&(Site, Reading)> for SampleRecord {
    fn from(&(site, reading): &(Site, Reading)) -> Self {
        let at = Point2::<f64>::from(site);
        Self { x: at.x, z: at.y, label: reading.sign() }
    }
}

impl From<Pose> for PoseRecord {
    fn from(pose: Pose) -> Self {
        let at = Point2::<f64>::from(pose.site);
        Self { x: at.x, z: at.y, heading: pose.heading.radians() }
    }
}

impl From<&Motion> for ActionRecord {
    fn from(motion: &Motion) -> Self {
        Self { index: motion.action.0, v: motion.control.distance_m, w: motion.control.turn_rad }
    }
}

impl FitRecord {
    /// The line that misclassifies least, beside the estimates.
    pub fn beside(Fit { line, misclassified }: Fit, estimates: &EstimateRecords) -> Self {
        let line = LineRecord::from(line);
        let LineRecord { slope, intercept, angle, .. } = line;
        let estimates = estimates.and_then(|it| it.error.map(|error| error.misclassified));
        Self { slope, intercept, angle, misclassified, estimates, line }
    }
}

impl<L> EstimateRecords<L> {
    /// The same of each estimate.
    pub fn and_then<M>(self, of: impl Fn(L) -> Option<M>) -> EstimateRecords<M> {
        let Self { bisector, centre, maximum_margin } = self;
        EstimateRecords {
            bisector: bisector.and_then(&of),
            centre: centre.and_then(&of),
            maximum_margin: maximum_margin.and_then(&of),
        }
    }
}

impl EstimateRecords {
    /// The estimates, each beside the truth.
    pub fn beside(estimates: Estimates, error: impl Fn(&Line) -> Option<LineError>) -> Self {
        let record = |local: LocalLine| {
            let line = Line::from(local);
            LineRecord { error: error(&line), ..line.into() }
        };
        Self {
            bisector: estimates.bisector.map(record),
            centre: estimates.centre.map(record),
            maximum_margin: estimates.maximum_margin.map(record),
        }
    }
}

/// The name of a motion of an audit, in the place of a problem's.
pub const AUDIT: &str = "audit";

/// The name of a one-step problem.
pub fn stage_name(stage: Stage) -> &'static str {
    match stage {
        Stage::P1 => "P1",
        Stage::P2 => "P2",
        Stage::P3 => "P3",
        Stage::P4 => "P4",
        Stage::Audit => AUDIT,
        Stage::Seek => "seek",
        Stage::Follow => "follow",
        Stage::Pass => "pass",
        Stage::Return => "return",
    }
}

/// The name of a rung of the recovery ladder.
pub fn recovery_name(recovery: Recovery) -> &'static str {
    match recovery {
        Recovery::Undirected => "undirected",
        Recovery::Reorient => "reorient",
        Recovery::Transit => "transit",
    }
}

/// Why a mission ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All steps were taken.
    Steps,
    /// All labels were read that there may be.
    Labels,
    /// The planner had no further motion.
    Stopped(StopReason),
    /// A real vehicle could not go on, or a label contradicted what was known.
    BrokenOff,
}

impl Ending {
    /// The reason as the trace names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Steps => "steps",
            Self::Labels => "labels",
            Self::BrokenOff => "broken off",
            Self::Stopped(StopReason::Resolution) => "resolution",
            Self::Stopped(StopReason::SamplesFull) => "samples full",
            Self::Stopped(StopReason::OutsideArea) => "outside area",
            Self::Stopped(StopReason::Known) => "known",
            Self::Stopped(StopReason::Cornered) => "cornered",
            Self::Stopped(StopReason::Undecided) => "undecided",
            Self::Stopped(StopReason::Tolerance) => "tolerance",
            Self::Stopped(StopReason::NoLine) => "no line",
            Self::Stopped(StopReason::Worth) => "worth",
            Self::Stopped(StopReason::Closed) => "closed",
            Self::Stopped(StopReason::OneLabel) => "one label",
            Self::Stopped(_) => "stopped",
        }
    }
}
