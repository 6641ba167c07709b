//! `campaign`.

#![allow(clippy::float_cmp)] // figures are the same to the last bit

use std::fs;

use serde_json::Value;

use crate::{GOOD, folder, prints, refuses};

#[test]
fn a_campaign_prints_tables_and_writes_rows() {
    let folder = folder();
    let args = ["campaign", "--fields", "20", "--steps", "12", "--csv", "c.csv"];
    let table = prints(folder.path(), &args);
    for part in
        ["20 standard fields, seed 1", "bits/step", "Ended by: steps 20", "Actions examined"]
    {
        assert!(table.contains(part), "{part}: {table}");
    }
    let rows = fs::read_to_string(folder.path().join("c.csv")).expect("rows");
    assert_eq!(rows.lines().count(), 1 + 20 * 5, "marks at 1, 2, 5, 10 and 12");
    let json = prints(
        folder.path(),
        &["campaign", "--fields", "5", "--algorithm", "random", "--format", "json"],
    );
    let summary: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!((&summary["fields"], &summary["algorithm"]), (&5.into(), &"random".into()));
}

/// Rows as a program reads them: the values of a column in the rows of a stage.
fn column(rows: &str, stage: &str, name: &str) -> Vec<String> {
    let mut lines = rows.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let titles = lines.next().expect("a header");
    let at = |name: &str| titles.iter().position(|title| *title == name).expect("a column");
    let stage_at = ["step", "labels"].into_iter().find(|it| titles.contains(it)).map(at);
    lines
        .filter(|line| line[stage_at.expect("a stage")] == stage)
        .map(|line| line[at(name)].to_owned())
        .collect()
}

fn numbers(rows: &str, stage: &str, name: &str) -> Vec<f64> {
    column(rows, stage, name).iter().map(|it| it.parse().expect("a number")).collect()
}

/// Nearest rank, of all values at once.
fn spread(mut values: Vec<f64>) -> Value {
    values.sort_by(f64::total_cmp);
    let rank = |tenths: usize| values[(values.len() * tenths).div_ceil(10) - 1];
    serde_json::json!({ "median": rank(5), "p90": rank(9), "worst": rank(10) })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn rows_and_record(flags: &[&str]) -> (String, Value) {
    let folder = folder();
    let args = [&["campaign", "--csv", "c.csv", "--format", "json"], flags].concat();
    let record = serde_json::from_str(&prints(folder.path(), &args)).expect("JSON");
    (fs::read_to_string(folder.path().join("c.csv")).expect("rows"), record)
}

/// The figures of tables, from the rows alone by a slow twin, to the last bit.
#[test]
fn rows_hold_what_tables_tell() {
    let flags = ["--fields", "73", "--steps", "40", "--algorithm", "lookahead", "--every"];
    let (rows, record) = rows_and_record(&flags);
    let told = record["rows"].as_array().expect("rows");
    let steps: Vec<_> = told.iter().map(|row| row["step"].as_u64().expect("a step")).collect();
    assert_eq!(steps, (1..=40).collect::<Vec<_>>());
    for row in told {
        let step = row["step"].to_string();
        for name in ["centre_deg", "bisector_deg", "maximum_margin_misclassified"] {
            assert_eq!(row[name], spread(numbers(&rows, &step, name)), "{name} at {step}");
        }
        let bits = mean(&numbers(&rows, &step, "bits")) / number(&row["step"]);
        assert_eq!(number(&row["bits_per_step"]), bits, "{step}");
        assert_eq!(number(&row["metres"]), mean(&numbers(&rows, &step, "metres")), "{step}");
    }
    // What a mission came to in all is in its last row.
    let count = |name: &str| numbers(&rows, "40", name).iter().sum::<f64>();
    assert_eq!(number(&record["plans"]), count("plans"));
    assert_eq!(number(&record["mean_examined"]), count("examined") / count("plans"));
    let most = numbers(&rows, "40", "most_examined").into_iter().fold(0.0, f64::max);
    assert_eq!(number(&record["most_examined"]), most);
    for rung in ["undirected", "reorient", "transit"] {
        assert_eq!(record["recoveries"][rung].as_f64().unwrap_or(0.0), count(rung), "{rung}");
    }
    let ends = column(&rows, "40", "ended");
    for (reason, times) in record["ends"].as_object().expect("reasons") {
        let found = ends.iter().filter(|it| *it == reason).count();
        assert_eq!(times.as_u64(), Some(found as u64), "{reason}");
    }
}

#[test]
fn rows_in_noise_hold_what_tables_tell() {
    let flags = ["--fields", "43", "--steps", "12", "--algorithm", "scc", "--every"];
    let (rows, record) = rows_and_record(&flags);
    let told = record["rows"].as_array().expect("rows");
    assert!(told.len() >= 10, "{record}");
    for row in told {
        let labels = row["labels"].to_string();
        let numbers = |name: &str| numbers(&rows, &labels, name);
        let holds = |name: &str| -> Vec<f64> {
            column(&rows, &labels, name)
                .iter()
                .map(|it| f64::from(u8::from(it == "true")))
                .collect()
        };
        assert_eq!(number(&row["missions"]), numbers("bits").len() as f64);
        assert_eq!(number(&row["bits"]), mean(&numbers("bits")));
        assert_eq!(number(&row["expected_bits"]), mean(&numbers("expected_bits")));
        assert_eq!(row["mean_deg"], spread(numbers("mean_deg")));
        for (prior, name) in ["area", "paper"].into_iter().enumerate() {
            let told = &row["calibration"][prior];
            let of = |what: &str| format!("{name}_{what}");
            assert_eq!(number(&told["coverage"]), mean(&holds(&of("credible_holds"))));
            assert_eq!(number(&told["stated"]), mean(&numbers(&of("credible_probability"))));
            let mut best: Vec<_> = numbers(&of("best_probability"))
                .into_iter()
                .zip(holds(&of("best_holds")))
                .collect();
            best.sort_by(|a, b| a.0.total_cmp(&b.0));
            let bins = best.chunks(best.len().div_ceil(5)).map(|bin| {
                let (stated, holds): (Vec<_>, Vec<_>) = bin.iter().copied().unzip();
                serde_json::json!([bin.len(), mean(&stated), mean(&holds)])
            });
            assert_eq!(told["best"], bins.collect::<Value>(), "{name} after {labels}");
        }
    }
}

/// The usual rows are among those of every step, the same.
#[test]
fn every_step_has_the_usual_rows() {
    for flags in [&["--fields", "6", "--steps", "12"][..], &["--fields", "3", "--algorithm", "scc"]]
    {
        let (usual, _) = rows_and_record(flags);
        let (every, _) = rows_and_record(&[flags, &["--every"]].concat());
        assert!(every.lines().count() > 2 * usual.lines().count());
        assert!(usual.lines().all(|row| every.lines().any(|it| it == row)));
    }
}

/// The flag and the scenario's key choose the action set: more actions, and turns that are no multiples of
/// 10 mrad.
#[test]
fn the_fan_can_be_fine() {
    let folder = folder();
    let summaries = |flags: &[&str]| -> Value {
        let args = ["campaign", "--fields", "3", "--format", "json"];
        let summary = prints(folder.path(), &[&args[..], flags].concat());
        serde_json::from_str(&summary).expect("JSON")
    };
    // Unless one says each planner has its own.
    let cases: [(&[&str], u64); 5] = [
        (&["--fan", "paper"], 6_657),
        (&["--fan", "fine"], 65_973_495),
        (&[], 6_657),
        (&["--algorithm", "lookahead"], 65_973_495),
        (&["--algorithm", "lookahead", "--fan", "paper"], 6_657),
    ];
    for (flags, actions) in cases {
        assert_eq!(summaries(flags)["actions"], actions, "{flags:?}");
    }
    let compared = summaries(&["--compare", "cfc,lookahead,margin"]);
    let actions = [0, 1, 2].map(|k| compared[k]["actions"].as_u64());
    assert_eq!(actions, [6_657, 65_973_495, 6_657].map(Some));
    let steps = |text: &str| {
        fs::write(folder.path().join("m.toml"), text).expect("a file");
        let trace = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
        let records = trace.lines().map(|it| serde_json::from_str(it).expect("JSON"));
        let records: Vec<Value> = records.collect();
        let index = records.iter().filter_map(|it| it["action"]["index"].as_u64()).max();
        (trace, index.expect("a step"))
    };
    let (trace, index) = steps(GOOD);
    assert_eq!(steps(&format!("fan = \"paper\"\n{GOOD}")), (trace, index));
    assert!(index < 6_657 && steps(&format!("fan = \"fine\"\n{GOOD}")).1 > 6_657);
}

#[test]
fn of_labels_that_tell_nothing_there_is_no_share() {
    let folder = folder();
    let coin = ["campaign", "--fields", "2", "--steps", "5", "--algorithm", "scc", "--p", "0.5"];
    let table = prints(folder.path(), &coin);
    let row = table.lines().find(|line| line.trim_start().starts_with("5 ")).expect("a row");
    assert_eq!(row.split_whitespace().nth(4), Some("-"), "{table}");
    assert!(!table.contains("inf") && !table.contains("NaN"), "{table}");
    let record = prints(folder.path(), &[&coin[..], &["--format", "json"]].concat());
    let record: Value = serde_json::from_str(&record).expect("JSON");
    assert_eq!(record["limit"], 0.0);
    // Where labels tell something it is as it was.
    let table = prints(folder.path(), &[&coin[..8], &["0.9"]].concat());
    let row = table.lines().find(|line| line.trim_start().starts_with("5 ")).expect("a row");
    assert!(row.split_whitespace().nth(4).is_some_and(|share| share.ends_with('%')), "{table}");
}

/// A figure of a comparison: its name, the stage, and how it is set from that stage's row of the record.
type Figure<'a> = (&'a str, &'a str, &'a dyn Fn(&Value) -> String);

/// The records of single campaigns are those of a comparison, and so are the rows, each led by who planned; its table
/// tells the same figures.
fn compares(planners: &[&str], flags: &[&str], told: &[Figure]) {
    let folder = folder();
    let common = [&["campaign", "--fields", "6", "--csv", "c.csv"], flags].concat();
    let rows = || fs::read_to_string(folder.path().join("c.csv")).expect("rows");
    let run = |more: &[&str]| {
        let printed = prints(folder.path(), &[&common[..], more].concat());
        let record = prints(folder.path(), &[&common[..], more, &["--format", "json"]].concat());
        let record: Value = serde_json::from_str(&record).expect("JSON");
        (printed, record, rows())
    };
    let (table, records, all) = run(&["--compare", &planners.join(",")]);
    let mut all = all.lines();
    let titles = all.next();
    for (planner, record) in planners.iter().zip(records.as_array().expect("an array")) {
        let (_, single, rows) = run(&["--algorithm", planner]);
        assert_eq!(*record, single, "{planner}");
        assert_eq!(record["algorithm"], *planner);
        let mut rows = rows.lines();
        let title = rows.next().expect("a header");
        assert_eq!(titles.and_then(|it| it.strip_prefix("algorithm,")), Some(title));
        for row in rows {
            assert_eq!(all.next(), Some(&*format!("{planner},{row}")));
        }
    }
    assert_eq!((all.next(), records.as_array().map(Vec::len)), (None, Some(planners.len())));
    // The rows of a figure follow its name; those after the first begin with the stage.
    for (name, stage, figure) in told {
        let rows = table.lines().skip_while(|line| !line.starts_with(name));
        let row = rows.map(|line| line.strip_prefix(name).unwrap_or(line));
        let row = row.map(|line| line.split_whitespace().collect::<Vec<_>>());
        let row = row.into_iter().find(|row| row.first() == Some(stage)).expect("a row");
        let found = records.as_array().into_iter().flatten().map(|record| {
            let at = |row: &&Value| {
                [&row["step"], &row["labels"]].iter().any(|it| it.to_string() == **stage)
            };
            figure(record["rows"].as_array().expect("rows").iter().find(at).expect("a stage"))
        });
        assert_eq!(row[1..].join(" "), found.collect::<Vec<_>>().join(" "), "{name}: {table}");
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn a_comparison_tells_what_single_campaigns_tell() {
    let bits = |row: &Value| format!("{:.3}", number(&row["bits_per_step"]));
    // What is very small has its leading digits all the same.
    let small = |it: f64| if it < 0.001 { format!("{it:.1e}") } else { format!("{it:.4}") };
    let slope = |row: &Value| small(number(&row["centre_deg"]["median"]));
    let area = |row: &Value| small(100.0 * number(&row["centre_misclassified"]["median"]));
    let cost = |row: &Value| format!("{:.1}", number(&row["control_cost"]));
    let metres = |row: &Value| format!("{:.1}", number(&row["metres"]));
    compares(
        &["margin", "cfc", "lookahead", "random"],
        &["--steps", "30"],
        &[
            ("bits/step", "10", &bits),
            ("bits/step", "30", &bits),
            ("centre, slope error deg", "20", &slope),
            ("centre, misclassified %", "30", &area),
            ("control cost", "20", &cost),
            ("metres", "20", &metres),
        ],
    );
    // Of few steps the last is told.
    compares(
        &["cfc", "random"],
        &["--steps", "7"],
        &[("bits/step", "7", &bits), ("metres", "7", &metres)],
    );
}

#[test]
fn a_comparison_in_noise_tells_what_single_campaigns_tell() {
    let bits = |row: &Value| format!("{:.3}", number(&row["bits"]));
    let share = |row: &Value| format!("{:.1} %", 100.0 * number(&row["share"]));
    let slope = |row: &Value| format!("{:.3}", number(&row["mean_deg"]["median"]));
    let holds = |row: &Value| {
        let by_area = &row["calibration"][0];
        let [holds, states] = ["coverage", "stated"].map(|of| 100.0 * number(&by_area[of]));
        format!("{holds:.1} ({states:.1})")
    };
    let cost = |row: &Value| format!("{:.1}", number(&row["control_cost"]));
    compares(
        &["scc", "lookahead", "margin", "random"],
        &["--steps", "24", "--p", "0.8"],
        &[
            ("bits told", "10", &bits),
            ("of what labels can tell", "20", &share),
            ("mean, slope error deg", "20", &slope),
            ("90 % set holds (states) %", "10", &holds),
            ("control cost", "20", &cost),
        ],
    );
}

#[test]
fn labels_err_in_a_comparison_with_algorithm_2_unless_one_says() {
    let folder = folder();
    let quick = ["campaign", "--fields", "2", "--steps", "12", "--compare", "scc,margin"];
    assert!(prints(folder.path(), &quick).contains("p = 0.7"));
    let table = prints(folder.path(), &[&quick[..], &["--p", "1"]].concat());
    assert!(table.contains("true labels") && table.contains("Algorithm 2 (scc)"), "{table}");
}

/// The numbers of a vehicle are flags, and the summary names what flew.
#[test]
fn a_campaign_flies_any_vehicle() {
    let folder = folder();
    let summary = |flags: &[&str]| -> Value {
        let args = ["campaign", "--fields", "6", "--steps", "6", "--format", "json"];
        let summary = prints(folder.path(), &[&args[..], flags].concat());
        serde_json::from_str(&summary).expect("JSON")
    };
    assert!(summary(&[])["vehicle"].is_null());
    let car =
        summary(&["--vehicle", "car", "--radius", "3", "--reach", "1.8", "--shortest", "0.5"]);
    let told = &car["vehicle"];
    assert_eq!((&told["kind"], &told["radius"]), (&"car".into(), &3.0.into()));
    assert_eq!((&told["reach"], &told["shortest"]), (&1.8.into(), &0.5.into()));
    let boat =
        ["--vehicle", "boat", "--sharpest", "0.35", "--speed-step", "0.2", "--turn-step", "0.02"];
    let noisy = summary(&[&boat[..], &["--algorithm", "scc"]].concat());
    assert_eq!(
        (&noisy["vehicle"]["kind"], &noisy["vehicle"]["step"]),
        (&"boat".into(), &0.2.into())
    );
    let both = summary(&[&boat[..], &["--compare", "cfc,lookahead"]].concat());
    assert_eq!(both[1]["vehicle"]["turn_step"], 0.02);
}

#[test]
fn bad_vehicles_of_campaigns_are_refused() {
    let folder = folder();
    let cases: [(&[&str], &[&str]); 9] = [
        (&["--vehicle", "tank"], &["--vehicle", "tank", "car"]),
        (&["--vehicle", "car"], &["--radius", "found none", "turning circle"]),
        (&["--radius", "3"], &["--radius", "a unicycle", "a kind that has it"]),
        (&["--vehicle", "car", "--radius=-3"], &["--radius", "found -3", "a millimetre"]),
        (&["--vehicle", "car", "--radius", "12"], &["--vehicle", "20 m x 20 m", "25110 mm"]),
        (&["--vehicle", "boat", "--speed-step", "0.3"], &["--reach", "found 2", "steps of 0.3"]),
        (&["--vehicle", "boat", "--fan", "fine", "--turn-step", "0.01"], &["--turn-step", "a fan"]),
        (&["--vehicle", "boat", "--compare", "cfc,random"], &["--vehicle", "with random"]),
        (
            &["--vehicle", "car", "--radius", "9.8", "--tolerance", "1"],
            &["--vehicle", "less 1 m all around"],
        ),
    ];
    for (flags, parts) in cases {
        let args = [&["campaign", "--fields", "2"], flags].concat();
        refuses(folder.path(), &args, parts);
    }
}

#[test]
fn bad_errors_are_refused_by_their_flags() {
    let folder = folder();
    let cases: [(&[&str], &[&str]); 6] = [
        (&["--position-error=-0.1"], &["--position-error", "found -0.1", "metres, 0 to 100"]),
        (&["--position-error=nan"], &["--position-error", "found NaN"]),
        (&["--motion-error=101"], &["--motion-error", "found 101", "metres, 0 to 100"]),
        (&["--tolerance=-1"], &["--tolerance", "found -1", "0 to 1024"]),
        (&["--tolerance=10"], &["--tolerance", "found 10 m", "half the breadth"]),
        (&["--position-error=4"], &["--tolerance", "found 12 m", "half the breadth"]),
    ];
    for (flags, parts) in cases {
        let args = [&["campaign", "--fields", "2", "--csv", "c.csv"], flags].concat();
        refuses(folder.path(), &args, parts);
    }
}

/// The fields can be flown one by one: what a campaign measured of a field is what its own mission comes to.
#[test]
fn fields_are_written() {
    let folder = folder();
    let args =
        ["campaign", "--fields", "4", "--steps", "6", "--csv", "c.csv", "--fields-csv", "f.csv"];
    prints(folder.path(), &args);
    let rows = fs::read_to_string(folder.path().join("c.csv")).expect("rows");
    let fields = fs::read_to_string(folder.path().join("f.csv")).expect("fields");
    let mut lines = fields.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let titles = lines.next().expect("a header");
    assert_eq!(lines.clone().count(), 4);
    for (number, line) in lines.enumerate() {
        let of = |name: &str| line[titles.iter().position(|it| *it == name).expect("a column")];
        let oracle = (1..=4).map(|k| {
            let [x, z, label] = ["x", "z", "label"].map(|it| of(&format!("{it}{k}")));
            format!("{{ x = {x}, z = {z}, label = {label} }}")
        });
        let oracle = oracle.collect::<Vec<_>>().join(", ");
        let [heading, a, b, c] = ["heading", "a", "b", "c"].map(of);
        let mission = format!(
            "steps = 6\nstart = {{ heading = {heading} }}\ntruth = {{ line = [{a}, {b}, {c}] }}\noracle = [{oracle}]\n"
        );
        fs::write(folder.path().join("m.toml"), mission).expect("a file");
        let trace = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
        let last = trace.lines().rev().nth(1).expect("a step");
        let last: Value = serde_json::from_str(last).expect("JSON");
        assert_eq!(of("field"), number.to_string());
        assert_eq!(
            numbers(&rows, "6", "bits")[number],
            self::number(&last["bits"]),
            "field {number}"
        );
    }
    refuses(
        folder.path(),
        &["campaign", "--csv", "n.csv", "--fields-csv", "n.csv"],
        &["n.csv", "--fields-csv"],
    );
}
