//! Sensors that fail: each kind of fault flies a mission, and wrong values are refused.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::{GOOD, folder, host_sim, prints, refuses, text};

/// A folder with `m.toml`, whose sensor fails so.
fn failing(scenario: &str, sensor: &str) -> TempDir {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), format!("sensor = {sensor}\n{scenario}"))
        .expect("a file");
    folder
}

/// The records of the mission, whether a label contradicts what is known or not.
fn flown(folder: &Path) -> Vec<Value> {
    let output = host_sim(folder, &["run", "m.toml", "-q", "--format", "json"]);
    let message = text(&output.stderr);
    assert!(output.status.success() || message.contains("contradicts"), "{message}");
    let records = text(&output.stdout);
    records.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// The labels of the steps on which one was wanted.
fn labels(records: &[Value]) -> Vec<Option<i64>> {
    let steps = &records[1..records.len() - 1];
    steps.iter().map(|step| step["label"].as_i64()).collect()
}

#[test]
fn wrong_sensors_are_refused() {
    let kinds = "one of off, stuck, garbage, inverted, slow, delayed and dropouts";
    let many = format!("[{}]", ["{ off = true }"; 17].join(", "));
    let cases: [(&str, &[&str]); 19] = [
        ("[{}]", &["sensor[0]: found no kind", kinds]),
        ("[{ from = 5 }]", &["sensor[0]: found no kind", kinds]),
        ("[{ off = true, stuck = 1 }]", &["sensor[0]: found more than one kind", kinds]),
        ("[{ off = false }]", &["sensor[0].off: found false, expected true"]),
        ("[{ garbage = false }]", &["sensor[0].garbage: found false"]),
        ("[{ inverted = false }]", &["sensor[0].inverted: found false"]),
        ("[{ off = true }, { stuck = 0 }]", &["sensor[1].stuck: found 0, expected -1 or 1"]),
        ("[{ slow = -0.5 }]", &["sensor[0].slow: found -0.5, expected a distance in metres"]),
        ("[{ slow = nan }]", &["sensor[0].slow: found NaN"]),
        ("[{ slow = inf }]", &["sensor[0].slow: found inf", "0 to 1024"]),
        ("[{ delayed = 0 }]", &["sensor[0].delayed: found 0", "1 or more"]),
        ("[{ delayed = 1.5 }]", &["bad.toml:1", "1.5"]),
        ("[{ dropouts = 1.1 }]", &["sensor[0].dropouts: found 1.1", "[0, 1]"]),
        ("[{ off = true, from = 0 }]", &["sensor[0].from: found 0", "1 or more"]),
        ("[{ off = true, from = 5, to = 4 }]", &["sensor[0].to: found 4", "5 or more"]),
        ("[{ off = true, until = 4 }]", &["bad.toml:1", "until", "`to`"]),
        ("[{ off = true, from = 4294967296 }]", &["sensor[0].from: found 4294967296"]),
        ("{ off = true }", &["bad.toml:1", "expected a sequence"]),
        (&many, &["sensor: found 17 faults, expected at most 16"]),
    ];
    let folder = folder();
    for (sensor, parts) in cases {
        fs::write(folder.path().join("bad.toml"), format!("sensor = {sensor}\n{GOOD}"))
            .expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
    fs::write(folder.path().join("bad.toml"), format!("sensor = [[true]]\n{GOOD}"))
        .expect("a file");
    refuses(folder.path(), &["run", "bad.toml"], &["bad.toml:1", "expected a table"]);
}

/// Every kind in a mission of each planner: the start record gives the keys back, and the fault is seen in the labels.
#[test]
fn each_fault_flies_a_mission() {
    let noisy = GOOD.replace("steps = 10", "steps = 12\nnoise = { p = 0.9 }");
    for (sensor, seen) in [
        ("[{\"off\":true,\"from\":3}]", "[{ off = true, from = 3 }]"),
        ("[{\"stuck\":1,\"from\":2,\"to\":6}]", "[{ stuck = 1, from = 2, to = 6 }]"),
        ("[{\"garbage\":true}]", "[{ garbage = true, from = 1 }]"),
        ("[{\"inverted\":true}]", "[{ inverted = true }]"),
        ("[{\"slow\":0.5}]", "[{ slow = 0.5 }]"),
        ("[{\"delayed\":2}]", "[{ delayed = 2 }]"),
        ("[{\"dropouts\":0.5}]", "[{ dropouts = 0.5 }]"),
        ("[{\"slow\":0.5},{\"stuck\":-1,\"to\":3}]", "[{ slow = 0.5 }, { stuck = -1, to = 3 }]"),
    ] {
        let mut whole = Vec::new();
        for algorithm in ["scc", "lookahead", "margin", "random", "lawnmower"] {
            let scenario = noisy.replace("\"cfc\"", &format!("\"{algorithm}\""));
            let records = flown(failing(&scenario, seen).path());
            let told: Value = serde_json::from_str(sensor).expect("JSON");
            assert_eq!(records[0]["sensor"], told, "{algorithm}");
            assert_eq!(records.len(), 14, "{algorithm} with {seen}: {:?}", records.last());
            assert_eq!(records[13]["reason"], "steps", "{algorithm} with {seen}");
            let without = flown(failing(&scenario, "[]").path());
            assert!(without[0].get("sensor").is_none());
            whole.push((labels(&without), labels(&records)));
        }
        assert!(whole.iter().any(|(sound, failing)| sound != failing), "{seen} spoils nothing");
        let failing = || whole.iter().map(|(_, failing)| failing);
        match seen {
            _ if seen.contains("off") => {
                assert!(failing().all(|it| it.iter().flatten().count() == 2), "{whole:?}");
            }
            _ if seen.contains("stuck = 1") => {
                let stuck = |it: &Vec<Option<i64>>| {
                    let read: Vec<_> = it.iter().flatten().collect();
                    read[1..6].iter().all(|label| **label == 1)
                };
                assert!(failing().all(stuck), "{whole:?}");
            }
            _ if seen.contains("dropouts") => {
                assert!(failing().all(|it| it.contains(&None)), "{whole:?}");
            }
            _ => {}
        }
    }
}

/// Without a reading nothing is learnt, and the mission ends with its steps.
#[test]
fn a_sensor_that_is_off_leaves_a_mission_to_its_steps() {
    for algorithm in ["cfc", "scc", "lookahead", "margin", "random", "lawnmower"] {
        for steps in [10, 64] {
            let scenario = GOOD
                .replace("\"cfc\"", &format!("\"{algorithm}\""))
                .replace("steps = 10", &format!("steps = {steps}"));
            let folder = failing(&scenario, "[{ off = true }]");
            let records = flown(folder.path());
            assert_eq!(records.last().expect("an end")["reason"], "steps", "{algorithm}");
            assert_eq!(labels(&records), vec![None; steps], "{algorithm}");
            let bits = records[steps]["bits"].as_f64().expect("bits");
            assert!(bits.abs() < 1e-6, "{algorithm}: {bits}");
        }
    }
}

#[test]
fn text_page_and_trace_name_the_faults_in_one_line() {
    let folder = failing(GOOD, "[{ inverted = true, from = 4, to = 4 }, { dropouts = 0.25 }]");
    let output = host_sim(folder.path(), &["run", "m.toml", "-q", "--report", "r.html"]);
    let said = text(&output.stdout);
    let line = "The sensor fails, unknown to the agent: inverted from label 4 to 4; no reading with \
                probability 0.25\n";
    assert!(said.contains(line), "{said}");
    let page = fs::read_to_string(folder.path().join("r.html")).expect("a page");
    let line = "The sensor fails, unknown to a planner: inverted from label 4 to 4; no reading with \
                probability 0.25.";
    assert!(page.contains(line) && !page.contains("Labels are true"), "{page}");
    // The words of the other kinds.
    let rest = "[{ stuck = -1 }, { off = true, from = 50 }, { garbage = true, to = 2 }, { slow = 0.5, from = 50 }, \
                { delayed = 2, from = 50 }]";
    let said = prints(failing(GOOD, rest).path(), &["run", "m.toml", "--steps", "1"]);
    let words = "stuck at -1; off from label 50 on; either label by chance from label 1 to 2; slow by 0.5 m from label \
                 50 on; late by 2 labels from label 50 on\n";
    assert!(said.contains(words), "{said}");
}

/// A label that is known to be wrong is marked, and a mission without faults says nothing of them.
#[test]
fn wrong_labels_are_marked_where_the_sensor_fails() {
    let folder = failing(GOOD, "[{ inverted = true, from = 1, to = 1 }]");
    let args = ["run", "m.toml", "-q", "--figure", "f.svg", "--steps", "1"];
    let said = text(&host_sim(folder.path(), &args).stdout);
    assert!(said.contains("the label is wrong"), "{said}");
    let figure = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
    assert!(figure.contains("ringed: the label is wrong"));
    let sound = failing(GOOD, "[]");
    let said = prints(sound.path(), &["run", "m.toml"]);
    fs::write(sound.path().join("m.toml"), GOOD).expect("a file");
    assert_eq!(said, prints(sound.path(), &["run", "m.toml"]));
    assert!(!said.contains("sensor") && !said.contains("wrong"), "{said}");
}

/// A sensor that is stuck is found out by its labels: with a goal and without, and also where labels may be wrong.
#[test]
fn a_stuck_sensor_is_named_in_the_result() {
    let goal = "stop = { slope_arc_deg = 0.5 }\n";
    let doubtful = "noise = { p = 0.9 }\n";
    for (algorithm, more) in
        [("lookahead", goal), ("lookahead", ""), ("cfc", ""), ("scc", doubtful)]
    {
        let scenario = GOOD
            .replace("\"cfc\"", &format!("\"{algorithm}\""))
            .replace("steps = 10", &format!("steps = 40\n{more}"));
        let folder = failing(&scenario, "[{ stuck = 1 }]");
        let records = flown(folder.path());
        let end = records.last().expect("an end");
        let told = &end["diagnosis"];
        let cause = told["cause"].as_str().expect("a cause");
        // Where labels are true, it and an inverted one may read the same.
        let shares = ["stuck", "inverted"].map(|it| told["shares"][it].as_f64());
        let is_named = cause.starts_with("stuck") || shares.iter().flatten().sum::<f64>() > 0.75;
        assert!(is_named, "{algorithm} {more}: {told}");
        assert_eq!(told.get("refuting").is_some(), more == goal);
        assert_eq!(told.get("shares").is_some(), more != doubtful);
        let output = host_sim(folder.path(), &["run", "m.toml", "-q"]);
        let said = text(&output.stdout);
        let explanation = said.lines().find(|line| line.starts_with("Explanation: "));
        let explanation = explanation.expect("an explanation");
        assert!(explanation.contains("the sensor is stuck on a label"), "{said}");
        assert!(said.contains("To do: check the sensor"), "{said}");
    }
    // Of a sound sensor nothing is said.
    let scenario = GOOD
        .replace("\"cfc\"", "\"lookahead\"")
        .replace("steps = 10", &format!("steps = 40\n{goal}"));
    let records = flown(failing(&scenario, "[]").path());
    assert!(records.last().expect("an end").get("diagnosis").is_none());
}

/// A slow sensor reads the place before, so its labels are wrong within that distance of the line alone.
#[test]
fn a_slow_sensor_errs_near_the_line() {
    let scenario = GOOD.replace("\"cfc\"", "\"random\"").replace("steps = 10", "steps = 64");
    let folder = failing(&scenario, "[{ slow = 0.5 }]");
    let records = flown(folder.path());
    let mut wrong = 0;
    for step in &records[1..records.len() - 1] {
        let [x, z] = ["x", "z"].map(|axis| step["pose"][axis].as_f64().expect("metres"));
        let off = (z - 0.41 * x - 3.5) / (1.0 + 0.41_f64 * 0.41).sqrt();
        if (off > 0.0) != (step["label"] == 1) {
            wrong += 1;
            assert!(off.abs() < 0.5, "{off}");
        }
    }
    assert!(wrong > 0, "none of the labels is late");
}

/// By the protocol, a board that gets no reading ends its mission; and one that reads its own sensor has other faults.
#[test]
fn a_board_is_refused_faults_that_it_cannot_fly_with() {
    for sensor in ["[{ off = true }]", "[{ stuck = 1 }, { delayed = 1 }]", "[{ dropouts = 0.1 }]"] {
        let args = ["hil", "m.toml", "--emulator=m.toml"];
        let parts =
            ["m.toml: sensor: found off, delayed or dropouts, expected none of them with hil"];
        refuses(failing(GOOD, sensor).path(), &args, &parts);
    }
    let args = ["hil", "m.toml", "--emulator=m.toml", "--labels", "chip"];
    let parts = ["m.toml: sensor: found faults, expected none with --labels chip"];
    refuses(failing(GOOD, "[{ stuck = 1 }]").path(), &args, &parts);
}

#[test]
fn the_papers_problem_has_no_faults() {
    let folder = failing(GOOD, "[{ off = true }]");
    let args = ["reference", "m.toml", "--horizon", "2", "--speed-step", "2", "--turn-step", "1"];
    refuses(folder.path(), &args, &["sensor: found one that fails, expected none"]);
}
