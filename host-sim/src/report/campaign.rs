//! A campaign's results in tables.

use std::collections::BTreeMap;
use std::fmt::Display;

use crate::campaign::accuracy::{self, Row};
use crate::campaign::calibration;
use crate::campaign::ensemble::readings_told;
use crate::campaign::spread::Spread;
use crate::mission::algorithm::Algorithm;
use crate::report::comparison::{HOLDS, holds};
use crate::report::table::{Column, Table};

fn spread(Spread { median, p90, worst }: Spread, decimals: usize) -> String {
    format!("{median:>8.decimals$} {p90:>8.decimals$} {worst:>8.decimals$}")
}

/// The accuracy of the line after some steps, in tables.
pub fn accuracy(summary: &accuracy::Summary) -> String {
    let accuracy::Summary { algorithm, fields, seed, rows, .. } = summary;
    let (degrees, areas) = (degrees(rows), areas(rows));
    let examined =
        if matches!(algorithm, Algorithm::Chords | Algorithm::Random | Algorithm::Lawnmower) {
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
        "{}, {fields} standard fields, seed {seed}{}\n\n\
         Slope error, degrees: median, 90th percentile, worst\n\n{degrees}\n\
         Misclassified area, per cent: median, 90th percentile, worst; means so far\n\n{areas}\n\
         Ended by: {}\nRecoveries in {} steps: {}\n{examined}",
        algorithm.title(),
        readings_told(summary.readings),
        counts(&summary.ends),
        summary.plans,
        counts(&summary.recoveries),
    )
}

/// The errors of the slope.
fn degrees(rows: &[Row]) -> Table {
    let of = |title| Column::centre(title, 26).apart();
    Table::of(
        rows,
        &[
            (Column::right("step", 4), &|row| row.step.to_string()),
            (Column::right("bits/step", 9), &|row| format!("{:.3}", row.bits_per_step)),
            (of("centre"), &|row| spread(row.centre_deg, 3)),
            (of("maximum margin"), &|row| spread(row.maximum_margin_deg, 3)),
            (of("bisector (paper)"), &|row| spread(row.bisector_deg, 3)),
        ],
    )
}

/// The misclassified shares.
fn areas(rows: &[Row]) -> Table {
    let of = |title| Column::centre(title, 26).apart();
    let percent = |share: Spread| spread(share.scaled(100.0), 4);
    Table::of(
        rows,
        &[
            (Column::right("step", 4), &|row| row.step.to_string()),
            (Column::right("cost", 9), &|row| format!("{:.1}", row.control_cost)),
            (of("centre"), &|row| percent(row.centre_misclassified)),
            (of("maximum margin"), &|row| percent(row.maximum_margin_misclassified)),
            (of("bisector (paper)"), &|row| percent(row.bisector_misclassified)),
            (Column::right("metres", 8).apart(), &|row| format!("{:.1}", row.metres)),
        ],
    )
}

fn counts<K: Display>(counts: &BTreeMap<K, u64>) -> String {
    let each: Vec<_> = counts.iter().map(|(name, n)| format!("{name} {n}")).collect();
    if each.is_empty() { "none".into() } else { each.join(", ") }
}

/// The information of labels that may be wrong, and how often credible sets hold.
pub fn calibration(summary: &calibration::Summary) -> String {
    let calibration::Summary { title, limit, rows, .. } = summary;
    let percent = |share: Option<f64>| share.map_or("-".into(), |it| format!("{:.1}%", 100.0 * it));
    let each = |row: &calibration::Row| row.bits / f64::from(row.labels);
    let table = Table::of(
        rows,
        &[
            (Column::right("labels", 6), &|row| row.labels.to_string()),
            (Column::right("missions", 8), &|row| row.missions.to_string()),
            (Column::right("bits", 7), &|row| format!("{:.3}", row.bits)),
            (Column::right("bits/label", 10), &|row| format!("{:.4}", each(row))),
            (Column::right("of limit", 9), &|row| percent(row.share)),
            (Column::right("expected", 9), &|row| percent(row.expected_share)),
            (Column::right("hypotheses", 11), &|row| format!("{:.1}", row.hypotheses)),
            (Column::right("pruned", 8), &|row| format!("{:.4}", row.pruned_mass)),
            (Column::centre("mean line, slope error deg", 26), &|row| spread(row.mean_deg, 3)),
            (Column::centre("misclassified area, %", 26), &|row| {
                spread(row.mean_misclassified.scaled(100.0), 3)
            }),
            (Column::right("cost", 7), &|row| format!("{:.1}", row.control_cost)),
            (Column::right("metres", 7), &|row| format!("{:.1}", row.metres)),
            (Column::right(HOLDS, 25).apart(), &holds),
        ],
    );
    format!("{title}; a label tells {limit:.4} bits at most\n\n{table}")
}
