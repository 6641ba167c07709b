//! The steps of a mission as flat records, for data frames: every key on every line, and no lists.

use serde::Serialize;

use crate::mission::algorithm::Algorithm;
use crate::mission::results::{PoseRecord, Results, Start, StepResult};
use crate::output::file::json;

/// A step with what the trace tells once for all steps. Keys are those of the trace; what is a list or an object
/// there has a key for each part.
#[derive(Serialize)]
struct Row {
    algorithm: Algorithm,
    seed: u64,
    p: f64,
    truth_angle: Option<f64>,
    truth_slope: Option<f64>,
    truth_intercept: Option<f64>,
    step: usize,
    problem: Option<&'static str>,
    recovery: Option<&'static str>,
    index: u32,
    v: f32,
    w: f32,
    x: f64,
    z: f64,
    heading: f64,
    true_x: Option<f64>,
    true_z: Option<f64>,
    true_heading: Option<f64>,
    label: Option<i8>,
    trusted: Option<bool>,
    /// One interval: across the vertical it ends beyond 90.
    slope_from: Option<f64>,
    slope_to: Option<f64>,
    intercept_from: Option<f64>,
    intercept_to: Option<f64>,
    bits: f64,
    entropy: Option<f64>,
    hypotheses: Option<usize>,
    pruned_mass: Option<f64>,
    examined: u32,
    proven: bool,
    /// Up to and with this step.
    control_cost: f64,
    metres: f64,
}

/// The steps of a mission, one a line.
pub fn lines(results: &Results) -> String {
    let (mut control_cost, mut metres) = (0.0, 0.0);
    let rows = results.steps.iter().map(|step| {
        control_cost += step.cost();
        metres += f64::from(step.action.v);
        json(&Row { control_cost, metres, ..Row::of(&results.start, step) })
    });
    rows.collect()
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
pub(crate) fn interval(intervals: &[[f64; 2]]) -> Option<[f64; 2]> {
    match *intervals {
        [[_, to], [from, _]] => Some([from, to + 180.0]),
        ref one => one.first().copied(),
    }
}
