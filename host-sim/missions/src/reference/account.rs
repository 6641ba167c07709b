//! The cost of a mission in a full-horizon problem, whoever planned it. If the problem does not allow the mission, the
//! constraints that it broke.

use planner_core::{Reading, Sample};
use serde::Serialize;

use crate::mission::recording::Recording;
use crate::reference::instance::{Instance, Partial, effort};

/// A mission by the measure of a full-horizon problem.
#[derive(Clone, Debug, Serialize)]
pub struct Account {
    /// Who planned.
    pub planner: &'static str,
    /// The objective; `None` if a constraint is broken.
    pub objective: Option<f64>,
    /// Above the optimum, if there is one.
    pub above: Option<f64>,
    /// What the best line for its samples costs; `None` if there is no such line.
    pub line_cost: Option<f64>,
    /// What its motions cost.
    pub control_cost: f64,
    /// Motions that it made.
    pub steps: usize,
    /// Labels that it asked for.
    pub samples: usize,
    /// The sum of the true labels, that of the start included.
    pub label_sum: i32,
    /// Constraints that it broke.
    pub broken: Vec<&'static str>,
    /// The slopes left in the end, as intervals of degrees.
    pub slope_arcs: Vec<[f64; 2]>,
    /// Bits learnt.
    pub bits: f64,
}

/// The labels are not balanced.
pub const UNBALANCED: &str = "labels";

/// No line has all samples on the sides of their labels as far off as is asked.
pub const NO_LINE: &str = "line";

/// Fewer motions were made than the horizon has.
pub const SHORT: &str = "steps";

impl Account {
    /// The cost of a mission. The paper has a label at every step. So each position counts as a sample with its true
    /// label, whether that was asked for or not.
    pub fn of(
        instance: &Instance,
        planner: &'static str,
        recording: &Recording,
        optimum: Option<f64>,
    ) -> Self {
        let world = &instance.mission.world;
        let mut samples = instance.given().to_vec();
        let mut at = instance.begin();
        let mut sum = i32::from(world.reading(instance.mission.start.site).sign());
        for step in &recording.steps {
            let reading = world.reading(step.pose.site);
            sum += i32::from(reading.sign());
            at = at.and_then(|at| {
                let lines = at.lines.with(&samples, step.pose.site, reading)?;
                let (left, effort) = (at.left - 1, at.effort + effort(step.motion.control));
                Some(Partial { pose: step.pose, left, effort, sum, lines })
            });
            if let Reading::Side(label) = reading {
                samples.push(Sample { site: step.pose.site, label });
            }
        }
        let results = &recording.results;
        let is_short = recording.steps.len() < instance.horizon() as usize;
        let broken: Vec<_> = [
            (SHORT, is_short),
            (UNBALANCED, !instance.problem.allows_sum(sum)),
            (NO_LINE, at.is_none()),
        ]
        .into_iter()
        .filter_map(|(name, is_broken)| is_broken.then_some(name))
        .collect();
        let objective = at.filter(|_| broken.is_empty()).map(|at| instance.cost(&at, 0));
        let last = results.steps.last();
        Self {
            planner,
            objective,
            above: objective.zip(optimum).map(|(own, best)| own - best),
            line_cost: at.filter(|_| !is_short).map(|at| at.lines.cost(0)),
            control_cost: results.cost(),
            steps: results.steps.len(),
            samples: results.samples(),
            label_sum: sum,
            broken,
            slope_arcs: last.map_or(results.start.slope_arcs.clone(), |it| it.slope_arcs.clone()),
            bits: last.map_or(0.0, |it| it.bits),
        }
    }
}
