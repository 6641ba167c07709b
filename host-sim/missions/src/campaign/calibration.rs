//! The information gained from labels that may be wrong, as a share of what is possible, and whether the stated
//! probabilities hold.

use std::collections::BTreeMap;

use anyhow::Result;
use planner_core::belief::doubtful_labels::Hypothesis;
use planner_core::{AnyReliability, Line, PosteriorView, Prior, UnknownReliability};
use serde::Serialize;

use crate::campaign::drawn;
use crate::campaign::ensemble::{Campaign, Measure, Measured, Progress, readings_told};
use crate::campaign::sorting::{Sorted, Value, sorted};
use crate::campaign::spread::Spread;
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

/// Bins of stated probabilities, each with as many missions.
const BINS: u64 = 5;

/// The statements of a posterior about one mission, and whether they hold.
#[derive(Clone, Copy, Debug)]
struct Statement {
    credible_probability: f64,
    credible_holds: bool,
    best_probability: f64,
    best_holds: bool,
}

/// The state of knowledge after some labels of one mission. Statements are by the area prior and by the paper's.
#[allow(clippy::struct_excessive_bools)] // columns of a row, which has no nesting
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
    area_credible_probability: f64,
    area_credible_holds: bool,
    area_best_probability: f64,
    area_best_holds: bool,
    paper_credible_probability: f64,
    paper_credible_holds: bool,
    paper_best_probability: f64,
    paper_best_holds: bool,
}

/// How often statements hold, by one prior.
#[derive(Clone, Debug, Serialize)]
pub struct Calibration {
    /// The share of credible sets that hold the truth.
    pub coverage: f64,
    /// The mean probability that they state.
    pub stated: f64,
    /// The missions in bins of equal size by the best hypothesis's stated probability: how many, the
    /// mean stated, and the share whose best hypothesis holds the truth.
    pub best: Vec<(u64, f64, f64)>,
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
    /// By the area prior and by the paper's.
    pub calibration: [Calibration; 2],
}

/// The results of a campaign.
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
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vehicle: Option<VehicleTable>,
    /// Labels are true with this probability; the mean of the prior where each field's is drawn from it.
    pub p: f64,
    /// Readings of each motion, if there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub readings: Option<u32>,
    /// What planners are told instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_told: Option<PTold>,
    /// Whether it is drawn.
    #[serde(skip)]
    pub draws_p: bool,
    /// Bits that a label can tell at most, on average: `1 - H(p)`.
    pub limit: f64,
    /// The ensemble as labels come in.
    pub rows: Vec<Row>,
}

impl Checkpoint {
    /// By the area prior and by the paper's.
    fn statements(&self) -> [Statement; 2] {
        [
            Statement {
                credible_probability: self.area_credible_probability,
                credible_holds: self.area_credible_holds,
                best_probability: self.area_best_probability,
                best_holds: self.area_best_holds,
            },
            Statement {
                credible_probability: self.paper_credible_probability,
                credible_holds: self.paper_credible_holds,
                best_probability: self.paper_best_probability,
                best_holds: self.paper_best_holds,
            },
        ]
    }
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
        let by_area = PosteriorView::new(&by_area);
        let statement = |prior| {
            let table = &table.weighed_by(prior);
            let posterior = PosteriorView::new(table);
            let set = posterior.credible(LEVEL);
            let holds = |h: &Hypothesis<15, AnyReliability>| {
                mission.world.is_among(table.lines(h)) == Some(true)
            };
            let best = posterior.best().expect("a hypothesis");
            Statement {
                credible_probability: set.probability,
                credible_holds: posterior.members(&set).any(holds),
                best_probability: best.probability,
                best_holds: holds(best.hypothesis),
            }
        };
        let [area, paper] = [Prior::Area, Prior::Sequences].map(statement);
        let mean = by_area.mean().map(Line::from);
        let degrees = mean.and_then(|it| Some(it.angle_to_deg(mission.world.line()?)));
        let misclassified =
            mean.and_then(|it| mission.world.misclassified(mission.config.area, &it));
        Some(Checkpoint {
            field: progress.field,
            labels: progress.labels,
            bits: by_area.information(),
            expected_bits: progress.expected_bits,
            hypotheses: table.iter().len(),
            pruned_mass: by_area.pruned_mass(),
            mean_deg: degrees.unwrap_or(90.0),
            mean_misclassified: misclassified.unwrap_or(0.5),
            control_cost: progress.control_cost,
            metres: progress.metres,
            area_credible_probability: area.credible_probability,
            area_credible_holds: area.credible_holds,
            area_best_probability: area.best_probability,
            area_best_holds: area.best_holds,
            paper_credible_probability: paper.credible_probability,
            paper_credible_holds: paper.credible_holds,
            paper_best_probability: paper.best_probability,
            paper_best_holds: paper.best_holds,
        })
    }

    fn held(&self, _: &Progress, _: u32) -> Option<Progress> {
        None
    }
}

/// Sums over the missions at one stage.
#[derive(Debug, Default)]
struct Sums {
    missions: u64,
    bits: f64,
    expected_bits: f64,
    hypotheses: f64,
    pruned_mass: f64,
    control_cost: f64,
    metres: f64,
    by_prior: [StatementSums; 2],
}

/// Sums over what one prior states.
#[derive(Clone, Copy, Debug, Default)]
struct StatementSums {
    credible_probability: f64,
    credible_holds: f64,
}

/// What is sorted at a stage: the errors of the mean, and the best hypothesis's probability by either prior, each marked with
/// whether it holds the truth.
const SORTED: u32 = 4;

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
        let (mut stages, mut values) = (BTreeMap::<u32, Sums>::new(), Vec::new());
        for row in rows {
            let Measured { checkpoint, .. } = row?;
            stages.entry(checkpoint.labels).or_default().add(&checkpoint);
            let [area, paper] = checkpoint.statements();
            let slots = SORTED * checkpoint.labels..;
            for (slot, (value, mark)) in slots.zip([
                (checkpoint.mean_deg, false),
                (checkpoint.mean_misclassified, false),
                (area.best_probability, area.best_holds),
                (paper.best_probability, paper.best_holds),
            ]) {
                values.push(Value { slot, number: value, is_marked: mark });
            }
        }
        let mut sorted = sorted(values);
        // Labels on the way carry bits as well, and are not counted. And planners that are told another reliability count
        // bits that labels do not carry. Then there are no shares.
        let readings = campaign.several_readings();
        let is_told_otherwise = campaign.p_told.is_some() && !campaign.draws_p;
        let most = if readings.is_some() || is_told_otherwise { 0.0 } else { limit };
        let rows = stages.iter().map(|(&labels, sums)| sums.row(labels, most, &mut sorted));
        let rows = rows.collect::<Result<_>>()?;
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

/// 1 for what holds, so that sums count.
fn share(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

impl Sums {
    fn add(&mut self, checkpoint: &Checkpoint) {
        self.missions += 1;
        self.bits += checkpoint.bits;
        self.expected_bits += checkpoint.expected_bits;
        self.hypotheses += checkpoint.hypotheses as f64;
        self.pruned_mass = self.pruned_mass.max(checkpoint.pruned_mass);
        self.control_cost += checkpoint.control_cost;
        self.metres += checkpoint.metres;
        for (sums, statement) in self.by_prior.iter_mut().zip(checkpoint.statements()) {
            sums.credible_probability += statement.credible_probability;
            sums.credible_holds += share(statement.credible_holds);
        }
    }

    fn row(&self, labels: u32, limit: f64, sorted: &mut Sorted) -> Result<Row> {
        let mean = |sum: f64| sum / self.missions as f64;
        let (bits, expected_bits) = (mean(self.bits), mean(self.expected_bits));
        // A share of zero is undefined. By chance few labels can tell more than labels carry on average.
        let share =
            |bits: f64| (limit > 0.0).then(|| (bits / f64::from(labels) / limit).clamp(0.0, 1.0));
        Ok(Row {
            labels,
            missions: self.missions,
            bits,
            share: share(bits),
            expected_bits,
            expected_share: share(expected_bits),
            hypotheses: mean(self.hypotheses),
            pruned_mass: self.pruned_mass,
            mean_deg: Spread::of(sorted, self.missions)?,
            mean_misclassified: Spread::of(sorted, self.missions)?,
            control_cost: mean(self.control_cost),
            metres: mean(self.metres),
            calibration: [
                calibration(self.by_prior[0], self.missions, sorted),
                calibration(self.by_prior[1], self.missions, sorted),
            ],
        })
    }
}

/// The calibration by one prior, from its sums and the next `missions` sorted probabilities.
fn calibration(sums: StatementSums, missions: u64, sorted: &mut Sorted) -> Calibration {
    let size = missions.div_ceil(BINS);
    let mut best = Vec::new();
    for start in (0..missions).step_by(size as usize) {
        let n = size.min(missions - start);
        let (mut stated, mut holds) = (0.0, 0.0);
        for value in sorted.take(n as usize) {
            stated += value.number;
            holds += share(value.is_marked);
        }
        best.push((n, stated / n as f64, holds / n as f64));
    }
    let n = missions as f64;
    Calibration { coverage: sums.credible_holds / n, stated: sums.credible_probability / n, best }
}
