//! Algorithm 1, control for classification: noiseless labels.

use crate::cell::Certainty;
use crate::direction::Arc;
use crate::dynamics::{Dynamics, Pose};
use crate::planner::{Motion, Plan, Planner, Stage, StopReason};
use crate::problem::{Area, DirectionRule, Problem, Varrho};
use crate::recovery::{Found, solve_or_recover};
use crate::sample::{Label, Reading, Sample};
use crate::version_space::{Refused, VersionSpace};

/// How P1 looks for the opposite label (Section III-A).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Crossing {
    /// In any direction in which the boundary cannot run: P1 as printed.
    #[default]
    Anyhow,
    /// Of these, only along the direction from the first oracle point to the second.
    AlongOracle,
    /// Of these, only at right angles to the bisector of the slope arc.
    AcrossBisector,
}

/// What a mission fixes beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config {
    /// Where positions must stay.
    pub area: Area,
    /// The weight of the control in the objective.
    pub varrho: Varrho,
    /// How P1 looks for the opposite label.
    pub crossing: Crossing,
}

/// Where Algorithm 1 stands.
///
/// ```text
///              no flip                          any reading
///              +-----+
///              v     |        flip
///          +-----------+ -------------> +-----------+
///  start ->| Crossing  |                | Following |
///          | (P1)      | <------------- | (P2)      |
///          +-----------+    a sample    +-----------+
/// ```
///
/// A flip is a label opposite to that of the past position. A reading on the boundary is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Phase {
    /// Solve P1 until the label flips.
    Crossing,
    /// Solve P2 once.
    Following,
}

/// Algorithm 1 for `D`'s dynamics with room for `N` samples, the oracle's included.
#[derive(Clone, Debug)]
pub struct Cfc<D, const N: usize> {
    config: Config,
    dynamics: D,
    space: VersionSpace<N>,
    phase: Phase,
    /// The label of the past position.
    past: Label,
}

impl<D: Dynamics, const N: usize> Cfc<D, N> {
    /// A planner that knows the oracle's samples; its past label is that of the first of them.
    pub fn new(config: Config, dynamics: D, space: VersionSpace<N>) -> Self {
        let past = space.first_label();
        Self { config, dynamics, space, phase: Phase::Crossing, past }
    }

    /// What is known of the line.
    pub fn space(&self) -> &VersionSpace<N> {
        &self.space
    }

    /// Where the algorithm stands.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The one-step problem of the present phase.
    pub fn problem(&self) -> Problem<'_, N> {
        let Config { area, varrho, .. } = self.config;
        let arc = self.space.slope_arc();
        let rule = match self.phase {
            Phase::Crossing => DirectionRule { inside: self.crossing_arc(arc), outside: Some(arc) },
            Phase::Following => DirectionRule { inside: Some(arc), outside: None },
        };
        Problem { space: &self.space, area, varrho, rule }
    }

    fn crossing_arc(&self, slopes: Arc) -> Option<Arc> {
        match (self.config.crossing, self.space.samples()) {
            (Crossing::AlongOracle, [p1, p2, ..]) => Some(Arc::about(p2.site - p1.site)),
            (Crossing::AcrossBisector, _) => Some(Arc::about(slopes.bisector().left())),
            _ => None,
        }
    }
}

impl<D: Dynamics, const N: usize> Planner for Cfc<D, N> {
    fn plan(&mut self, pose: Pose) -> Plan {
        if self.space.is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        if !self.config.area.contains(pose.site) {
            return Plan::Stop(StopReason::OutsideArea);
        }
        let stage = match self.phase {
            Phase::Crossing => Stage::P1,
            Phase::Following => Stage::P2,
        };
        let mut examined = 0;
        match solve_or_recover(&self.problem(), &self.dynamics, pose, &mut examined) {
            Some(Found { recovery, action, target }) => {
                let control = self.dynamics.control(action);
                Plan::Move(Motion { stage: Some(stage), recovery, action, control, target, examined })
            }
            None => Plan::Stop(StopReason::Resolution),
        }
    }

    fn observe(&mut self, pose: Pose, reading: Option<Reading>) -> Result<(), Refused> {
        let Some(reading) = reading else {
            // Ground that was merely crossed: its label is known where it is certain.
            if let Certainty::Certain(label) = self.space.certainty(pose.site) {
                self.past = label;
            }
            return Ok(());
        };
        // On the boundary both labels are true of the closed half-planes; the past one is no flip.
        let label = match reading {
            Reading::Side(label) => label,
            Reading::Boundary => self.past,
        };
        self.space.insert(Sample { site: pose.site, label })?;
        self.phase = match self.phase {
            Phase::Crossing if label != self.past => Phase::Following,
            _ => Phase::Crossing,
        };
        self.past = label;
        Ok(())
    }
}
