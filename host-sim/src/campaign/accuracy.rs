//! How accurate the line is after so many steps with true labels, and what that cost.

use std::collections::BTreeMap;

use planner_core::geometry::line::Line;
use planner_core::geometry::local_line::LocalLine;
use planner_core::motion::dynamics::Dynamics as _;
use serde::Serialize;

use crate::campaign::ensemble::{Campaign, Ensemble, Measure, Progress, Tally};
use crate::campaign::spread::Spread;
use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::read_out::ReadOut;
use crate::mission::vehicle::VehicleTable;
use crate::world::polygon::misclassified;

/// Steps at which missions are compared.
const STEPS: [u32; 8] = [1, 2, 5, 10, 20, 30, 40, 60];

/// The accuracy of the three estimates. A mission that ended earlier counts with what it knew at its end.
pub struct Accuracy;

/// What was known after some steps of one mission.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Checkpoint {
    field: u64,
    step: u32,
    bits: f64,
    centre_deg: f64,
    maximum_margin_deg: f64,
    bisector_deg: f64,
    centre_misclassified: f64,
    maximum_margin_misclassified: f64,
    bisector_misclassified: f64,
    control_cost: f64,
    metres: f64,
}

/// The ensemble after some steps.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// After how many steps.
    pub step: u32,
    /// Mean bits learnt, per step.
    pub bits_per_step: f64,
    /// Slope error of the centre, degrees.
    pub centre_deg: Spread,
    /// Slope error of the maximum margin, degrees.
    pub maximum_margin_deg: Spread,
    /// Slope error of the paper's bisector, degrees; 90 where there is none.
    pub bisector_deg: Spread,
    /// Share of the area the centre labels wrongly.
    pub centre_misclassified: Spread,
    /// Share of the area the maximum margin labels wrongly.
    pub maximum_margin_misclassified: Spread,
    /// Share of the area the paper's bisector labels wrongly; 1/2 where there is none.
    pub bisector_misclassified: Spread,
    /// Mean control cost so far.
    pub control_cost: f64,
    /// Mean metres travelled so far.
    pub metres: f64,
}

/// What a campaign came to.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Who planned.
    pub algorithm: Algorithm,
    /// Number of standard fields.
    pub fields: u64,
    /// Seed of the ensemble.
    pub seed: u64,
    /// What moved, unless it is the unicycle of a fan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vehicle: Option<VehicleTable>,
    /// The ensemble as steps go by.
    pub rows: Vec<Row>,
    /// How many missions ended for which reason.
    pub ends: BTreeMap<&'static str, u64>,
    /// How many steps climbed to which rung of the recovery ladder.
    pub recoveries: BTreeMap<&'static str, u64>,
    /// Motions planned.
    pub plans: u64,
    /// Mean number of actions whose position a plan looked at.
    pub mean_examined: f64,
    /// The most that one plan looked at.
    pub most_examined: u32,
    /// The size of the action set.
    pub actions: u64,
    /// Of each mission and stage.
    #[serde(skip)]
    pub(crate) checkpoints: Vec<Checkpoint>,
}

impl Measure for Accuracy {
    type Checkpoint = Checkpoint;

    fn stages(&self, steps: u32) -> Vec<u32> {
        let last = (!STEPS.contains(&steps)).then_some(steps);
        STEPS.into_iter().filter(|&stage| stage <= steps).chain(last).collect()
    }

    fn stage(&self, progress: &Progress) -> u32 {
        progress.steps
    }

    fn checkpoint(
        &self,
        mission: &Mission,
        belief: &dyn ReadOut,
        progress: &Progress,
    ) -> Checkpoint {
        let estimates = belief.estimates();
        let errors =
            |estimate: Option<LocalLine>| match (estimate.map(Line::from), mission.world.line()) {
                (Some(line), Some(truth)) => {
                    (line.angle_to_deg(truth), misclassified(mission.config.area, truth, &line))
                }
                _ => (90.0, 0.5),
            };
        let (centre_deg, centre_misclassified) = errors(estimates.centre);
        let (maximum_margin_deg, maximum_margin_misclassified) = errors(estimates.maximum_margin);
        let (bisector_deg, bisector_misclassified) = errors(estimates.bisector);
        Checkpoint {
            field: progress.field,
            step: progress.steps,
            bits: belief.information(),
            centre_deg,
            maximum_margin_deg,
            bisector_deg,
            centre_misclassified,
            maximum_margin_misclassified,
            bisector_misclassified,
            control_cost: progress.control_cost,
            metres: progress.metres,
        }
    }

    fn held(&self, end: &Progress, stage: u32) -> Option<Progress> {
        Some(Progress { steps: stage, ..*end })
    }
}

impl Summary {
    /// What a campaign came to.
    pub fn of(campaign: &Campaign, ensemble: Ensemble<Checkpoint>) -> Self {
        let Ensemble { checkpoints, tally } = ensemble;
        let Tally { ends, recoveries, plans, examined, most_examined } = tally;
        let stages = Accuracy.stages(campaign.steps).len();
        let after = |stage: usize| checkpoints.iter().map(|of| of[stage]).collect::<Vec<_>>();
        Self {
            algorithm: campaign.algorithm,
            fields: campaign.fields,
            seed: campaign.seed,
            vehicle: VehicleTable::of(campaign.vehicle),
            rows: (0..stages).map(|stage| row(&after(stage))).collect(),
            ends,
            recoveries,
            plans,
            mean_examined: examined as f64 / plans as f64,
            most_examined,
            actions: campaign.vehicle.grid().actions(),
            checkpoints: checkpoints.into_iter().flatten().collect(),
        }
    }
}

fn row(checkpoints: &[Checkpoint]) -> Row {
    let spread = |pick: fn(&Checkpoint) -> f64| Spread::of(checkpoints.iter().map(pick));
    let n = checkpoints.len() as f64;
    let mean = |pick: fn(&Checkpoint) -> f64| checkpoints.iter().map(pick).sum::<f64>() / n;
    let step = checkpoints.first().map_or(0, |m| m.step);
    Row {
        step,
        bits_per_step: mean(|m| m.bits) / f64::from(step),
        centre_deg: spread(|m| m.centre_deg),
        maximum_margin_deg: spread(|m| m.maximum_margin_deg),
        bisector_deg: spread(|m| m.bisector_deg),
        centre_misclassified: spread(|m| m.centre_misclassified),
        maximum_margin_misclassified: spread(|m| m.maximum_margin_misclassified),
        bisector_misclassified: spread(|m| m.bisector_misclassified),
        control_cost: mean(|m| m.control_cost),
        metres: mean(|m| m.metres),
    }
}
