//! `replay` judges whether a straight line explains the labels: recordings that none explains, straight ones with any
//! share of wrong labels, and what follows from the verdict.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::recordings::{INTERCEPT, Row, SLOPE, answer, number, plain, random};
use crate::{folder, host_sim, text};

/// The recordings that no straight, still line explains: the name, the verdict, and parts of its words.
const NO_LINE: [(&str, &str, [&str; 2]); 4] = [
    ("two-boundaries", "two boundaries", ["there are two boundaries", "Split the area"]),
    ("fouled-sensor", "run", ["55 of 60 labels in a row", "lines 103 to 162"]),
    ("front", "bend", ["the boundary bends", "a shorter stretch"]),
    ("tide", "drift", ["the boundary moved", "fewer rows at a time"]),
];

/// A folder with the recordings.
fn recordings() -> TempDir {
    let folder = folder();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings");
    for (name, ..) in NO_LINE {
        let name = format!("{name}.csv");
        fs::copy(from.join(&name), folder.path().join(&name)).expect("a recording");
    }
    folder
}

/// 240 places in no order, labelled by a line; one in `every` of them wrongly, at places drawn from a seed.
fn straight(seed: u64, wrong: f64) -> Vec<Row> {
    let mut state = seed;
    let mut row = || {
        let [x, z] = [0; 2].map(|_| (random(&mut state) * 20_000.0).round() / 1_000.0);
        ([x, z], (z > SLOPE * x + INTERCEPT) != (random(&mut state) < wrong))
    };
    (0..240).map(|_| row()).collect()
}

fn fit(found: &Value) -> (&str, &Value) {
    (found["fit"]["verdict"].as_str().expect("a verdict"), &found["fit"])
}

#[test]
fn recordings_that_no_straight_line_explains_are_told_apart() {
    let folder = recordings();
    for (name, verdict, parts) in NO_LINE {
        let file = format!("{name}.csv");
        let args = ["replay", &file, "--p", "0.95"];
        // A warning beside the result, and exit status 0.
        let output = host_sim(folder.path(), &args);
        let (report, warning) = (text(&output.stdout), text(&output.stderr));
        assert_eq!(output.status.code(), Some(0), "{name}: {warning}");
        assert!(warning.starts_with(&format!("{file}: warning: ")), "{warning}");
        for part in ["No straight line explains these labels", parts[0], parts[1]] {
            assert!(report.contains(part), "{name}: expected {part:?} in {report}");
            assert!(warning.contains(part), "{name}: expected {part:?} in {warning}");
        }
        // With --strict, as a record and with a figure: exit status 1.
        let more = ["--strict", "--format", "json", "--figure", "f.svg"];
        let output = host_sim(folder.path(), &[&args[..], &more].concat());
        assert_eq!(output.status.code(), Some(1), "{name}");
        assert_eq!(
            text(&output.stderr),
            warning.replace(&format!("{file}: warning"), &format!("error: {file}"))
        );
        let record: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(fit(&record).0, verdict, "{name}");
        // A label disagrees with the line. Nobody knows that it is wrong.
        let svg = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
        assert!(svg.contains("ringed: disagrees with the line"), "{name}");
        assert!(svg.contains(&format!("verdict: {verdict}")), "{name}");
        assert!(!svg.contains("wrong"), "{name}");
        // Nothing is certain where labels may be wrong: the ground is that of the 90 % set.
        assert!(svg.contains("all lines of the set have label +1"), "{name}");
        assert!(svg.contains("set: the 90 % credible set") && !svg.contains("certain"), "{name}");
        // Without --p they are refused as before. The message says what explains them.
        let output = host_sim(folder.path(), &["replay", &file]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for part in ["no line separates", "--p", parts[0]] {
            assert!(message.contains(part), "{name}: expected {part:?} in {message}");
        }
    }
}

#[test]
fn the_rows_of_a_fouled_sensor_are_those_to_leave_out() {
    let folder = recordings();
    let content = fs::read_to_string(folder.path().join("fouled-sensor.csv")).expect("a file");
    let found = answer(folder.path(), &content, &["--p", "0.95"]);
    let (_, fit_found) = fit(&found);
    let run = &fit_found["longest_run"];
    assert!(number(&run["count"]) >= 8.0, "{run}");
    assert!(number(&run["first"]) >= 103.0 && number(&run["last"]) <= 162.0, "{run}");
    // What the advice says leads to a line that fits.
    let lines = content.lines().enumerate();
    let rest: Vec<_> = lines.filter(|(k, _)| !(102..162).contains(k)).map(|(_, it)| it).collect();
    let found = answer(folder.path(), &(rest.join("\n") + "\n"), &["--p", "0.95"]);
    assert_eq!(fit(&found).0, "fits", "{}", found["fit"]);
}

#[test]
fn straight_recordings_fit_with_any_share_of_wrong_labels() {
    let folder = folder();
    for (k, wrong) in
        [0.0, 0.01, 0.02, 0.03, 0.05, 0.08, 0.1, 0.13, 0.16, 0.2].into_iter().enumerate()
    {
        let content = plain(&straight(k as u64 + 1, wrong));
        let p = (1.0_f64 - wrong).min(0.999).to_string();
        let found = answer(folder.path(), &content, &["--p", &p]);
        let (verdict, fit) = fit(&found);
        assert_eq!(verdict, "fits", "{wrong}: {fit}");
        let whole = |value: &Value| value.as_u64().expect("a count");
        let [low, high] = [0, 1].map(|k| whole(&fit["expected"][k]));
        let count = whole(&fit["disagreeing"]);
        assert!(low <= count && count <= high, "{fit}");
        let listed = found["most_likely"]["disagreeing"].as_array().expect("lines").len();
        assert_eq!(count, listed as u64);
        assert!((number(&fit["suggested_p"]) - 1.0 + wrong).abs() < 0.06, "{wrong}: {fit}");
        let along = fit["along"].as_array().expect("pieces");
        let sum = |key: &str| along.iter().map(|piece| whole(&piece[key])).sum::<u64>();
        assert_eq!(sum("labels"), 240);
        assert_eq!(sum("negative") + sum("positive"), count);
    }
}

#[test]
fn a_reliability_that_the_file_contradicts_is_told() {
    let folder = folder();
    let content = plain(&straight(3, 0.2));
    let found = answer(folder.path(), &content, &["--p", "0.95"]);
    let (verdict, fit_found) = fit(&found);
    assert_eq!(verdict, "p too high");
    let suggested = format!("{:.2}", number(&fit_found["suggested_p"]));
    let says = fit_found["says"].as_str().expect("words");
    assert!(says.contains(&format!("The file suggests p = {suggested}.")), "{says}");
    let output = host_sim(folder.path(), &["replay", "s.csv", "--p", "0.95", "--strict"]);
    assert_eq!(output.status.code(), Some(1));
    // What the advice says leads to a line that fits.
    let found = answer(folder.path(), &content, &["--p", &suggested]);
    assert_eq!(fit(&found).0, "fits");
    // Too low a p is safe: it is told, but --strict does not mind.
    let content = plain(&straight(3, 0.02));
    let found = answer(folder.path(), &content, &["--p", "0.8"]);
    assert_eq!(fit(&found).0, "p too low");
    let output = host_sim(folder.path(), &["replay", "s.csv", "--p", "0.8", "--strict"]);
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""));
}

#[test]
fn labels_that_a_line_separates_have_nothing_against_it() {
    let folder = folder();
    let content = plain(&straight(5, 0.0));
    for flags in [&[][..], &["--tolerance", "0.1"]] {
        let found = answer(folder.path(), &content, flags);
        let (verdict, fit) = fit(&found);
        assert_eq!((verdict, &fit["disagreeing"]), ("fits", &json!(0)));
        assert_eq!(fit["says"], "A straight line fits: all 240 labels agree with it.");
    }
}
