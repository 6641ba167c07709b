//! What labels that may err tell of what they can tell, and whether the probabilities that are stated hold.

use planner_core::belief::hypotheses::Hypothesis;
use planner_core::belief::posterior::Posterior;
use planner_core::belief::sample::Sample;
use planner_core::belief::weight::Prior;
use planner_core::geometry::line::Line;
use serde::Serialize;

use crate::campaign::ensemble::{Campaign, Ensemble, Measure, Progress};
use crate::campaign::spread::Spread;
use crate::mission::algorithm::Algorithm;
use crate::mission::definition::{Mission, Table};
use crate::mission::read_out::{LEVEL, ReadOut};
use crate::mission::vehicle::VehicleTable;
use crate::world::noise::limit;

/// Bits told, and how often what is stated is so. A mission that ended earlier does not count.
pub struct Calibrated;

/// Labels after which missions are compared.
const LABELS: [u32; 6] = [1, 5, 10, 20, 30, 60];

/// Bins of stated probabilities, each with as many missions.
const BINS: usize = 5;

/// What a posterior states of one mission, and whether it is so.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Statement {
    credible_probability: f64,
    credible_holds: bool,
    best_probability: f64,
    best_holds: bool,
}

/// What was known after some labels of one mission.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Checkpoint {
    field: u64,
    labels: u32,
    bits: f64,
    expected_bits: f64,
    hypotheses: usize,
    pruned_mass: f64,
    mean_deg: f64,
    control_cost: f64,
    #[serde(skip)]
    by_prior: [Statement; 2],
}

/// How often what is stated is so, by one prior.
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
    /// The share of what so many labels can tell at most; `None` where they can tell nothing.
    pub share: Option<f64>,
    /// What these labels were expected to tell, each where it was read and by what was known then: the mean of
    /// `bits` without the chance in single labels.
    pub expected_bits: f64,
    /// The same as a share.
    pub expected_share: Option<f64>,
    /// Mean number of hypotheses.
    pub hypotheses: f64,
    /// The largest probability given up, at most.
    pub pruned_mass: f64,
    /// Slope error of the posterior mean, degrees.
    pub mean_deg: Spread,
    /// Mean control cost so far.
    pub control_cost: f64,
    /// By the area prior and by the paper's.
    pub calibration: [Calibration; 2],
}

/// What a campaign came to.
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
    /// Labels are true with this probability.
    pub p: f64,
    /// Bits that a label can tell at most, on average: `1 - H(p)`.
    pub limit: f64,
    /// The ensemble as labels come in.
    pub rows: Vec<Row>,
    /// Of each mission and stage.
    #[serde(skip)]
    pub(crate) checkpoints: Vec<Checkpoint>,
}

impl Measure for Calibrated {
    type Checkpoint = Option<Checkpoint>;

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
        let by_area = Posterior::new(&by_area);
        let statement = |prior| {
            let table = &table.weighed_by(prior);
            let posterior = Posterior::new(table);
            let set = posterior.credible(LEVEL);
            let holds = |h: &Hypothesis<15>| mission.world.is_among(table.lines(h)) == Some(true);
            let best = posterior.best().expect("a hypothesis");
            Statement {
                credible_probability: set.probability,
                credible_holds: posterior.members(&set).any(holds),
                best_probability: best.probability,
                best_holds: holds(best.hypothesis),
            }
        };
        let error = |line| mission.world.line().map(|truth| Line::from(line).angle_to_deg(truth));
        Some(Checkpoint {
            field: progress.field,
            labels: progress.labels,
            bits: by_area.information(),
            expected_bits: expected(mission, table),
            hypotheses: table.iter().len(),
            pruned_mass: by_area.pruned_mass(),
            mean_deg: by_area.mean().and_then(error).unwrap_or(90.0),
            control_cost: progress.control_cost,
            by_prior: [Prior::Area, Prior::Sequences].map(statement),
        })
    }

    fn held(&self, _: &Progress, _: u32) -> Option<Progress> {
        None
    }
}

impl Summary {
    /// What a campaign came to.
    pub fn of(campaign: &Campaign, ensemble: Ensemble<Option<Checkpoint>>) -> Self {
        let &Campaign { algorithm, fields, seed, noise, .. } = campaign;
        let p = noise.map_or(1.0, |noise| noise.p);
        let checkpoints: Vec<_> = ensemble.checkpoints.into_iter().flatten().flatten().collect();
        let rows = LABELS.iter().filter_map(|&labels| {
            let of: Vec<_> = checkpoints.iter().filter(|m| m.labels == labels).copied().collect();
            (!of.is_empty()).then(|| row(labels, limit(p), &of))
        });
        let title =
            format!("{}, {fields} standard fields, seed {seed}, p = {p}", algorithm.title());
        let (vehicle, rows) = (VehicleTable::of(campaign.vehicle), rows.collect());
        Self { title, algorithm, fields, seed, vehicle, p, limit: limit(p), rows, checkpoints }
    }
}

/// What the labels of a table were expected to tell, by the exact distribution before each.
fn expected(mission: &Mission, table: &Table) -> f64 {
    let mut known = mission.table();
    let given = known.samples().len();
    let told = table.samples().iter().skip(given).map(|&Sample { site, label }| {
        let told = known.expects(site).bits;
        known.read(site, label).expect("taken in once already");
        told
    });
    told.sum()
}

fn row(labels: u32, limit: f64, checkpoints: &[Checkpoint]) -> Row {
    let n = checkpoints.len() as f64;
    let mean = |pick: fn(&Checkpoint) -> f64| checkpoints.iter().map(pick).sum::<f64>() / n;
    let (bits, expected_bits) = (mean(|m| m.bits), mean(|m| m.expected_bits));
    // Of nothing there is no share.
    let share = |bits: f64| (limit > 0.0).then(|| bits / f64::from(labels) / limit);
    Row {
        labels,
        missions: checkpoints.len() as u64,
        bits,
        share: share(bits),
        expected_bits,
        expected_share: share(expected_bits),
        hypotheses: mean(|m| m.hypotheses as f64),
        pruned_mass: checkpoints.iter().map(|m| m.pruned_mass).fold(0.0, f64::max),
        mean_deg: Spread::of(checkpoints.iter().map(|m| m.mean_deg)),
        control_cost: mean(|m| m.control_cost),
        calibration: [0, 1].map(|prior| {
            let of = checkpoints.iter().map(|m| m.by_prior[prior]);
            calibration(&of.collect::<Vec<_>>())
        }),
    }
}

fn calibration(statements: &[Statement]) -> Calibration {
    let n = statements.len() as f64;
    let share = |holds: bool| f64::from(u8::from(holds));
    let mut sorted = statements.to_vec();
    sorted.sort_by(|a, b| a.best_probability.total_cmp(&b.best_probability));
    let bin = |of: &[Statement]| {
        let n = of.len() as f64;
        let stated = of.iter().map(|s| s.best_probability).sum::<f64>() / n;
        let holds = of.iter().map(|s| share(s.best_holds)).sum::<f64>() / n;
        (of.len() as u64, stated, holds)
    };
    let best = sorted.chunks(sorted.len().div_ceil(BINS)).map(bin);
    Calibration {
        coverage: statements.iter().map(|s| share(s.credible_holds)).sum::<f64>() / n,
        stated: statements.iter().map(|s| s.credible_probability).sum::<f64>() / n,
        best: best.collect(),
    }
}
