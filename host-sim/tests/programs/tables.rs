//! The figures in tables of campaigns, computed from the rows alone by a slow twin. They are the same to the last bit.

#![allow(clippy::float_cmp)]

use std::collections::BTreeMap;
use std::fs;

use serde_json::{Value, json};

use crate::{folder, prints};

/// Rows of a campaign: values by the names of their columns.
type Rows = Vec<BTreeMap<String, String>>;

fn rows_and_record(flags: &str) -> (Rows, Value) {
    let folder = folder();
    let args = format!("campaign --csv c.csv --format json --every {flags}");
    let record = prints(folder.path(), &args.split(' ').collect::<Vec<_>>());
    let rows = fs::read(folder.path().join("c.csv")).expect("rows");
    let rows = csv::Reader::from_reader(&*rows).into_deserialize().map(|it| it.expect("a row"));
    (rows.collect(), serde_json::from_str(&record).expect("JSON"))
}

/// The values of a column in the rows of a stage. A word of truth is 1, or 0.
fn numbers(rows: &Rows, (column, stage): (&str, &str), name: &str) -> Vec<f64> {
    let of_stage = rows.iter().filter(|row| row[column] == stage);
    let number = |text: &str| match text {
        "true" => 1.0,
        "false" => 0.0,
        _ => text.parse().expect("a number"),
    };
    of_stage.map(|row| number(&row[name])).collect()
}

/// Nearest rank.
fn spread(mut values: Vec<f64>) -> Value {
    values.sort_by(f64::total_cmp);
    let rank = |tenths: usize| values[(values.len() * tenths).div_ceil(10) - 1];
    json!({ "median": rank(5), "p90": rank(9), "worst": rank(10) })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn rows_hold_what_tables_tell() {
    let (rows, record) = rows_and_record("--fields 73 --steps 40 --algorithm lookahead");
    let table = record["rows"].as_array().expect("rows");
    assert!(table.iter().map(|row| row["step"].as_u64()).eq((1..=40).map(Some)));
    for row in table {
        let step = row["step"].to_string();
        let of = |name| numbers(&rows, ("step", &step), name);
        for name in ["centre_deg", "bisector_deg", "maximum_margin_misclassified"] {
            assert_eq!(row[name], spread(of(name)), "{name} at {step}");
        }
        let steps = row["step"].as_f64().expect("a step");
        assert_eq!(row["bits_per_step"], mean(&of("bits")) / steps, "{steps}");
        assert_eq!(row["metres"], mean(&of("metres")), "{steps}");
    }
    // What a mission came to in all is in its last row.
    let last = |name| numbers(&rows, ("step", "40"), name);
    let count = |name| last(name).iter().sum::<f64>();
    assert_eq!(record["plans"].as_f64(), Some(count("plans")));
    assert_eq!(record["mean_examined"], count("examined") / count("plans"));
    let most = last("most_examined").into_iter().fold(0.0, f64::max);
    assert_eq!(record["most_examined"].as_f64(), Some(most));
    for rung in ["undirected", "reorient", "transit"] {
        assert_eq!(record["recoveries"][rung].as_f64().unwrap_or(0.0), count(rung), "{rung}");
    }
    for (reason, times) in record["ends"].as_object().expect("reasons") {
        let found = rows.iter().filter(|row| row["step"] == "40" && row["ended"] == *reason);
        assert_eq!(times.as_u64(), Some(found.count() as u64), "{reason}");
    }
}

#[test]
fn rows_in_noise_hold_what_tables_tell() {
    let (rows, record) = rows_and_record("--fields 43 --steps 12 --algorithm scc");
    let table = record["rows"].as_array().expect("rows");
    assert!(table.len() >= 10, "{record}");
    for row in table {
        let labels = row["labels"].to_string();
        let of = |name: &str| numbers(&rows, ("labels", &labels), name);
        assert_eq!(row["missions"].as_u64(), Some(of("bits").len() as u64));
        assert_eq!(row["bits"], mean(&of("bits")));
        assert_eq!(row["expected_bits"], mean(&of("expected_bits")));
        assert_eq!(row["mean_deg"], spread(of("mean_deg")));
        assert_eq!(row["coverage"], mean(&of("credible_holds")));
        assert_eq!(row["stated"], mean(&of("credible_probability")));
    }
}
