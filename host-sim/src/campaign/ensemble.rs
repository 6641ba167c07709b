//! Campaigns: many standard fields on all cores, and the table of what came of them.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use anyhow::{Context as _, Result};
use indicatif::{ParallelProgressIterator as _, ProgressBar, ProgressStyle};
use planner_core::belief::estimate::{self, Estimates};
use planner_core::belief::version_space::VersionSpace;
use planner_core::geometry::line::Line;
use planner_core::motion::dynamics::Dynamics as _;
use planner_core::motion::unicycle::Unicycle;
use planner_core::planner::config::{Crossing, Following};
use rayon::prelude::*;
use serde::Serialize;

use crate::campaign::standard_field;
use crate::mission::definition::{Algorithm, CAPACITY, Known, Mission};
use crate::mission::recording::{cost, recovery_name};
use crate::output::file;
use crate::world::polygon::misclassified;

/// What to run.
#[derive(Clone, Copy, Debug)]
pub struct Campaign {
    /// Who plans.
    pub algorithm: Algorithm,
    /// Number of standard fields.
    pub fields: u64,
    /// Steps in each.
    pub steps: u32,
    /// Seed of the ensemble.
    pub seed: u64,
    /// How P1 looks for the opposite label.
    pub crossing: Crossing,
    /// How P2 follows the boundary.
    pub following: Following,
}

/// Steps at which missions are compared.
const MARKS: [u32; 8] = [1, 2, 5, 10, 20, 30, 40, 60];

/// What was known after some steps of one mission. A mission that ended earlier counts with what it
/// knew at its end.
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Mark {
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

/// One mission's marks and how it went.
struct Outcome {
    marks: Vec<Mark>,
    end: &'static str,
    examined: u64,
    plans: u64,
    most_examined: u32,
    recoveries: BTreeMap<&'static str, u64>,
}

/// Median, 90th percentile and worst.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Half are at most this.
    pub median: f64,
    /// Nine in ten are at most this.
    pub p90: f64,
    /// The largest.
    pub worst: f64,
}

impl Spread {
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<_> = values.collect();
        values.sort_by(f64::total_cmp);
        // Nearest rank: the smallest value that at least this share do not exceed.
        let rank = |tenths: usize| values[(values.len() * tenths).div_ceil(10).max(1) - 1];
        Self { median: rank(5), p90: rank(9), worst: rank(10) }
    }
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
    pub actions: u32,
    #[serde(skip)]
    marks: Vec<Mark>,
}

impl Campaign {
    /// Runs all fields on all cores, with a progress bar on a terminal.
    ///
    /// # Errors
    /// Names the field in which a sample contradicted what was known: never, as labels are true.
    pub fn run(&self) -> Result<Summary> {
        let outcomes = on_all_cores(self.fields, |number| self.outcome(number))?;
        Ok(self.summary(&outcomes))
    }

    fn marks(&self) -> impl Iterator<Item = u32> {
        let steps = self.steps;
        let last = (!MARKS.contains(&steps)).then_some(steps);
        MARKS.into_iter().filter(move |&mark| mark <= steps).chain(last)
    }

    fn outcome(&self, number: u64) -> Result<Outcome> {
        let mut mission = standard_field::standard(self.seed, number, self.algorithm, self.steps);
        (mission.config.crossing, mission.config.following) = (self.crossing, self.following);
        let known = |space: &VersionSpace<CAPACITY>, so_far: Mark| mark(&mission, space, so_far);
        let mut now = known(&mission.space, Mark { field: number, ..Mark::default() });
        let (mut marks, mut due) = (Vec::new(), self.marks().peekable());
        let mut recoveries = BTreeMap::new();
        let (mut examined, mut most_examined) = (0, 0);
        let end = mission.run(|taken, now_known| {
            let Known::Lines(space) = now_known else { return };
            now.step += 1;
            now.control_cost += cost(taken);
            now.metres += f64::from(taken.motion.control.v);
            now = known(space, now);
            if due.next_if_eq(&now.step).is_some() {
                marks.push(now);
            }
            examined += u64::from(taken.motion.examined);
            most_examined = most_examined.max(taken.motion.examined);
            if let Some(recovery) = taken.motion.recovery {
                *recoveries.entry(recovery_name(recovery)).or_default() += 1;
            }
        })?;
        let plans = u64::from(now.step);
        marks.extend(due.map(|step| Mark { step, ..now }));
        Ok(Outcome { marks, end: end.name(), examined, plans, most_examined, recoveries })
    }

    fn summary(&self, outcomes: &[Outcome]) -> Summary {
        let count = |pick: fn(&Outcome) -> &BTreeMap<&'static str, u64>| {
            outcomes.iter().flat_map(pick).fold(BTreeMap::new(), |mut all, (&name, n)| {
                *all.entry(name).or_default() += n;
                all
            })
        };
        let mut ends = BTreeMap::new();
        for outcome in outcomes {
            *ends.entry(outcome.end).or_default() += 1;
        }
        let plans: u64 = outcomes.iter().map(|o| o.plans).sum();
        let examined: u64 = outcomes.iter().map(|o| o.examined).sum();
        Summary {
            algorithm: self.algorithm,
            fields: self.fields,
            seed: self.seed,
            rows: (0..self.marks().count())
                .map(|i| row(&outcomes.iter().map(|o| o.marks[i]).collect::<Vec<_>>()))
                .collect(),
            ends,
            recoveries: count(|o| &o.recoveries),
            plans,
            mean_examined: examined as f64 / plans as f64,
            most_examined: outcomes.iter().map(|o| o.most_examined).max().unwrap_or(0),
            actions: Unicycle::paper().grid().actions(),
            marks: outcomes.iter().flat_map(|o| o.marks.iter().copied()).collect(),
        }
    }
}

/// What comes of each field, on all cores, with a progress bar on a terminal.
///
/// # Errors
/// Names the field whose mission failed.
pub(crate) fn on_all_cores<T: Send>(
    fields: u64,
    outcome: impl Fn(u64) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let style = "{bar:40} {pos}/{len} fields  {per_sec}  {eta} left";
    let bar = ProgressBar::new(fields).with_style(ProgressStyle::with_template(style)?);
    let outcomes = (0..fields)
        .into_par_iter()
        .progress_with(bar.clone())
        .map(|number| outcome(number).with_context(|| format!("field {number}")))
        .collect();
    bar.finish_and_clear();
    outcomes
}

fn mark(mission: &Mission, space: &VersionSpace<CAPACITY>, so_far: Mark) -> Mark {
    let estimates = Estimates::of(space);
    let errors = |estimate: Option<Line>| match estimate {
        Some(line) => (
            line.angle_to_deg(&mission.truth),
            misclassified(mission.config.area, &mission.truth, &line),
        ),
        None => (90.0, 0.5),
    };
    let (centre_deg, centre_misclassified) = errors(estimates.centre);
    let (maximum_margin_deg, maximum_margin_misclassified) = errors(estimates.maximum_margin);
    let (bisector_deg, bisector_misclassified) = errors(estimates.bisector);
    Mark {
        bits: libm::log2(
            estimate::area(mission.space.candidates()) / estimate::area(space.candidates()),
        ),
        centre_deg,
        maximum_margin_deg,
        bisector_deg,
        centre_misclassified,
        maximum_margin_misclassified,
        bisector_misclassified,
        ..so_far
    }
}

fn row(marks: &[Mark]) -> Row {
    let spread = |pick: fn(&Mark) -> f64| Spread::of(marks.iter().map(pick));
    let n = marks.len() as f64;
    let mean = |pick: fn(&Mark) -> f64| marks.iter().map(pick).sum::<f64>() / n;
    let step = marks.first().map_or(0, |m| m.step);
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

impl Summary {
    /// The tables for people.
    pub fn report(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_report(&mut text);
        text
    }

    fn write_report(&self, text: &mut String) -> std::fmt::Result {
        let who = self.algorithm.title();
        writeln!(text, "{who}, {} standard fields, seed {}", self.fields, self.seed)?;
        writeln!(text, "\nSlope error, degrees: median, 90th percentile, worst\n")?;
        let titles = ["centre", "maximum margin", "bisector (paper)"];
        let [a, b, c] = titles;
        writeln!(text, "{:>4} {:>9}  {a:^26}  {b:^26}  {c:^26}", "step", "bits/step")?;
        for row in &self.rows {
            let cell = |s: Spread| format!("{:>8.3} {:>8.3} {:>8.3}", s.median, s.p90, s.worst);
            let (step, bits) = (row.step, row.bits_per_step);
            let spreads = [row.centre_deg, row.maximum_margin_deg, row.bisector_deg].map(cell);
            writeln!(text, "{step:>4} {bits:>9.3}  {}", spreads.join("  "))?;
        }
        writeln!(
            text,
            "\nMisclassified area, per cent: median, 90th percentile, worst; means so far\n"
        )?;
        writeln!(text, "{:>4} {:>9}  {a:^26}  {b:^26}  {c:^26}  {:>8}", "step", "cost", "metres")?;
        for row in &self.rows {
            let cell = |s: Spread| {
                let [median, p90, worst] = [s.median, s.p90, s.worst].map(|share| 100.0 * share);
                format!("{median:>8.4} {p90:>8.4} {worst:>8.4}")
            };
            let spreads = [
                row.centre_misclassified,
                row.maximum_margin_misclassified,
                row.bisector_misclassified,
            ]
            .map(cell)
            .join("  ");
            let (step, cost, metres) = (row.step, row.control_cost, row.metres);
            writeln!(text, "{step:>4} {cost:>9.1}  {spreads}  {metres:>8.1}")?;
        }
        let counts = |counts: &BTreeMap<&str, u64>| {
            let each: Vec<_> = counts.iter().map(|(name, n)| format!("{name} {n}")).collect();
            if each.is_empty() { "none".into() } else { each.join(", ") }
        };
        writeln!(text, "\nEnded by: {}", counts(&self.ends))?;
        writeln!(text, "Recoveries in {} steps: {}", self.plans, counts(&self.recoveries))?;
        if self.algorithm != Algorithm::Random {
            let share = 100.0 * self.mean_examined / f64::from(self.actions);
            writeln!(
                text,
                "Actions examined per plan: mean {:.1} of {} ({share:.2} %), at most {}",
                self.mean_examined, self.actions, self.most_examined
            )?;
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
