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
    // As printed before by default, and the printed estimate before the others.
    let place = |part: &str| story.find(part).unwrap_or_else(|| panic!("{part}: {story}"));
    for [before, after] in [
        ["Algorithm 1 as printed", "Algorithm 1, defaults"],
        ["Algorithm 1, defaults", "example (Section V), look-ahead"],
        ["Algorithm 2 as printed", "Algorithm 2, defaults"],
        ["bisector (the paper's)", "centre of the version space"],
        ["Algorithm 2, defaults", "Side by side"],
    ] {
        assert!(place(before) < place(after), "{before}, {after}");
    }
    for name in [
        "paper-noiseless-defaults.svg",
        "paper-noiseless-lookahead.svg",
        "paper-noisy.svg",
        "paper-noisy-defaults.svg",
        "paper-noisy-lookahead.svg",
        "paper-noisy-candidates.svg",
    ] {
        assert!(folder.path().join("out").join(name).exists(), "{name}");
        assert!(story.contains(name), "{name}");
    }
    let svg = fs::read_to_string(folder.path().join("out/paper-noiseless.svg")).expect("a figure");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for part in ["true line", "p1", "p4", "estimate"] {
        assert!(svg.contains(part), "{part}");
    }
}

/// The table that ends it has the figures of `run`.
#[test]
fn the_bare_command_s_table_tells_what_run_tells() {
    let folder = folder();
    let story = prints(folder.path(), &[]);
    let (_, table) = story.split_once("Side by side").expect("a table");
    let noisy = include_str!("../../scenarios/paper-noisy.toml");
    let printed = "following = \"anyhow\"\nprior = \"sequences\"\nsteps = 10";
    let by_lookahead = |scenario: &str| {
        let scenario = scenario.replace("varrho = 0.1\n", "");
        scenario.replace("\"cfc\"", "\"lookahead\"").replace("\"scc\"", "\"lookahead\"")
    };
    for (scenario, planner, estimate, key) in [
        (GOOD.replace("steps = 10", printed), "Algorithm 1 as printed", "bisector", "bisector"),
        (GOOD.replace("steps = 10", printed), "Algorithm 1 as printed", "centre", "centre"),
        (GOOD.to_owned(), "Algorithm 1, defaults", "centre", "centre"),
        (
            noisy.replace("steps = 10", printed),
            "Algorithm 2 as printed",
            "margin",
            "maximum_margin",
        ),
        (noisy.replace("steps = 10", printed), "Algorithm 2 as printed", "posterior", "centre"),
        (noisy.to_owned(), "Algorithm 2, defaults", "posterior", "centre"),
        (by_lookahead(GOOD), "look-ahead", "centre", "centre"),
        (by_lookahead(noisy), "look-ahead", "posterior", "centre"),
    ] {
        fs::write(folder.path().join("m.toml"), &scenario).expect("a file");
        let trace = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
        let records: Vec<serde_json::Value> =
            trace.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        let number = |value: &serde_json::Value| value.as_f64().expect("a number");
        let (steps, end) = (&records[1..records.len() - 1], &records[records.len() - 1]);
        let (truth, line) = (&records[0]["truth"], &end["estimates"][key]);
        let off = |of: &str| (number(&line[of]) - number(&truth[of])).abs();
        let sum = |of: fn(f64, f64) -> f64| {
            let each = |step: &serde_json::Value| {
                of(number(&step["action"]["v"]), number(&step["action"]["w"]))
            };
            steps.iter().map(each).sum::<f64>()
        };
        let row = table.lines().find(|row| {
            row.trim_start()
                .strip_prefix(planner)
                .is_some_and(|it| it.trim_start().starts_with(estimate))
        });
        let row: Vec<_> = row.expect("a row").split_whitespace().rev().collect();
        let [metres, cost, _, _, intercept, slope, bits] = row[..7] else { panic!("{row:?}") };
        assert_eq!(metres, format!("{:.1}", sum(|v, _| v)), "{row:?}");
        assert_eq!(cost, format!("{:.1}", sum(|v, w| v * v + w * w)), "{row:?}");
        assert_eq!(slope, format!("{:.2}", off("angle")), "{row:?}");
        assert_eq!(intercept, format!("{:.2}", off("intercept")), "{row:?}");
        // By the area prior, which is the one of all runs but one.
        if !scenario.contains("noise = ") || !scenario.contains("sequences") {
            assert_eq!(bits, format!("{:.2}", number(&steps[9]["bits"])), "{row:?}");
        }
    }
}

#[test]
fn margin_sampling_flies_a_scenario() {
    let folder = folder();
    let noisy = include_str!("../../scenarios/paper-noisy.toml");
    for (scenario, planner) in [(GOOD, "\"cfc\""), (noisy, "\"scc\"")] {
        let scenario = scenario.replace(planner, "\"margin\"");
        fs::write(folder.path().join("m.toml"), scenario).expect("a file");
        let trace = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
        let records: Vec<serde_json::Value> =
            trace.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        assert_eq!((&records[0]["algorithm"], records.len()), (&"margin".into(), 12));
        assert!(records[1]["problem"].is_null() && records[1]["label"].is_number());
        assert_eq!(records[1]["hypotheses"].is_number(), planner == "\"scc\"");
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
    for (figure, part) in [("f.svg", "l1 and l2, which bound"), ("c.svg", "plain maximum margin")] {
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

/// A mission that needs no step has travelled nothing, and no motion turns by less than nothing.
#[test]
fn nothing_is_not_printed_as_less_than_nothing() {
    let folder = folder();
    let known = format!(
        "algorithm = \"lookahead\"\nstop = {{ slope_arc_deg = 80, audit = false }}\n{GOOD}"
    );
    let known = known.replace("algorithm = \"cfc\"\n", "");
    fs::write(folder.path().join("m.toml"), known).expect("a file");
    let said = prints(folder.path(), &["run", "m.toml"]);
    assert!(said.contains("0 samples in 0 steps, 0.0 m travelled, control cost 0.0."), "{said}");
    fs::write(folder.path().join("n.toml"), GOOD).expect("a file");
    for algorithm in ["cfc", "lookahead", "random", "margin", "lawnmower"] {
        for seed in 1..=5 {
            let seed = seed.to_string();
            let flags = ["run", "n.toml", "--algorithm", algorithm, "--steps", "60", "--seed"];
            let said = prints(folder.path(), &[&flags[..], &[&seed]].concat());
            assert!(!said.contains("-0.0 "), "{said}");
        }
    }
}

/// A robot that seeks a front goes where one would cross the area. It may miss a spill in the middle, and says so.
#[test]
fn one_label_does_not_rule_out_a_closed_front() {
    let folder = folder();
    let spill = "algorithm = \"track\"\nsteps = 3000\narea = { x = [0.0, 200.0], z = [0.0, 200.0] }\n\
                 front = { radius = 40.0 }\ntruth = { circle = [60.0, 138.0, 40.0] }\noracle = []\n\
                 start = { x = 152.0, z = 51.0 }\n";
    fs::write(folder.path().join("spill.toml"), spill).expect("a file");
    let told = prints(folder.path(), &["run", "spill.toml"]);
    let says = "has the label -1, unless a front is closed within it";
    assert!(told.contains(says), "{told}");
    assert!(told.contains("easily missed without a point inside it"), "{told}");
}
