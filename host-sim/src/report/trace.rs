//! The trace: a mission as JSON Lines. The contract is in ARCHITECTURE.md.

use nalgebra::Point2;
use planner_core::belief::estimate::Estimates;
use planner_core::belief::hypotheses::Prior;
use planner_core::belief::posterior::Posterior;
use planner_core::belief::sample::{Reading, Sample};
use planner_core::geometry::area::Area;
use planner_core::geometry::line::Line;
use planner_core::motion::dynamics::Pose;
use serde::Serialize;

use crate::mission::definition::Algorithm;
use crate::mission::recording::{LEVEL, Outcome, Recorded, Recording, recovery_name, stage_name};
use crate::output::file::json;

#[derive(Serialize)]
#[serde(tag = "record", rename_all = "lowercase")]
enum Record {
    Start(Start),
    Step(Step),
    End(End),
}

#[derive(Serialize)]
struct Start {
    algorithm: Algorithm,
    seed: u64,
    varrho: f64,
    area: AreaRecord,
    oracle: Vec<SampleRecord>,
    pose: PoseRecord,
    truth: LineRecord,
    p: f64,
}

#[derive(Serialize)]
struct Step {
    #[serde(rename = "step")]
    number: usize,
    problem: Option<&'static str>,
    recovery: Option<&'static str>,
    action: ActionRecord,
    pose: PoseRecord,
    label: Option<i8>,
    slope_arcs: Vec<[f64; 2]>,
    intercept: Option<[f64; 2]>,
    bits: f64,
    examined: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    proven: Option<bool>,
    #[serde(flatten)]
    noisy: Option<NoisyRecord>,
}

#[derive(Serialize)]
struct NoisyRecord {
    trusted: bool,
    hypotheses: usize,
    pruned_mass: f64,
    entropy: f64,
}

#[derive(Serialize)]
struct End {
    reason: &'static str,
    estimates: EstimateRecords,
    #[serde(flatten)]
    noisy: Option<NoisyEnd>,
}

/// What noisy labels come to: the paper's outcome by the paper's prior, and the credible set by the
/// chosen one.
#[derive(Serialize)]
struct NoisyEnd {
    best: BestRecord,
    credible: CredibleRecord,
}

#[derive(Serialize)]
struct BestRecord {
    slope_arcs: Vec<[f64; 2]>,
    intercept: Option<[f64; 2]>,
    probability: f64,
}

#[derive(Serialize)]
struct CredibleRecord {
    level: f64,
    slope_arcs: Vec<[f64; 2]>,
    intercept: Option<[f64; 2]>,
    probability: f64,
    cells: usize,
}

#[derive(Serialize)]
struct AreaRecord {
    x: [f64; 2],
    z: [f64; 2],
}

/// A sample as a record.
#[derive(Serialize)]
pub struct SampleRecord {
    x: f64,
    z: f64,
    label: i8,
}

#[derive(Serialize)]
struct PoseRecord {
    x: f64,
    z: f64,
    heading: f64,
}

#[derive(Serialize)]
struct ActionRecord {
    index: u16,
    v: f32,
    w: f32,
}

/// A line as a record; slope and intercept are null for a vertical one.
#[derive(Serialize)]
pub struct LineRecord {
    slope: Option<f64>,
    intercept: Option<f64>,
    angle: f64,
}

/// The estimates as a record; null where there is none.
#[derive(Serialize)]
pub struct EstimateRecords {
    bisector: Option<LineRecord>,
    centre: Option<LineRecord>,
    maximum_margin: Option<LineRecord>,
}

impl From<Area> for AreaRecord {
    fn from(area: Area) -> Self {
        let (min, max) = (Point2::<f64>::from(area.min()), Point2::<f64>::from(area.max()));
        Self { x: [min.x, max.x], z: [min.y, max.y] }
    }
}

impl From<&Sample> for SampleRecord {
    fn from(sample: &Sample) -> Self {
        let at = Point2::<f64>::from(sample.site);
        Self { x: at.x, z: at.y, label: sample.label.sign() }
    }
}

impl From<Pose> for PoseRecord {
    fn from(pose: Pose) -> Self {
        let at = Point2::<f64>::from(pose.site);
        Self { x: at.x, z: at.y, heading: pose.heading.radians() }
    }
}

impl From<Line> for LineRecord {
    fn from(line: Line) -> Self {
        Self { slope: line.slope(), intercept: line.intercept(), angle: line.angle_deg() }
    }
}

impl From<Estimates> for EstimateRecords {
    fn from(estimates: Estimates) -> Self {
        Self {
            bisector: estimates.bisector.map(LineRecord::from),
            centre: estimates.centre.map(LineRecord::from),
            maximum_margin: estimates.maximum_margin.map(LineRecord::from),
        }
    }
}

fn step(number: usize, recorded: &Recorded) -> Step {
    let motion = recorded.step.motion;
    Step {
        number,
        problem: motion.stage.map(stage_name),
        recovery: motion.recovery.map(recovery_name),
        action: ActionRecord { index: motion.action.0, v: motion.control.v, w: motion.control.w },
        pose: recorded.step.pose.into(),
        label: recorded.step.reading.map(Reading::sign),
        slope_arcs: recorded.slope_arcs.clone(),
        intercept: recorded.intercept,
        bits: recorded.bits,
        examined: motion.examined,
        proven: (!motion.proven).then_some(false),
        noisy: recorded.noisy.map(|noisy| NoisyRecord {
            trusted: noisy.trusted,
            hypotheses: noisy.hypotheses,
            pruned_mass: noisy.pruned_mass,
            entropy: noisy.entropy,
        }),
    }
}

fn noisy_end(recording: &Recording) -> Option<NoisyEnd> {
    let Outcome::Hypotheses(table) = &recording.outcome else { return None };
    let by_sequences = table.weighed_by(Prior::Sequences);
    let best = Posterior::new(&by_sequences).best()?;
    let credible = Posterior::new(table).credible(LEVEL);
    Some(NoisyEnd {
        best: BestRecord {
            slope_arcs: best.slope_arc.intervals_deg().to_vec(),
            intercept: best.intercept,
            probability: best.probability,
        },
        credible: CredibleRecord {
            level: credible.level,
            slope_arcs: credible.slope_arc.intervals_deg().to_vec(),
            intercept: credible.intercept,
            probability: credible.probability,
            cells: credible.cells,
        },
    })
}

/// The trace of a mission, a record a line.
pub fn lines(recording: &Recording) -> String {
    let mission = &recording.mission;
    let start = Record::Start(Start {
        algorithm: mission.algorithm,
        seed: mission.seed,
        varrho: mission.config.varrho.value(),
        area: mission.config.area.into(),
        oracle: mission.space.samples().iter().map(SampleRecord::from).collect(),
        pose: mission.start.into(),
        truth: mission.truth.into(),
        p: mission.noise.map_or(1.0, |noise| noise.p),
    });
    let steps = recording.steps.iter().zip(1..).map(|(s, number)| Record::Step(step(number, s)));
    let end = Record::End(End {
        reason: recording.end.name(),
        estimates: recording.estimates().into(),
        noisy: noisy_end(recording),
    });
    std::iter::once(start)
        .chain(steps)
        .chain(std::iter::once(end))
        .map(|record| json(&record))
        .collect()
}
