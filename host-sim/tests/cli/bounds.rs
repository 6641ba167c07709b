//! What is known of the line beforehand: `bounds` of scenarios.

use std::fs;

use serde_json::Value;

use crate::{folder, prints, refuses};

/// A field of 20 m, with this oracle and these settings.
fn field(oracle: &str, settings: &str) -> String {
    format!(
        r#"algorithm = "lookahead"
steps = 12
area = {{ x = [0.0, 20.0], z = [0.0, 20.0] }}
truth = {{ slope = 0.41, intercept = 3.5 }}
start = {{ x = 2.0, z = 2.0 }}
oracle = [{oracle}]
{settings}
"#
    )
}

const POINTS: &str = "{ x = 3.0, z = 3.0, label = -1 }, { x = 3.0, z = 9.0, label = 1 }, { x = 15.0, z = 4.0, label = -1 }";
const BOTH: &str = "bounds = { slope = [-10.0, 50.0], intercept = [0.0, 8.0] }";

fn trace(settings: &str, oracle: &str) -> (String, Value, Vec<Value>) {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), field(oracle, settings)).expect("a file");
    let told = prints(folder.path(), &["run", "m.toml", "--trace", "t.jsonl"]);
    let trace = fs::read_to_string(folder.path().join("t.jsonl")).expect("a trace");
    let records: Vec<Value> =
        trace.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    (told, records[0].clone(), records)
}

/// Bounds stand for points: two bounds are enough to begin with, and the line is found within them.
#[test]
fn bounds_stand_for_points() {
    for oracle in ["", POINTS] {
        let (told, start, records) = trace(BOTH, oracle);
        let known = "Known of the line: it runs at -10 to 50 deg, it crosses x = 0 at z = 0 to 8";
        assert!(told.contains(known), "{told}");
        assert_eq!(told.contains("The oracle's points"), !oracle.is_empty(), "{told}");
        assert_eq!(start["bounds"]["slope"], Value::from(vec![-10.0, 50.0]));
        assert_eq!(
            start["oracle"].as_array().map(Vec::len),
            Some(3 * usize::from(!oracle.is_empty()))
        );
        let last = &records[records.len() - 2];
        let arcs = last["slope_arcs"].as_array().expect("arcs");
        let [from, to] = [0, 1].map(|k| arcs[0][k].as_f64().expect("degrees"));
        assert!(from < 22.3 && 22.3 < to && to - from < 5.0, "{arcs:?}");
    }
}

/// A wider bound never leaves fewer lines, and a bound that says nothing changes nothing but the room.
#[test]
fn bounds_narrow_what_is_open() {
    let width = |settings: &str| {
        let (.., records) = trace(settings, POINTS);
        let arcs = records[1]["slope_arcs"].as_array().expect("arcs").clone();
        arcs.iter()
            .map(|arc| arc[1].as_f64().unwrap_or(0.0) - arc[0].as_f64().unwrap_or(0.0))
            .sum::<f64>()
    };
    let [open, wide, narrow] =
        ["", "bounds = { slope = [-60.0, 80.0] }", "bounds = { slope = [20.0, 25.0] }"].map(width);
    assert!(narrow < wide && wide <= open, "{narrow}, {wide}, {open}");
    assert!(narrow < 5.3, "{narrow}");
}

/// The points say on which side +1 lies: here below the line.
#[test]
fn bounds_follow_the_labels() {
    let folder = folder();
    let mirrored = field(POINTS, BOTH)
        .replace("label = -1", "label = 7")
        .replace("label = 1", "label = -1")
        .replace("label = 7", "label = 1")
        .replace("{ slope = 0.41, intercept = 3.5 }", "{ line = [0.41, -1.0, 3.5] }");
    fs::write(folder.path().join("m.toml"), mirrored).expect("a file");
    let told = prints(folder.path(), &["run", "m.toml"]);
    assert!(told.contains("it runs at -10 to 50 deg"), "{told}");
}

#[test]
fn bad_bounds_are_refused() {
    let folder = folder();
    let noise = "noise = { p = 0.9, trusted_radius = 1.0 }";
    for (oracle, settings, parts) in [
        (
            POINTS,
            "bounds = { slope = [50.0, -10.0] }",
            &["m.toml: bounds.slope:", "[50.0, -10.0]", "second larger"][..],
        ),
        (POINTS, "bounds = { slope = [0.0, 190.0] }", &["m.toml: bounds.slope:", "less than 180"]),
        (POINTS, "bounds = { slope = [30.0, 40.0] }", &["m.toml: bounds:", "the truth"]),
        (POINTS, "bounds = { slope = [100.0, 140.0] }", &["m.toml: bounds:", "leave a line"]),
        (POINTS, "bounds = { intercept = [8.0, 8.0] }", &["m.toml: bounds.intercept:", "metres"]),
        (POINTS, "bounds = { intercept = [5.0, 8.0] }", &["m.toml: bounds:", "the truth"]),
        (POINTS, "bounds = { slop = [5.0, 8.0] }", &["m.toml:7:", "slop"]),
        (POINTS, "bounds = [5.0, 8.0]", &["m.toml:7:", "a table"]),
        (POINTS, &format!("{BOTH}\n{noise}"), &["m.toml: bounds:", "trusted_radius = 0"]),
        ("", noise, &["m.toml: oracle:", "trusted_radius = 0"]),
    ] {
        fs::write(folder.path().join("m.toml"), field(oracle, settings)).expect("a file");
        refuses(folder.path(), &["run", "m.toml"], parts);
    }
    let nowhere = field("", BOTH).replace("start = { x = 2.0, z = 2.0 }\n", "");
    fs::write(folder.path().join("m.toml"), nowhere).expect("a file");
    refuses(folder.path(), &["run", "m.toml"], &["m.toml: start:", "x and z"]);
}
