//! A campaign's results in tables.

use std::collections::BTreeMap;
use std::fmt::Display;

use crate::campaign::accuracy::{self, Row};
use crate::campaign::calibration::{self, Calibration};
use crate::campaign::spread::Spread;
use crate::mission::algorithm::Algorithm;
use crate::report::table::{Column, Table};

const ESTIMATES: [Column; 3] = [
    Column::centre("centre", 26).apart(),
    Column::centre("maximum margin", 26).apart(),
    Column::centre("bisector (paper)", 26).apart(),
];

fn spread(Spread { median, p90, worst }: Spread, decimals: usize) -> String {
    format!("{median:>8.decimals$} {p90:>8.decimals$} {worst:>8.decimals$}")
}

/// The accuracy of the line after some steps, in tables.
pub fn accuracy(summary: &accuracy::Summary) -> String {
    let accuracy::Summary { algorithm, fields, seed, rows, .. } = summary;
    let (degrees, areas) = (degrees(rows), areas(rows));
    let examined = if *algorithm == Algorithm::Random {
        String::new()
    } else {
        let (mean, actions) = (summary.mean_examined, summary.actions);
        format!(
            "Actions examined per plan: mean {mean:.1} of {actions} ({:.2} %), at most {}\n",
            100.0 * mean / actions as f64,
            summary.most_examined
        )
    };
    format!(
        "{}, {fields} standard fields, seed {seed}\n\n\
         Slope error, degrees: median, 90th percentile, worst\n\n{degrees}\n\
         Misclassified area, per cent: median, 90th percentile, worst; means so far\n\n{areas}\n\
         Ended by: {}\nRecoveries in {} steps: {}\n{examined}",
        algorithm.title(),
        counts(&summary.ends),
        summary.plans,
        counts(&summary.recoveries),
    )
}

fn degrees(rows: &[Row]) -> Table {
    let first = [Column::right("step", 4), Column::right("bits/step", 9)];
    let mut table = Table::new([&first[..], &ESTIMATES].concat());
    for row in rows {
        let errors = [row.centre_deg, row.maximum_margin_deg, row.bisector_deg];
        let first = [row.step.to_string(), format!("{:.3}", row.bits_per_step)];
        table.row(first.into_iter().chain(errors.map(|it| spread(it, 3))));
    }
    table
}

fn areas(rows: &[Row]) -> Table {
    let first = [Column::right("step", 4), Column::right("cost", 9)];
    let last = [Column::right("metres", 8).apart()];
    let mut table = Table::new([&first[..], &ESTIMATES, &last].concat());
    for row in rows {
        let shares = [
            row.centre_misclassified,
            row.maximum_margin_misclassified,
            row.bisector_misclassified,
        ];
        let first = [row.step.to_string(), format!("{:.1}", row.control_cost)];
        let shares = shares.map(|it| spread(it.scaled(100.0), 4));
        let last = [format!("{:.1}", row.metres)];
        table.row(first.into_iter().chain(shares).chain(last));
    }
    table
}

fn counts<K: Display>(counts: &BTreeMap<K, u64>) -> String {
    let each: Vec<_> = counts.iter().map(|(name, n)| format!("{name} {n}")).collect();
    if each.is_empty() { "none".into() } else { each.join(", ") }
}

/// The information of labels that may be wrong, and whether statements hold.
pub fn calibration(summary: &calibration::Summary) -> String {
    let calibration::Summary { title, limit, rows, .. } = summary;
    let mut table = Table::new([
        Column::right("labels", 6),
        Column::right("missions", 8),
        Column::right("bits", 7),
        Column::right("bits/label", 10),
        Column::right("of limit", 9),
        Column::right("expected", 9),
        Column::right("hypotheses", 11),
        Column::right("pruned", 8),
        Column::centre("mean line, slope error deg", 26),
        Column::right("cost", 7),
    ]);
    for row in rows {
        let each = row.bits / f64::from(row.labels);
        table.row([
            row.labels.to_string(),
            row.missions.to_string(),
            format!("{:.3}", row.bits),
            format!("{each:.4}"),
            row.share.map_or("-".into(), |share| format!("{:.1}%", 100.0 * share)),
            row.expected_share.map_or("-".into(), |share| format!("{:.1}%", 100.0 * share)),
            format!("{:.1}", row.hypotheses),
            format!("{:.4}", row.pruned_mass),
            spread(row.mean_deg, 3),
            format!("{:.1}", row.control_cost),
        ]);
    }
    let [by_area, by_sequences] = [0, 1].map(|prior| coverage(rows, prior));
    format!(
        "{title}; a label tells {limit:.4} bits at most\n\n{table}\n\
         By the area prior:\n{by_area}\nBy the paper's prior:\n{by_sequences}"
    )
}

/// How often statements hold, by one of the two priors.
fn coverage(rows: &[calibration::Row], prior: usize) -> Table {
    let mut table = Table::new([
        Column::right("labels", 6),
        Column::right("coverage", 8).apart(),
        Column::right("stated", 7),
        Column::left("best hypothesis in five bins: mean stated > share that hold the truth", 0)
            .apart(),
    ]);
    for row in rows {
        let Calibration { coverage, stated, best } = &row.calibration[prior];
        let bins: Vec<_> =
            best.iter().map(|(_, stated, hit)| format!("{stated:.3} > {hit:.3}")).collect();
        table.row([
            row.labels.to_string(),
            format!("{coverage:.3}"),
            format!("{stated:.3}"),
            bins.join(" | "),
        ]);
    }
    table
}
