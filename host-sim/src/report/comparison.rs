//! Campaigns of several planners on the same fields, side by side: a column each.

use crate::campaign::calibration::how_often;
use crate::campaign::ensemble::readings_told;
use crate::campaign::{accuracy, calibration};
use crate::mission::algorithm::Algorithm;
use crate::report::table::{Column, Table};

/// Steps, or labels, after which planners are compared, if they were flown. Otherwise the last one is taken.
const STAGES: [u32; 4] = [10, 20, 30, 40];

/// Steps over which motion is compared.
const MOTION: u32 = 20;

/// Planners whose labels are true.
pub fn accuracy(summaries: &[accuracy::Summary]) -> String {
    let Some(first) = summaries.first() else { return String::new() };
    let flown = first.rows.iter().map(|row| row.step);
    let stages = stages(flown.clone());
    let motion = flown.filter(|step| *step <= MOTION).max();
    let mut table = table("step", summaries.iter().map(|summary| summary.algorithm));
    let of_each: Vec<_> = summaries.iter().map(|it| &it.rows[..]).collect();
    let mut add = |name, stages: &[u32], of: fn(&accuracy::Row) -> String| {
        add(&mut table, name, stages, &of_each, |row| row.step, of);
    };
    add("bits/step", &stages, |row| format!("{:.3}", row.bits_per_step));
    add("centre, slope error deg", &stages, |row| small(row.centre_deg.median));
    add("centre, misclassified %", &stages, |row| small(100.0 * row.centre_misclassified.median));
    add("control cost", motion.as_slice(), |row| format!("{:.1}", row.control_cost));
    add("metres", motion.as_slice(), |row| format!("{:.1}", row.metres));
    format!(
        "{} standard fields, seed {}, true labels{}; errors are medians\n\n{table}",
        first.fields,
        first.seed,
        readings_told(first.readings)
    )
}

/// Planners whose labels may err.
pub fn calibration(summaries: &[calibration::Summary]) -> String {
    let Some(first) = summaries.first() else { return String::new() };
    let stages = stages(first.rows.iter().map(|row| row.labels));
    let mut table = table("labels", summaries.iter().map(|summary| summary.algorithm));
    let of_each: Vec<_> = summaries.iter().map(|it| &it.rows[..]).collect();
    let mut add = |name, of: fn(&calibration::Row) -> String| {
        add(&mut table, name, &stages, &of_each, |row| row.labels, of);
    };
    add("missions", |row| row.missions.to_string());
    add("bits told", |row| format!("{:.3}", row.bits));
    add("of what labels can tell", |row| {
        row.share.map_or("-".into(), |share| format!("{:.1} %", 100.0 * share))
    });
    add("of what they can, expected", |row| {
        row.expected_share.map_or("-".into(), |share| format!("{:.1} %", 100.0 * share))
    });
    add("mean, slope error deg", |row| format!("{:.3}", row.mean_deg.median));
    add("mean, misclassified %", |row| format!("{:.4}", 100.0 * row.mean_misclassified.median));
    add(HOLDS, holds);
    add("control cost", |row| format!("{:.1}", row.control_cost));
    add("metres", |row| format!("{:.1}", row.metres));
    format!(
        "{} standard fields, seed {}, {}{}; a label tells {:.4} bits at most; \
         errors are medians, sets by the area prior\n\n{table}",
        first.fields,
        first.seed,
        how_often(first.p, first.p_told, first.draws_p),
        readings_told(first.readings),
        first.limit
    )
}

/// The name of how often credible sets hold the line, and state to.
pub(super) const HOLDS: &str = "90 % set holds (states) %";

pub(super) fn holds(row: &calibration::Row) -> String {
    format!("{:.1} ({:.1})", 100.0 * row.coverage, 100.0 * row.stated)
}

/// An error, which may be very small.
fn small(error: f64) -> String {
    if error < 0.001 { format!("{error:.1e}") } else { format!("{error:.4}") }
}

/// The usual stages that were flown, or else the last one flown.
fn stages(flown: impl Iterator<Item = u32> + Clone) -> Vec<u32> {
    let stages: Vec<_> = flown.clone().filter(|stage| STAGES.contains(stage)).collect();
    if stages.is_empty() { flown.last().into_iter().collect() } else { stages }
}

/// A table with a column for each planner.
fn table(stage: &'static str, planners: impl Iterator<Item = Algorithm>) -> Table {
    let first = [Column::left("", 25), Column::right(stage, 6)];
    let planners = planners.map(|planner| Column::right(planner.title(), 18));
    Table::new(first.into_iter().chain(planners).collect::<Vec<_>>())
}

/// A row for each stage, the first with the name of what is compared. A planner that ended earlier has a dash.
fn add<R>(
    table: &mut Table,
    name: &str,
    stages: &[u32],
    of_each: &[&[R]],
    stage_of: fn(&R) -> u32,
    figure: fn(&R) -> String,
) {
    for (k, &stage) in stages.iter().enumerate() {
        let name = if k == 0 { name } else { "" };
        let at = |rows: &&[R]| rows.iter().find(|row| stage_of(row) == stage).map(figure);
        let figures = of_each.iter().map(|rows| at(rows).unwrap_or("-".into()));
        table.row([name.to_owned(), stage.to_string()].into_iter().chain(figures));
    }
}
