//! The steps of a mission as flat records, for data frames: every key on every line, and no lists.

use serde::Serialize;

use crate::mission::algorithm::Algorithm;
use crate::mission::results::{PoseRecord, Results, Start, StepResult};
use crate::output::file::json;

/// A step, with what the trace has once for all steps. Keys are those of the trace. Each part of a list or an object
/// there has a key of its own here.
#[derive(Serialize)]
pub(crate) struct Row {
    pub(crate) algorithm: Algorithm,
    pub(crate) seed: u64,
    pub(crate) p: f64,
    pub(crate) truth_angle: Option<f64>,
    pub(crate) truth_slope: Option<f64>,
    pub(crate) truth_intercept: Option<f64>,
    pub(crate) step: usize,
    pub(crate) problem: Option<&'static str>,
    pub(crate) recovery: Option<&'static str>,
    pub(crate) index: u32,
    pub(crate) v: f32,
    pub(crate) w: f32,
    pub(crate) x: f64,
    pub(crate) z: f64,
    pub(crate) heading: f64,
    pub(crate) true_x: Option<f64>,
    pub(crate) true_z: Option<f64>,
    pub(crate) true_heading: Option<f64>,
    pub(crate) label: Option<i8>,
    pub(crate) trusted: Option<bool>,
    /// One interval: across the vertical it ends beyond 90.
    pub(crate) slope_from: Option<f64>,
    pub(crate) slope_to: Option<f64>,
    pub(crate) intercept_from: Option<f64>,
    pub(crate) intercept_to: Option<f64>,
    pub(crate) bits: f64,
    pub(crate) entropy: Option<f64>,
    pub(crate) hypotheses: Option<usize>,
    pub(crate) pruned_mass: Option<f64>,
    pub(crate) examined: u32,
    pub(crate) proven: bool,
    /// Up to and with this step.
    pub(crate) control_cost: f64,
    pub(crate) metres: f64,
}

/// The steps of a mission, one a line.
pub fn lines(results: &Results) -> String {
    rows(results).map(|row| json(&row)).collect()
}

/// The steps of a mission.
pub(crate) fn rows(results: &Results) -> impl Iterator<Item = Row> {
    let (mut control_cost, mut metres) = (0.0, 0.0);
    results.steps.iter().map(move |step| {
        control_cost += step.cost();
        metres += f64::from(step.action.v);
        Row { control_cost, metres, ..Row::of(&results.start, step) }
    })
}

impl Row {
    fn of(start: &Start, step: &StepResult) -> Self {
        let truth = start.truth.as_ref();
        let truly = |of: fn(&PoseRecord) -> f64| step.true_pose.as_ref().map(of);
        let arc = interval(&step.slope_arcs);
        Self {
            algorithm: start.algorithm,
            seed: start.seed,
            p: start.p,
            truth_angle: truth.map(|line| line.angle),
            truth_slope: truth.and_then(|line| line.slope),
            truth_intercept: truth.and_then(|line| line.intercept),
            step: step.step,
            problem: step.problem,
            recovery: step.recovery,
            index: step.action.index,
            v: step.action.v,
            w: step.action.w,
            x: step.pose.x,
            z: step.pose.z,
            heading: step.pose.heading,
            true_x: truly(|pose| pose.x),
            true_z: truly(|pose| pose.z),
            true_heading: truly(|pose| pose.heading),
            label: step.label,
            trusted: step.noisy.map(|it| it.trusted),
            slope_from: arc.map(|[from, _]| from),
            slope_to: arc.map(|[_, to]| to),
            intercept_from: step.intercept.map(|[from, _]| from),
            intercept_to: step.intercept.map(|[_, to]| to),
            bits: step.bits,
            entropy: step.noisy.map(|it| it.entropy),
            hypotheses: step.noisy.map(|it| it.hypotheses),
            pruned_mass: step.noisy.map(|it| it.pruned_mass),
            examined: step.examined,
            proven: step.proven.unwrap_or(true),
            control_cost: 0.0,
            metres: 0.0,
        }
    }
}

/// Slopes as one interval, degrees; across the vertical it ends beyond 90.
fn interval(intervals: &[[f64; 2]]) -> Option<[f64; 2]> {
    match *intervals {
        [[_, to], [from, _]] => Some([from, to + 180.0]),
        ref one => one.first().copied(),
    }
}
