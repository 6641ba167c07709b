//! A mission as it went: each step with what was known after it.

use anyhow::{Result, anyhow};
use nalgebra::Point2;
use planner_core::belief::estimate::{self, Estimates};
use planner_core::belief::posterior::Posterior;
use planner_core::belief::version_space::{Refused, VersionSpace};
use planner_core::belief::weight::Reliability;
use planner_core::planner::{Recovery, Stage};
use planner_core::robot::agent::Step;

use crate::mission::definition::{CAPACITY, End, Known, Mission, Table};

/// The level of the credible sets that are told.
pub const LEVEL: f64 = 0.9;

/// A step and what was known after it.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// The step.
    pub step: Step,
    /// The slopes left, as intervals of degrees: of all lines that agree with the labels, or of the
    /// credible set.
    pub slope_arcs: Vec<[f64; 2]>,
    /// The intercepts left, metres; `None` when unbounded.
    pub intercept: Option<[f64; 2]>,
    /// Bits learnt since the start.
    pub bits: f64,
    /// What noisy labels add.
    pub noisy: Option<NoisyStep>,
}

/// The distribution over hypotheses after a step, in figures.
#[derive(Clone, Copy, Debug)]
pub struct NoisyStep {
    /// The sample lies in a trusted ball.
    pub trusted: bool,
    /// Number of hypotheses.
    pub hypotheses: usize,
    /// The probability given up as the table was full, at most.
    pub pruned_mass: f64,
    /// Entropy over the hypotheses, bits.
    pub entropy: f64,
}

/// What was known at the end.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// All lines that agree with every label.
    Lines(Box<VersionSpace<CAPACITY>>),
    /// The distribution over hypotheses.
    Hypotheses(Box<Table>),
}

/// A whole mission.
#[derive(Clone, Debug)]
pub struct Recording {
    /// What was asked.
    pub mission: Mission,
    /// The steps.
    pub steps: Vec<Recorded>,
    /// Why it ended.
    pub end: End,
    /// What was known at the end.
    pub outcome: Outcome,
}

/// A mission that is being recorded.
#[derive(Clone, Debug)]
pub struct Recorder {
    mission: Mission,
    steps: Vec<Recorded>,
    outcome: Outcome,
    /// The measure of what was left at the start.
    before: f64,
}

impl Recorder {
    /// Nothing has happened yet.
    pub fn new(mission: Mission) -> Self {
        let outcome = if mission.is_noisy() {
            Outcome::Hypotheses(Box::new(mission.table()))
        } else {
            Outcome::Lines(Box::new(mission.space.clone()))
        };
        let before = estimate::area(mission.space.candidates());
        Self { mission, steps: Vec::new(), outcome, before }
    }

    /// Takes down a step and what is known after it.
    pub fn take(&mut self, step: &Step, known: Known<'_>) {
        let (recorded, outcome) = match known {
            Known::Lines(space) => {
                (lines_left(step, space, self.before), Outcome::Lines(Box::new(space.clone())))
            }
            Known::Hypotheses(table) => {
                let reliability = self.mission.noise_told().at(step.pose.site, table.given());
                let trusted = reliability == Reliability::CERTAIN;
                let recorded = hypotheses_left(step, table, trusted);
                (recorded, Outcome::Hypotheses(Box::new(table.clone())))
            }
        };
        self.steps.push(recorded);
        self.outcome = outcome;
    }

    /// Steps so far.
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    /// What is said of a sample that the planner does not take in the step after these.
    pub fn refusal(&self, refused: &Refused) -> anyhow::Error {
        let step = self.steps.len() + 1;
        match refused {
            Refused::Contradiction(sample) => {
                let (at, label) = (Point2::<f64>::from(sample.site), sample.label.sign());
                anyhow!(
                    "step {step}: label {label} at ({}, {}) contradicts the region of certainty it lies in",
                    at.x,
                    at.y,
                )
            }
            Refused::Full(_) => anyhow!("step {step}: {refused}"),
        }
    }

    /// The mission is over.
    pub fn end(self, end: End) -> Recording {
        let Self { mission, steps, outcome, .. } = self;
        Recording { mission, steps, end, outcome }
    }
}

impl Recording {
    /// Runs a mission and records it.
    ///
    /// # Errors
    /// Names the sample that the planner refused.
    pub fn of(mission: &Mission) -> Result<Self> {
        let mut recorder = Recorder::new(mission.clone());
        match mission.run(|step, known| recorder.take(step, known)) {
            Ok(end) => Ok(recorder.end(end)),
            Err(refused) => Err(recorder.refusal(&refused)),
        }
    }

    /// The estimates at the end. Of noisy labels, the centre is the posterior mean and the maximum
    /// margin that of the most likely hypothesis.
    pub fn estimates(&self) -> Estimates {
        match &self.outcome {
            Outcome::Lines(space) => Estimates::of(space),
            Outcome::Hypotheses(table) => Posterior::new(table).estimates(),
        }
    }

    /// Samples taken on the way.
    pub fn samples(&self) -> usize {
        self.steps.iter().filter(|s| s.step.reading.is_some()).count()
    }

    /// Metres travelled.
    pub fn travelled(&self) -> f64 {
        self.steps.iter().map(|s| f64::from(s.step.motion.control.v)).sum()
    }

    /// The control cost, the sum of `v^2 + w^2`.
    pub fn cost(&self) -> f64 {
        self.steps.iter().map(|s| cost(&s.step)).sum()
    }
}

fn lines_left(step: &Step, space: &VersionSpace<CAPACITY>, before: f64) -> Recorded {
    Recorded {
        step: *step,
        slope_arcs: space.slope_arc().intervals_deg().to_vec(),
        intercept: space.intercepts(),
        bits: libm::log2(before / estimate::area(space.candidates())),
        noisy: None,
    }
}

fn hypotheses_left(step: &Step, table: &Table, trusted: bool) -> Recorded {
    let posterior = Posterior::new(table);
    let credible = posterior.credible(LEVEL);
    Recorded {
        step: *step,
        slope_arcs: credible.slope_arc.intervals_deg().to_vec(),
        intercept: credible.intercept,
        bits: posterior.information(),
        noisy: Some(NoisyStep {
            trusted,
            hypotheses: table.iter().len(),
            pruned_mass: posterior.lost(),
            entropy: posterior.entropy(),
        }),
    }
}

/// The control cost of a step, the paper's `|u|^2 = v^2 + w^2`.
pub fn cost(step: &Step) -> f64 {
    let (v, w) = (f64::from(step.motion.control.v), f64::from(step.motion.control.w));
    v * v + w * w
}

/// The name of a one-step problem.
pub fn stage_name(stage: Stage) -> &'static str {
    match stage {
        Stage::P1 => "P1",
        Stage::P2 => "P2",
        Stage::P3 => "P3",
        Stage::P4 => "P4",
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
