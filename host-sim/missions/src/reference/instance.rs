//! An instance of a full-horizon problem: a scenario's mission, a number of motions, and which cost.

use anyhow::{Result, anyhow, bail};
use planner_core::dynamics::{Action, Control, Dynamics as _, room_for_errors};
use planner_core::{Label, Pose, Sample, Tolerance, Workspace as _};

use crate::mission::algorithm::Algorithm;
use crate::mission::allowance::Allowance;
use crate::mission::definition::Mission;
use crate::mission::results::cost;
use crate::reference::objective::{LineCost, Lines, Problem};
use crate::world::errors::Errors;

/// Actions that are tried one by one, at most.
const MOST_ACTIONS: u64 = 100_000;

/// Motions in a sequence, at most: more than can be solved with a few actions each.
pub const LONGEST: u32 = 12;

/// What is to be solved.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The scenario's mission, with the horizon as its number of steps.
    pub mission: Mission,
    /// The problem.
    pub problem: Problem,
    /// The label above the true line.
    pub above: Label,
    /// The vehicle's actions, the cheapest first; of those that cost the same, the lowest index.
    pub choices: Vec<Choice>,
}

/// An action and what it costs.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Its name in the grid.
    pub action: Action,
    /// Its [`effort`].
    pub effort: u64,
}

/// A part of a sequence of motions.
#[derive(Clone, Copy, Debug)]
pub struct Partial {
    /// Where it has led to.
    pub pose: Pose,
    /// Motions left.
    pub left: u32,
    /// `|u|^2` so far, in millionths.
    pub effort: u64,
    /// The sum of the labels so far, that of the start included.
    pub sum: i32,
    /// The lines left.
    pub lines: Lines,
}

impl Instance {
    /// The instance of a mission with this many motions.
    ///
    /// # Errors
    /// Names what of the mission the paper's problem does not have, or what is too much.
    pub fn new(mission: Mission, horizon: u32, line: Option<LineCost>) -> Result<Self> {
        if !(1..=LONGEST).contains(&horizon) {
            bail!("--horizon: found {horizon}, expected 1 to {LONGEST}");
        }
        let problem = problem(&mission, line)?;
        let truth = mission
            .world
            .line()
            .ok_or_else(|| anyhow!("truth: found none, or no fixed line, expected one"))?;
        let [_, upwards, _] = truth.coefficients();
        if upwards == 0.0 && problem == Problem::Divided(LineCost::Slope) {
            bail!(
                "truth: found a vertical line, expected one with a slope, which is what a line costs; or --line margin"
            );
        }
        let above = if upwards < 0.0 { Label::Negative } else { Label::Positive };
        let choices = choices(&mission)?;
        Ok(Self { mission: Mission { steps: horizon, ..mission }, problem, above, choices })
    }

    /// The same with fewer motions.
    #[must_use]
    pub fn cut_to(&self, horizon: u32) -> Self {
        let mut cut = self.clone();
        cut.mission.steps = horizon;
        cut
    }

    /// Motions in a sequence.
    pub fn horizon(&self) -> u32 {
        self.mission.steps
    }

    /// The samples that are given.
    pub fn given(&self) -> &[Sample] {
        self.mission.given.samples()
    }

    /// The empty sequence; `None` if no line divides the oracle's points as the problem wants.
    pub fn begin(&self) -> Option<Partial> {
        let pose = self.mission.start;
        let label = self.mission.world.reading(pose.site);
        let lines = self.problem.begin(self.given(), self.above, label)?;
        Some(Partial { pose, left: self.horizon(), effort: 0, sum: label.sign().into(), lines })
    }

    /// Where an action leads; `None` if that is outside of where the vehicle may be, or there is no such action.
    pub fn target(&self, from: Pose, action: Action) -> Option<Pose> {
        let (vehicle, area) = (&self.mission.vehicle, &self.mission.config.area);
        let to = vehicle.target(from, action)?;
        (area.contains(to.site) && vehicle.keeps_inside(from, to, area, room_for_errors(area)))
            .then_some(to)
    }

    /// A lower bound on the cost of all sequences that continue `at` with motions that cost at least `further`. For a
    /// complete sequence it is the cost.
    pub fn cost(&self, at: &Partial, further: u64) -> f64 {
        (at.effort + further) as f64 / 1e6 + at.lines.cost(at.left)
    }
}

fn problem(mission: &Mission, line: Option<LineCost>) -> Result<Problem> {
    if mission.readings > 1 {
        let found = mission.readings;
        bail!(
            "readings: found {found}, expected 1, as the paper's problems have one label a motion"
        );
    }
    if mission.errors != Errors::default() {
        bail!(
            "errors: found a robot that errs, expected none, as the paper's problems have no such errors"
        );
    }
    if !mission.sensor.is_empty() {
        bail!(
            "sensor: found one that fails, expected none, as the paper's problems have no such faults"
        );
    }
    if mission.allowance != Allowance::NONE {
        bail!(
            "allow: found a boundary that may bend or drift, or late labels, expected none, as the paper's problems \
             have none of them"
        );
    }
    if mission.config.tolerance != Tolerance::NONE {
        let found = mission.config.tolerance.metres();
        bail!(
            "tolerance: found {found} m, expected 0, as the paper's problems have exact positions"
        );
    }
    if mission.goal.is_some() {
        bail!("stop: found one, expected none, as the paper's problems end with their horizon");
    }
    let labels_err = mission.noise.is_some();
    if labels_err && mission.algorithm == Algorithm::Cfc {
        bail!("algorithm: found \"cfc\" with noise, expected \"scc\", whose labels may be wrong");
    }
    if mission.algorithm.weighs(labels_err) {
        return match line {
            None => Ok(Problem::Labelled),
            Some(_) => bail!(
                "--line: found a scenario whose labels may be wrong, expected true ones: with others the paper counts \
                 labels instead"
            ),
        };
    }
    Ok(Problem::Divided(line.unwrap_or_default()))
}

fn choices(mission: &Mission) -> Result<Vec<Choice>> {
    let (vehicle, start) = (&mission.vehicle, mission.start);
    let count = vehicle.grid().actions();
    if count > MOST_ACTIONS {
        bail!(
            "vehicle: found {count} actions, expected at most {MOST_ACTIONS}: fan = \"paper\", or a larger vehicle.turn_step"
        );
    }
    let all = (0..count as u32).map(Action).filter(|it| vehicle.ray_of(start, *it).is_some());
    let mut choices: Vec<_> = all
        .map(|action| Choice { action, effort: effort(vehicle.control(start, action)) })
        .collect();
    choices.sort_by_key(|it| (it.effort, it.action));
    Ok(choices)
}

/// `|u|^2` in millionths, to the nearest.
pub fn effort(control: Control) -> u64 {
    (cost(control) * 1e6).round() as u64
}
