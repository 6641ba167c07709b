//! A mission as it went: each step with what was known after it.

use anyhow::{Result, anyhow};
use nalgebra::Point2;
use planner_core::agent::Step;
use planner_core::estimate::{self, Estimates};
use planner_core::planner::{Recovery, Stage};
use planner_core::version_space::{Refused, VersionSpace};

use crate::mission::{CAPACITY, End, Mission};

/// A step and what was known after it.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// The step.
    pub step: Step,
    /// The slopes left, as intervals of degrees.
    pub slope_arcs: Vec<[f64; 2]>,
    /// The intercepts left, metres; `None` when unbounded.
    pub intercept: Option<[f64; 2]>,
    /// Bits learnt since the start.
    pub bits: f64,
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
    pub space: VersionSpace<CAPACITY>,
}

impl Recording {
    /// Runs a mission and records it.
    ///
    /// # Errors
    /// Names the sample that the planner refused.
    pub fn of(mission: Mission) -> Result<Self> {
        let mut steps = Vec::new();
        let mut last = mission.space.clone();
        let before = estimate::area(last.candidates());
        let end = mission
            .run(|step, space| {
                last = space.clone();
                steps.push(Recorded {
                    step: *step,
                    slope_arcs: space.slope_arc().intervals_deg().to_vec(),
                    intercept: space.intercepts(),
                    bits: (before / estimate::area(space.candidates())).log2(),
                });
            })
            .map_err(|refused| match refused {
                Refused::Contradiction(sample) => {
                    let at = Point2::<f64>::from(sample.site);
                    anyhow!(
                        "step {}: label {} at ({}, {}) contradicts the region of certainty it lies in",
                        steps.len() + 1,
                        sample.label.sign(),
                        at.x,
                        at.y,
                    )
                }
                Refused::Full(_) => anyhow!("step {}: {refused}", steps.len() + 1),
            })?;
        Ok(Self { mission, steps, end, space: last })
    }

    /// The estimates at the end.
    pub fn estimates(&self) -> Estimates {
        Estimates::of(&self.space)
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

/// The control cost of a step, the paper's `|u|^2 = v^2 + w^2`.
pub fn cost(step: &Step) -> f64 {
    let control = step.motion.control;
    f64::from(control.v).powi(2) + f64::from(control.w).powi(2)
}

/// The name of a one-step problem.
pub fn stage_name(stage: Stage) -> &'static str {
    match stage {
        Stage::P1 => "P1",
        Stage::P2 => "P2",
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
