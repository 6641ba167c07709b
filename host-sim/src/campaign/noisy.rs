//! Campaigns with noisy labels: what is learnt against what labels can tell, and whether the
//! probabilities that are stated hold.

use std::fmt::Write as _;

use anyhow::Result;
use planner_core::belief::hypotheses::{Hypothesis, Prior};
use planner_core::belief::posterior::Posterior;
use planner_core::planner::scc::Policy;
use serde::Serialize;

use crate::campaign::ensemble::{Campaign, Spread, on_all_cores};
use crate::campaign::standard_field;
use crate::mission::definition::{Known, Mission, Table};
use crate::mission::recording::{LEVEL, cost};
use crate::output::file;
use crate::world::truth::{self, Extent, NoiseModel};

/// What to run.
#[derive(Clone, Copy, Debug)]
pub struct NoisyCampaign {
    /// Who plans, and in which fields.
    pub fields: Campaign,
    /// Labels are true with this probability.
    pub p: f64,
    /// Within this distance of the oracle's points labels are certain, metres.
    pub trusted_radius: f64,
    /// How hypotheses choose an action together.
    pub policy: Policy,
    /// How they are weighed in that.
    pub prior: Prior,
}

/// Labels after which missions are compared.
const MARKS: [usize; 6] = [1, 5, 10, 20, 30, 60];

/// Bins of stated probabilities, each with as many missions.
const BINS: usize = 5;

/// What a posterior states of one mission, and whether it is so.
#[derive(Clone, Copy, Debug, Serialize)]
struct Statement {
    credible_probability: f64,
    credible_holds: bool,
    best_probability: f64,
    best_holds: bool,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Mark {
    field: u64,
    labels: usize,
    bits: f64,
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
    pub labels: usize,
    /// Missions that took as many.
    pub missions: u64,
    /// Mean bits learnt.
    pub bits: f64,
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
    title: String,
    /// Labels are true with this probability.
    pub p: f64,
    /// Bits that a label can tell at most, on average: `1 - H(p)`.
    pub limit: f64,
    /// The ensemble as labels come in.
    pub rows: Vec<Row>,
    #[serde(skip)]
    marks: Vec<Mark>,
}

/// Bits that a label which is true with probability `p` can tell at most: `1 - H(p)`.
pub fn limit(p: f64) -> f64 {
    let term = |p: f64| if p > 0.0 { p * libm::log2(p) } else { 0.0 };
    1.0 + term(p) + term(1.0 - p)
}

impl NoisyCampaign {
    /// Runs all fields on all cores, with a progress bar on a terminal.
    ///
    /// # Errors
    /// Names the field in which a trusted label left no hypothesis: never, as those are true.
    pub fn run(&self) -> Result<Summary> {
        let outcomes = on_all_cores(self.fields.fields, |number| self.outcome(number))?;
        let marks: Vec<_> = outcomes.into_iter().flatten().collect();
        let rows = MARKS.iter().filter_map(|&labels| {
            let of: Vec<_> = marks.iter().filter(|m| m.labels == labels).copied().collect();
            (!of.is_empty()).then(|| row(labels, &of))
        });
        let Campaign { algorithm, fields, seed, .. } = self.fields;
        let title =
            format!("{}, {fields} standard fields, seed {seed}, p = {}", algorithm.title(), self.p);
        Ok(Summary { title, p: self.p, limit: limit(self.p), rows: rows.collect(), marks })
    }

    fn outcome(&self, number: u64) -> Result<Vec<Mark>> {
        let Campaign { algorithm, steps, seed, crossing, following, .. } = self.fields;
        let mut mission = standard_field::standard(seed, number, algorithm, steps);
        (mission.config.crossing, mission.config.following) = (crossing, following);
        let extent = Extent::OutsideBalls(self.trusted_radius);
        mission.noise = Some(NoiseModel { p: self.p, extent });
        (mission.policy, mission.prior) = (self.policy, self.prior);
        let (mut marks, mut spent, mut labels) = (Vec::new(), 0.0, 0);
        mission.run(|step, known| {
            spent += cost(step);
            let Known::Hypotheses(table) = known else { return };
            if table.taken() > labels {
                labels = table.taken();
                if MARKS.contains(&labels) {
                    marks.push(mark(number, &mission, table, spent));
                }
            }
        })?;
        Ok(marks)
    }
}

fn mark(field: u64, mission: &Mission, table: &Table, control_cost: f64) -> Mark {
    let by_area = table.weighed_by(Prior::Area);
    let by_area = Posterior::new(&by_area);
    let statement = |prior| {
        let table = &table.weighed_by(prior);
        let posterior = Posterior::new(table);
        let set = posterior.credible(LEVEL);
        let holds = |h: &Hypothesis<15>| truth::agrees(&mission.truth, table.candidates(h));
        let best = posterior.best().expect("a hypothesis");
        Statement {
            credible_probability: set.probability,
            credible_holds: posterior.members(&set).any(holds),
            best_probability: best.probability,
            best_holds: holds(best.hypothesis),
        }
    };
    Mark {
        field,
        labels: table.taken(),
        bits: by_area.information(),
        hypotheses: table.iter().len(),
        pruned_mass: by_area.lost(),
        mean_deg: by_area.mean().map_or(90.0, |line| line.angle_to_deg(&mission.truth)),
        control_cost,
        by_prior: [Prior::Area, Prior::Sequences].map(statement),
    }
}

fn row(labels: usize, marks: &[Mark]) -> Row {
    let n = marks.len() as f64;
    let mean = |pick: fn(&Mark) -> f64| marks.iter().map(pick).sum::<f64>() / n;
    Row {
        labels,
        missions: marks.len() as u64,
        bits: mean(|m| m.bits),
        hypotheses: mean(|m| m.hypotheses as f64),
        pruned_mass: marks.iter().map(|m| m.pruned_mass).fold(0.0, f64::max),
        mean_deg: Spread::of(marks.iter().map(|m| m.mean_deg)),
        control_cost: mean(|m| m.control_cost),
        calibration: [0, 1].map(|prior| {
            let of = marks.iter().map(|m| m.by_prior[prior]);
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

impl Summary {
    /// The tables for people.
    pub fn report(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_report(&mut text);
        text
    }

    fn write_report(&self, text: &mut String) -> std::fmt::Result {
        writeln!(text, "{}; a label tells {:.4} bits at most\n", self.title, self.limit)?;
        writeln!(
            text,
            "{:>6} {:>8} {:>7} {:>10} {:>9} {:>11} {:>8} {:^26} {:>7}",
            "labels",
            "missions",
            "bits",
            "bits/label",
            "of limit",
            "hypotheses",
            "pruned",
            "mean line, slope error deg",
            "cost"
        )?;
        for row in &self.rows {
            let each = row.bits / row.labels as f64;
            let Spread { median, p90, worst } = row.mean_deg;
            // Of nothing there is no share.
            let share = (self.limit > 0.0).then(|| 100.0 * each / self.limit);
            writeln!(
                text,
                "{:>6} {:>8} {:>7.3} {each:>10.4} {:>9} {:>11.1} {:>8.4} {median:>8.3} {p90:>8.3} {worst:>8.3} {:>7.1}",
                row.labels,
                row.missions,
                row.bits,
                share.map_or("-".into(), |share| format!("{share:.1}%")),
                row.hypotheses,
                row.pruned_mass,
                row.control_cost,
            )?;
        }
        for (prior, name) in ["area prior", "the paper's prior"].into_iter().enumerate() {
            writeln!(text, "\nBy the {}:", name.trim_start_matches("the "))?;
            writeln!(
                text,
                "{:>6}  {:>8} {:>7}  best hypothesis in five bins: mean stated > share that hold the truth",
                "labels", "coverage", "stated"
            )?;
            for row in &self.rows {
                let Calibration { coverage, stated, best } = &row.calibration[prior];
                let bins: Vec<_> =
                    best.iter().map(|(_, stated, hit)| format!("{stated:.3} > {hit:.3}")).collect();
                writeln!(
                    text,
                    "{:>6}  {coverage:>8.3} {stated:>7.3}  {}",
                    row.labels,
                    bins.join(" | ")
                )?;
            }
        }
        Ok(())
    }

    /// A row for each field and mark, as CSV.
    ///
    /// # Errors
    /// When a row could not be written.
    pub fn csv(&self) -> Result<String> {
        file::csv(&self.marks)
    }
}
