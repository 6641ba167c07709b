//! Campaigns along fronts: one table, with a line for each planner under each kind of front.

use crate::campaign::fronts::summary::{Row, Summary};
use crate::report::table::{Column, Table};

/// The table of some planners on the same fronts.
pub fn text(summaries: &[Summary]) -> String {
    let Some(first) = summaries.first() else { return String::new() };
    let mut table = Table::new([
        Column::left("front", 29),
        Column::right("p", 4),
        Column::left("planner", 14).apart(),
        Column::right("off, m", 7),
        Column::right("95 %", 7),
        Column::right("covers %", 9),
        Column::right("driven", 7),
        Column::right("mapped", 7),
        Column::right("labels", 7),
        Column::right("again %", 8),
        Column::right("lost %", 7),
    ]);
    for (n, row) in first.rows.iter().enumerate() {
        for (k, summary) in summaries.iter().enumerate() {
            let named =
                if k == 0 { [row.front.to_owned(), row.p.to_string()] } else { Default::default() };
            let title = summary.algorithm.title().to_owned();
            let figures = summary.rows.get(n).map(figures).unwrap_or_default();
            table.row(named.into_iter().chain([title]).chain(figures));
        }
    }
    let told = summaries.iter().find_map(|it| it.told_speed).filter(|it| (it - 1.0).abs() > 1e-9);
    let told = told
        .map_or(String::new(), |speed| format!("Told {speed} times the speed of each front.\n"));
    let reach: Vec<_> =
        summaries.iter().map(|it| format!("{} {} m", it.algorithm.title(), it.reach)).collect();
    format!(
        "{} missions of 400 m for each kind of front, seed {}; motions of up to: {}\n{told}\n{table}\n\
         off: distance of the map's vertices from the front, the median and what 95 % do not exceed\n\
         covers: vertices whose stated 90 % width holds the front; driven: metres a metre of front mapped, the median\n\
         mapped: metres of front, the mean; again: missions in which the planner began again after an alarm\n\
         lost: missions that end further than 6 m from the front for more than 20 m, or have no map\n",
        first.missions,
        first.seed,
        reach.join(", ")
    )
}

/// The figures of a row.
fn figures(row: &Row) -> Vec<String> {
    let number = |it: Option<f64>, decimals: usize| {
        it.map_or("-".to_owned(), |it| format!("{it:.decimals$}"))
    };
    let percent = |it: Option<f64>| number(it.map(|it| 100.0 * it), 1);
    vec![
        number(row.off_median, 3),
        number(row.off_p95, 3),
        percent(row.covers),
        number(row.driven, 3),
        number(Some(row.mapped), 0),
        number(Some(row.labels), 0),
        percent(Some(row.began_again)),
        percent(Some(row.lost)),
    ]
}
