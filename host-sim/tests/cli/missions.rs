//! Missions: the bare command and `run`.

use std::fs;

use crate::{GOOD, folder, prints};

#[test]
fn the_bare_command_tells_the_paper_s_examples() {
    let folder = folder();
    let story = prints(folder.path(), &[]);
    for part in ["the label flipped", "centre of the version space", "maximum margin", "bisector"] {
        assert!(story.contains(part), "{part}: {story}");
    }
    assert!(story.contains("Credible set"), "{story}");
    for name in ["paper-noisy.svg", "paper-noisy-candidates.svg"] {
        assert!(folder.path().join("out").join(name).exists(), "{name}");
    }
    let svg = fs::read_to_string(folder.path().join("out/paper-noiseless.svg")).expect("a figure");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for part in ["true line", "p1", "p4", "estimate"] {
        assert!(svg.contains(part), "{part}");
    }
}

#[test]
fn run_writes_a_trace_that_keeps_the_contract() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    let args = ["run", "m.toml", "--steps", "7", "--trace", "t.jsonl", "--figure", "f.svg"];
    prints(folder.path(), &args);
    let trace = fs::read_to_string(folder.path().join("t.jsonl")).expect("a trace");
    assert!(folder.path().join("f.svg").exists());
    let records: Vec<serde_json::Value> =
        trace.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(records.len(), 9);
    let (start, end) = (&records[0], &records[8]);
    assert_eq!(start["record"], "start");
    assert_eq!(start["truth"]["slope"], 0.41);
    assert_eq!(start["oracle"][1]["label"], 1);
    assert_eq!(start["p"], 1.0);
    for (step, number) in records[1..8].iter().zip(1..) {
        assert_eq!((&step["record"], &step["step"]), (&"step".into(), &number.into()));
        assert!(step["slope_arcs"][0][1].is_f64() && step["intercept"].is_array());
        // All digits: a reader recovers the lattice.
        let units = step["pose"]["x"].as_f64().expect("a number") * 65_536.0;
        assert!(units.fract().abs() < 1e-12, "{units}");
    }
    let first = &records[1];
    assert_eq!((&first["problem"], &first["recovery"]), (&"P1".into(), &serde_json::Value::Null));
    assert_eq!(first["action"]["w"], 0.76);
    assert_eq!((&end["record"], &end["reason"]), (&"end".into(), &"steps".into()));
    for name in ["bisector", "centre", "maximum_margin"] {
        assert!(end["estimates"][name]["angle"].is_f64(), "{name}");
    }
    assert_eq!(
        prints(folder.path(), &["run", "m.toml", "--steps", "7", "--format", "json"]),
        trace
    );
}

#[test]
fn a_vertical_truth_has_no_slope() {
    let folder = folder();
    let vertical = include_str!("../../scenarios/vertical.toml");
    fs::write(folder.path().join("v.toml"), vertical).expect("a file");
    let trace = prints(folder.path(), &["run", "v.toml", "--format", "json"]);
    let start: serde_json::Value =
        serde_json::from_str(trace.lines().next().expect("a line")).expect("JSON");
    assert!(start["truth"]["slope"].is_null() && start["truth"]["intercept"].is_null());
    assert_eq!(start["truth"]["angle"], 90.0);
}

#[test]
fn a_noisy_run_adds_to_the_trace() {
    let folder = folder();
    let noisy = include_str!("../../scenarios/paper-noisy.toml");
    fs::write(folder.path().join("n.toml"), noisy).expect("a file");
    let args =
        ["run", "n.toml", "--trace", "t.jsonl", "--figure", "f.svg", "--candidates", "c.svg"];
    let story = prints(folder.path(), &args);
    for part in ["Most likely hypothesis", "Credible set", "posterior mean"] {
        assert!(story.contains(part), "{part}: {story}");
    }
    for (figure, part) in [("f.svg", "l1, which bounds"), ("c.svg", "plain maximum margin")] {
        let svg = fs::read_to_string(folder.path().join(figure)).expect("a figure");
        assert!(svg.contains(part), "{figure}: {part}");
    }
    let trace = fs::read_to_string(folder.path().join("t.jsonl")).expect("a trace");
    let records: Vec<serde_json::Value> =
        trace.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(records[0]["p"], 0.7);
    for step in &records[1..=10] {
        assert_eq!(step["trusted"], false);
        assert!(step["hypotheses"].as_u64() > Some(1) && step["entropy"].is_f64());
        assert_eq!(step["pruned_mass"], 0.0);
    }
    let end = &records[11];
    assert!(end["best"]["probability"].is_f64() && end["best"]["slope_arcs"][0][0].is_f64());
    assert_eq!(end["credible"]["level"], 0.9);
    assert!(end["credible"]["probability"].as_f64() >= Some(0.9));
    assert!(end["credible"]["cells"].as_u64() >= Some(1));
}
