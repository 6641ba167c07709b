//! Several readings a motion: what a trace, flat rows, a recording and a campaign have of them, and who refuses them.

use std::fs;

use serde_json::Value;

use crate::{GOOD, folder, prints, refuses};

/// The good scenario with so many readings.
fn with(readings: i64) -> String {
    GOOD.replace("steps = 10", &format!("steps = 10\nreadings = {readings}"))
}

#[test]
fn a_trace_lists_the_readings_of_a_step_if_there_are_several() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), with(5)).expect("a file");
    let args = ["run", "m.toml", "--format", "json", "--trace", "t.jsonl"];
    let trace = prints(folder.path(), &args);
    let records: Vec<Value> =
        trace.lines().map(|line| serde_json::from_str(line).expect("a record")).collect();
    assert_eq!(records[0]["readings"], 5);
    let steps = &records[1..records.len() - 1];
    let mut from = &records[0]["pose"];
    let (mut all, mut cut) = (0, 0);
    for step in steps {
        let readings = step["readings"].as_array().expect("a list");
        let (last, way) = readings.split_last().expect("five");
        assert_eq!(way.len(), 4);
        let number = |value: &Value, key| value[key].as_f64().expect("a number");
        for (k, it) in (1..).zip(way) {
            for axis in ["x", "z"] {
                let [a, b] = [from, &step["pose"]].map(|pose| number(pose, axis));
                let expected = a + (b - a) * f64::from(k) / 5.0;
                assert!((number(it, axis) - expected).abs() < 1e-5, "{it}");
            }
            let is_above = number(it, "z") > 0.41 * number(it, "x") + 3.5;
            assert_eq!(it["label"], if is_above { 1 } else { -1 });
        }
        assert_eq!((&last["x"], &last["label"]), (&step["pose"]["x"], &step["label"]));
        all += readings.len();
        cut += readings.iter().filter(|it| it["cuts"] == true).count();
        from = &step["pose"];
    }
    let text = prints(folder.path(), &["run", "m.toml"]);
    let told = format!("{all} readings on the way and at ends of motions; {cut} of them ruled out");
    assert!(text.contains(&told), "{told}");
    let flat = prints(folder.path(), &["run", "m.toml", "--format", "flat"]);
    let counted = flat.lines().map(|line| {
        let row: Value = serde_json::from_str(line).expect("a row");
        row["readings_cut"].as_u64().expect("a count") as usize
    });
    assert_eq!(counted.sum::<usize>(), cut);
    // Its labels are a recording, in which all that the planner knew is known.
    let replayed = prints(folder.path(), &["replay", "t.jsonl", "--format", "json"]);
    let replayed: Value = serde_json::from_str(&replayed).expect("results");
    let known = &steps[steps.len() - 1]["slope_arcs"][0];
    for end in 0..2 {
        let [a, b] = [&replayed["slope_arcs"][0][end], &known[end]].map(Value::as_f64);
        assert!((a.expect("an end") - b.expect("an end")).abs() < 1e-9, "{replayed}");
    }
}

#[test]
fn one_reading_a_motion_is_the_mission_as_it_was() {
    let folder = folder();
    fs::write(folder.path().join("none.toml"), GOOD).expect("a file");
    fs::write(folder.path().join("one.toml"), with(1)).expect("a file");
    let trace = |name| prints(folder.path(), &["run", name, "--format", "json"]);
    let trace = [trace("none.toml"), trace("one.toml")];
    assert_eq!(trace[0], trace[1]);
    assert!(!trace[0].contains("readings"));
}

#[test]
fn a_mission_may_have_thousands_of_steps() {
    let folder = folder();
    let text = with(2).replace("\"cfc\"", "\"random\"").replace("steps = 10", "steps = 1500");
    fs::write(folder.path().join("m.toml"), text).expect("a file");
    let text = prints(folder.path(), &["run", "m.toml"]);
    assert!(text.contains("all steps are taken. 1500 samples in 1500 steps"), "{text}");
}

#[test]
fn more_or_fewer_readings_than_can_be_are_refused() {
    let folder = folder();
    for readings in [0, 51] {
        fs::write(folder.path().join("bad.toml"), with(readings)).expect("a file");
        let found = format!("found {readings}");
        refuses(folder.path(), &["run", "bad.toml"], &["readings", &found, "1 to 50"]);
        let readings = readings.to_string();
        let args = ["campaign", "--readings", &readings];
        refuses(folder.path(), &args, &["--readings", &found, "1 to 50"]);
    }
    fs::write(folder.path().join("several.toml"), with(5)).expect("a file");
    let args = ["reference", "several.toml", "--horizon", "2"];
    refuses(folder.path(), &args, &["several.toml", "readings", "found 5", "one label a motion"]);
}

/// A board takes them in, as far as the command line knows: what stops it here is that the port is none.
#[test]
fn a_board_and_a_vehicle_of_mavlink_may_read_on_the_way() {
    let folder = folder();
    let several = with(5).replace("steps = 10", "steps = 10\ntolerance = 0.5");
    fs::write(folder.path().join("several.toml"), several).expect("a file");
    let no_port = env!("CARGO_BIN_EXE_host-sim");
    let args = ["hil", "several.toml", "--port", no_port];
    refuses(folder.path(), &args, &["expected a serial port"]);
    if cfg!(feature = "mavlink") {
        let args = ["fly", "several.toml", "--dry-run", "--label", "W"];
        assert!(prints(folder.path(), &args).contains("SET_POSITION_TARGET"));
    }
}

#[test]
fn campaigns_learn_more_from_more_readings() {
    let folder = folder();
    let bits = ["1", "4"].map(|readings| {
        let args = [
            "campaign",
            "--fields",
            "40",
            "--steps",
            "10",
            "--readings",
            readings,
            "--format",
            "json",
        ];
        let summary: Value =
            serde_json::from_str(&prints(folder.path(), &args)).expect("a summary");
        assert_eq!(summary["readings"].as_u64(), (readings != "1").then_some(4));
        let rows = summary["rows"].as_array().expect("rows");
        rows[rows.len() - 1]["bits_per_step"].as_f64().expect("bits")
    });
    assert!(bits[1] > 1.3 * bits[0], "{bits:?}");
    let args = ["campaign", "--fields", "4", "--readings", "4"];
    assert!(prints(folder.path(), &args).contains("seed 1, 4 readings a motion"));
}
