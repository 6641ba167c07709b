//! The accuracy of the line after a number of steps with true labels, and its cost.

use std::collections::BTreeMap;

use anyhow::Result;
use planner_core::dynamics::Dynamics as _;
use serde::Serialize;
use serde_with::skip_serializing_none;

use crate::campaign::course::Course;
use crate::campaign::ensemble::{Campaign, Measure, Measured, Progress};
use crate::campaign::spread::{Spread, Stages, mean};
use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::read_out::ReadOut;
use crate::mission::recording::beside_truth;
use crate::mission::results::LineRecord;
use crate::mission::vehicle::VehicleTable;

/// Steps at which missions are compared.
const STEPS: [u32; 8] = [1, 2, 5, 10, 20, 30, 40, 60];

/// The accuracy of the three estimates. A mission that ended earlier counts with what it knew at its end.
pub struct Accuracy {
    /// Whether missions are compared after so many labels, and not steps.
    pub by_label: bool,
}

/// The state of knowledge after some steps of one mission.
#[derive(Clone, Debug, Default, Serialize)]
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

/// The results of a campaign.
#[skip_serializing_none]
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Who planned.
    pub algorithm: Algorithm,
    /// Number of standard fields.
    pub fields: u64,
    /// Seed of the ensemble.
    pub seed: u64,
    /// What moved, unless it is the unicycle of a fan.
    pub vehicle: Option<VehicleTable>,
    /// Readings of each motion, if there are several.
    pub readings: Option<u32>,
    /// The ensemble as steps go by.
    pub rows: Vec<Row>,
    /// How many missions ended for which reason.
    pub ends: BTreeMap<String, u64>,
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
}

impl Measure for Accuracy {
    type Checkpoint = Checkpoint;

    const WANTS_EXPECTED: bool = false;

    fn stages(&self, steps: u32) -> Vec<u32> {
        let last = (!STEPS.contains(&steps)).then_some(steps);
        STEPS.into_iter().filter(|&stage| stage <= steps).chain(last).collect()
    }

    fn stage(&self, progress: &Progress) -> u32 {
        if self.by_label { progress.labels } else { progress.steps }
    }

    fn checkpoint(
        &self,
        mission: &Mission,
        belief: &dyn ReadOut,
        progress: &Progress,
    ) -> Option<Checkpoint> {
        let estimates = beside_truth(mission, &mission.world, belief.estimates());
        let errors = |estimate: Option<LineRecord>| {
            let error = estimate.and_then(|line| line.error);
            error.map_or((90.0, 0.5), |it| (it.degrees, it.misclassified))
        };
        let (centre_deg, centre_misclassified) = errors(estimates.centre);
        let (maximum_margin_deg, maximum_margin_misclassified) = errors(estimates.maximum_margin);
        let (bisector_deg, bisector_misclassified) = errors(estimates.bisector);
        Some(Checkpoint {
            field: progress.field,
            step: self.stage(progress),
            bits: belief.information(),
            centre_deg,
            maximum_margin_deg,
            bisector_deg,
            centre_misclassified,
            maximum_margin_misclassified,
            bisector_misclassified,
            control_cost: progress.control_cost,
            metres: progress.metres,
        })
    }

    fn held(&self, end: &Progress, stage: u32) -> Option<Progress> {
        Some(if self.by_label {
            Progress { labels: stage, ..*end }
        } else {
            Progress { steps: stage, ..*end }
        })
    }
}

impl Summary {
    /// The results of a campaign, from its rows in the order of the fields.
    ///
    /// # Errors
    /// The first error of a row.
    pub fn of(
        campaign: &Campaign,
        rows: impl IntoIterator<Item = Result<Measured<Checkpoint>>>,
    ) -> Result<Self> {
        let (mut stages, mut whole) = (Stages::<Checkpoint>::new(), Vec::<Course>::new());
        for row in rows {
            let Measured { checkpoint, course } = row?;
            if checkpoint.step == campaign.length() {
                whole.push(course);
            }
            stages.entry(checkpoint.step).or_default().push(checkpoint);
        }
        let (mut ends, mut recoveries) = (BTreeMap::new(), BTreeMap::new());
        for course in &whole {
            *ends.entry(course.ended.clone()).or_default() += 1;
            for (rung, times) in course.rungs().into_iter().filter(|(_, times)| *times > 0) {
                *recoveries.entry(rung).or_default() += times;
            }
        }
        let plans = whole.iter().map(|it| it.plans).sum();
        let examined = whole.iter().map(|it| it.examined).sum::<u64>();
        Ok(Self {
            algorithm: campaign.algorithm,
            fields: campaign.fields,
            seed: campaign.seed,
            vehicle: VehicleTable::of(campaign.vehicle),
            readings: campaign.several_readings(),
            rows: stages.iter().map(|(&step, missions)| Row::of(step, missions)).collect(),
            ends,
            recoveries,
            plans,
            mean_examined: examined as f64 / plans as f64,
            most_examined: whole.iter().map(|it| it.most_examined).max().unwrap_or(0),
            actions: campaign.vehicle.grid().actions(),
        })
    }
}

impl Row {
    fn of(step: u32, missions: &[Checkpoint]) -> Self {
        let spread = |figure: fn(&Checkpoint) -> f64| Spread::of(missions, figure);
        Self {
            step,
            bits_per_step: mean(missions, |it| it.bits) / f64::from(step),
            centre_deg: spread(|it| it.centre_deg),
            maximum_margin_deg: spread(|it| it.maximum_margin_deg),
            bisector_deg: spread(|it| it.bisector_deg),
            centre_misclassified: spread(|it| it.centre_misclassified),
            maximum_margin_misclassified: spread(|it| it.maximum_margin_misclassified),
            bisector_misclassified: spread(|it| it.bisector_misclassified),
            control_cost: mean(missions, |it| it.control_cost),
            metres: mean(missions, |it| it.metres),
        }
    }
}
