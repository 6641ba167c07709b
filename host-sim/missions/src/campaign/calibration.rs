//! The information gained from labels that may be wrong, as a share of what is possible, and whether credible sets hold
//! the line as often as they state.

use anyhow::Result;
use planner_core::{AnyReliability, Line, PosteriorView, Prior, UnknownReliability};
use serde::Serialize;
use serde_with::skip_serializing_none;

use crate::campaign::drawn;
use crate::campaign::ensemble::{Campaign, Measure, Measured, Progress, readings_told};
use crate::campaign::spread::{Spread, Stages, mean};
use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::read_out::{LEVEL, ReadOut};
use crate::mission::results::PTold;
use crate::mission::vehicle::VehicleTable;
use crate::world::noise::limit;

/// The bits learnt, and how often the stated probabilities are right. A mission that ended earlier does not count.
pub struct Calibrated;

/// Labels after which missions are compared.
const LABELS: [u32; 6] = [1, 5, 10, 20, 30, 60];

/// The state of knowledge after some labels of one mission, by the area prior.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Checkpoint {
    field: u64,
    labels: u32,
    bits: f64,
    expected_bits: f64,
    hypotheses: usize,
    pruned_mass: f64,
    mean_deg: f64,
    mean_misclassified: f64,
    control_cost: f64,
    metres: f64,
    credible_probability: f64,
    credible_holds: bool,
}

/// The ensemble after some labels.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// After how many labels.
    pub labels: u32,
    /// Missions that took as many.
    pub missions: u64,
    /// Mean bits learnt.
    pub bits: f64,
    /// `bits` as a share of the most that these labels can carry; `None` if they can carry nothing.
    pub share: Option<f64>,
    /// The bits that these labels were expected to carry, each by the belief before it. It estimates the same mean as
    /// `bits`, without the chance in single labels.
    pub expected_bits: f64,
    /// `expected_bits` as such a share.
    pub expected_share: Option<f64>,
    /// Mean number of hypotheses.
    pub hypotheses: f64,
    /// The largest probability given up, at most.
    pub pruned_mass: f64,
    /// Slope error of the posterior mean, degrees.
    pub mean_deg: Spread,
    /// Share of the area that the posterior mean labels wrongly.
    pub mean_misclassified: Spread,
    /// Mean control cost so far.
    pub control_cost: f64,
    /// Mean metres travelled so far.
    pub metres: f64,
    /// The share of credible sets that hold the truth.
    pub coverage: f64,
    /// The mean probability that they state.
    pub stated: f64,
}

/// The results of a campaign.
#[skip_serializing_none]
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// What was run.
    pub title: String,
    /// Who planned.
    pub algorithm: Algorithm,
    /// Number of standard fields.
    pub fields: u64,
    /// Seed of the ensemble.
    pub seed: u64,
    /// What moved, unless it is the unicycle of a fan.
    pub vehicle: Option<VehicleTable>,
    /// Labels are true with this probability; the mean of the prior where each field's is drawn from it.
    pub p: f64,
    /// Readings of each motion, if there are several.
    pub readings: Option<u32>,
    /// What planners are told instead.
    pub p_told: Option<PTold>,
    /// Whether it is drawn.
    #[serde(skip)]
    pub draws_p: bool,
    /// Bits that a label can tell at most, on average: `1 - H(p)`.
    pub limit: f64,
    /// The ensemble as labels come in.
    pub rows: Vec<Row>,
}

impl Measure for Calibrated {
    type Checkpoint = Checkpoint;

    const WANTS_EXPECTED: bool = true;

    fn stages(&self, _: u32) -> Vec<u32> {
        LABELS.to_vec()
    }

    fn stage(&self, progress: &Progress) -> u32 {
        progress.labels
    }

    /// `None` of a belief without hypotheses.
    fn checkpoint(
        &self,
        mission: &Mission,
        belief: &dyn ReadOut,
        progress: &Progress,
    ) -> Option<Checkpoint> {
        let table = belief.hypotheses()?;
        let by_area = table.weighed_by(Prior::Area);
        let posterior = PosteriorView::new(&by_area);
        let set = posterior.credible(LEVEL);
        let mean = posterior.mean().map(Line::from);
        let degrees = mean.and_then(|it| Some(it.angle_to_deg(mission.world.line()?)));
        let misclassified =
            mean.and_then(|it| mission.world.misclassified(mission.config.area, &it));
        Some(Checkpoint {
            field: progress.field,
            labels: progress.labels,
            bits: posterior.information(),
            expected_bits: progress.expected_bits,
            hypotheses: table.iter().len(),
            pruned_mass: posterior.pruned_mass(),
            mean_deg: degrees.unwrap_or(90.0),
            mean_misclassified: misclassified.unwrap_or(0.5),
            control_cost: progress.control_cost,
            metres: progress.metres,
            credible_probability: set.probability,
            credible_holds: posterior
                .members(&set)
                .any(|it| mission.world.is_among(by_area.lines(it)) == Some(true)),
        })
    }

    fn held(&self, _: &Progress, _: u32) -> Option<Progress> {
        None
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
        let &Campaign { algorithm, fields, seed, noise, .. } = campaign;
        let drawn_from = match campaign.p_told {
            Some(AnyReliability::Unknown(prior)) if campaign.draws_p => Some(prior),
            _ => None,
        };
        let p = drawn_from.map_or(noise.map_or(1.0, |noise| noise.p), UnknownReliability::mean);
        let limit = drawn_from.map_or(limit(p), |prior| drawn::mean(prior, limit));
        let p_told = campaign.p_told.map(PTold::from);
        let mut stages = Stages::<Checkpoint>::new();
        for row in rows {
            let Measured { checkpoint, .. } = row?;
            stages.entry(checkpoint.labels).or_default().push(checkpoint);
        }
        // Labels on the way carry bits as well, and are not counted. And planners that are told another reliability count
        // bits that labels do not carry. Then there are no shares.
        let readings = campaign.several_readings();
        let is_told_otherwise = campaign.p_told.is_some() && !campaign.draws_p;
        let most = if readings.is_some() || is_told_otherwise { 0.0 } else { limit };
        let rows = stages.iter().map(|(&labels, missions)| Row::of(labels, most, missions));
        let rows = rows.collect();
        let title = format!(
            "{}, {fields} standard fields, seed {seed}, {}{}",
            algorithm.title(),
            how_often(p, p_told, campaign.draws_p),
            readings_told(readings)
        );
        let vehicle = VehicleTable::of(campaign.vehicle);
        Ok(Self {
            title,
            algorithm,
            fields,
            seed,
            vehicle,
            p,
            p_told,
            draws_p: campaign.draws_p,
            readings,
            limit,
            rows,
        })
    }
}

/// How often labels are true, and what planners are told of it.
pub fn how_often(p: f64, told: Option<PTold>, is_drawn: bool) -> String {
    match told {
        None => format!("p = {p}"),
        Some(PTold::Number(told)) => format!("p = {p}, told {told}"),
        Some(PTold::Beta([a, b])) if is_drawn => format!("p drawn from Beta({a}, {b}), told so"),
        Some(PTold::Beta([a, b])) => format!("p = {p}, told Beta({a}, {b})"),
    }
}

impl Row {
    /// Of missions after so many labels, each of which carries at most `limit` bits on average.
    fn of(labels: u32, limit: f64, missions: &[Checkpoint]) -> Self {
        let mean = |figure: fn(&Checkpoint) -> f64| mean(missions, figure);
        // A share of zero is undefined. By chance few labels can tell more than labels carry on average.
        let share =
            |bits: f64| (limit > 0.0).then(|| (bits / f64::from(labels) / limit).clamp(0.0, 1.0));
        let (bits, expected_bits) = (mean(|it| it.bits), mean(|it| it.expected_bits));
        Self {
            labels,
            missions: missions.len() as u64,
            bits,
            share: share(bits),
            expected_bits,
            expected_share: share(expected_bits),
            hypotheses: mean(|it| it.hypotheses as f64),
            pruned_mass: missions.iter().map(|it| it.pruned_mass).fold(0.0, f64::max),
            mean_deg: Spread::of(missions, |it| it.mean_deg),
            mean_misclassified: Spread::of(missions, |it| it.mean_misclassified),
            control_cost: mean(|it| it.control_cost),
            metres: mean(|it| it.metres),
            coverage: mean(|it| f64::from(u8::from(it.credible_holds))),
            stated: mean(|it| it.credible_probability),
        }
    }
}
