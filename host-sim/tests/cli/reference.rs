//! `reference`: the full-horizon problem of a scenario, and what is refused. Optima are checked in `tests`.

use std::fs;

use serde_json::Value;

use crate::{GOOD, folder, prints, refuses};

const NOISY: &str = include_str!("../../scenarios/paper-noisy.toml");

/// Few actions, so that it takes no time.
const COARSE: &str = "vehicle = { kind = \"unicycle\", step = 1.0, turn_step = 0.5 }\n";

#[test]
fn the_optimum_stands_beside_what_planners_pay() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    let steps = ["--speed-step", "0.5", "--turn-step", "0.3"];
    let args =
        [&["reference", "m.toml", "--horizon", "5", "--line", "margin"][..], &steps].concat();
    let story = prints(folder.path(), &[&args[..], &["--figure", "f.svg"]].concat());
    for part in
        ["Section II-A: 5 motions of 65 actions", "1 / (2 margin^2)", "optimum", "look-ahead"]
    {
        assert!(story.contains(part), "expected {part:?} in: {story}");
    }
    let svg = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
    assert!(svg.starts_with("<svg") && svg.contains("m.toml, optimum"));
    let record: Value =
        serde_json::from_str(&prints(folder.path(), &[&args[..], &["--format", "json"]].concat()))
            .expect("JSON");
    assert_eq!((&record["problem"], &record["horizon"]), (&"II-A".into(), &5.into()));
    assert_eq!(record["optimum"].as_array().map(Vec::len), Some(5));
    let [optimum, others @ ..] = record["accounts"].as_array().expect("accounts").as_slice() else {
        panic!("no account")
    };
    assert_eq!(others.len(), 2);
    let [best, line, control] = ["objective", "line_cost", "control_cost"]
        .map(|key| optimum[key].as_f64().expect("a number"));
    assert!((best - line - control).abs() < 1e-6 && optimum["above"] == 0.0, "{optimum}");
    let mut compared = 0;
    for other in others {
        // Either it keeps all constraints and pays more, or it says which ones it breaks.
        let keeps = other["broken"].as_array().is_some_and(Vec::is_empty);
        assert_eq!(other["above"].as_f64().is_some_and(|above| above > 0.0), keeps, "{other}");
        compared += u32::from(keeps);
    }
    assert!(compared > 0, "{record}");
}

#[test]
fn where_labels_may_be_wrong_nothing_moves() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), format!("{COARSE}{NOISY}")).expect("a file");
    let args = ["reference", "m.toml", "--horizon", "3", "--format", "json"];
    let record: Value = serde_json::from_str(&prints(folder.path(), &args)).expect("JSON");
    assert_eq!(record["problem"], "II-B");
    assert_eq!(record["accounts"][0]["objective"], -4.0);
    assert_eq!(record["accounts"][0]["control_cost"], 0.0);
}

#[test]
fn where_no_sequence_keeps_the_constraints_it_says_so() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), format!("{COARSE}{GOOD}")).expect("a file");
    let args = ["reference", "m.toml", "--horizon", "1"];
    assert!(prints(folder.path(), &args).contains("No sequence of so many motions keeps"));
    let record: Value =
        serde_json::from_str(&prints(folder.path(), &[&args[..], &["--format", "json"]].concat()))
            .expect("JSON");
    assert_eq!(record["optimum"], Value::Null);
    assert_eq!(record["accounts"][0]["broken"], serde_json::json!(["labels"]));
    refuses(
        folder.path(),
        &[&args[..], &["--figure", "f.svg"]].concat(),
        &["--figure", "no sequence", "expected an optimum to draw"],
    );
}

#[test]
fn wrong_values_are_refused() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write("m.toml", &format!("{COARSE}{GOOD}"));
    write("noisy.toml", &format!("{COARSE}{NOISY}"));
    let flags: [(&[&str], &[&str]); 17] = [
        (&["m.toml"], &["--horizon"]),
        (&["m.toml", "--horizon", "0"], &["m.toml: --horizon: found 0, expected 1 to 12"]),
        (&["m.toml", "--horizon", "13"], &["m.toml: --horizon: found 13, expected 1 to 12"]),
        (&["m.toml", "--horizon", "-1"], &["-1"]),
        (&["m.toml", "--horizon", "2.5"], &["2.5", "--horizon"]),
        (&["none.toml", "--horizon", "2"], &["none.toml", "readable"]),
        (&["m.toml", "--horizon", "2", "--line", "square"], &["square", "slope, margin"]),
        (
            &["noisy.toml", "--horizon", "2", "--line", "slope"],
            &["noisy.toml: --line", "may be wrong"],
        ),
        (
            &["m.toml", "--horizon", "2", "--speed-step", "0.3"],
            &["--speed-step", "found 0.3", "2 m"],
        ),
        (&["m.toml", "--horizon", "2", "--speed-step", "0"], &["--speed-step", "found 0"]),
        (&["m.toml", "--horizon", "2", "--speed-step", "nan"], &["--speed-step", "found NaN"]),
        (&["m.toml", "--horizon", "2", "--speed-step=-1"], &["--speed-step", "found -1"]),
        (&["m.toml", "--horizon", "2", "--turn-step", "0"], &["--turn-step", "found 0"]),
        (&["m.toml", "--horizon", "2", "--turn-step", "4"], &["--vehicle", "a step of turning"]),
        (&["m.toml", "--horizon", "2", "--turn-step", "1e-6"], &["vehicle: found", "--turn-step"]),
        (&["m.toml", "--horizon", "2", "--figure", "m.toml"], &["--figure", "m.toml"]),
        (&["m.toml", "--horizon", "2", "--format", "csv"], &["csv", "text, json"]),
    ];
    for (args, parts) in flags {
        refuses(folder.path(), &[&["reference"], args].concat(), parts);
    }
    let scenarios: [(&str, &[&str]); 7] = [
        (&format!("errors = {{ motion = 0.1 }}\n{GOOD}"), &["errors", "expected none"]),
        (&format!("tolerance = 0.125\n{GOOD}"), &["tolerance: found 0.125 m, expected 0"]),
        (
            &format!("stop = {{ slope_arc_deg = 1.0 }}\n{}", GOOD.replace("cfc", "lookahead")),
            &["stop: found one"],
        ),
        (&NOISY.replace("\"scc\"", "\"cfc\""), &["algorithm: found \"cfc\" with noise"]),
        (&GOOD.replace("slope = 0.41, intercept = 3.5", "line = [-1.0, 0.0, 10.0]"), &["oracle"]),
        (&format!("fan = \"fine\"\n{GOOD}"), &["vehicle: found 65973495 actions", "--turn-step"]),
        (
            &GOOD
                .replace("slope = 0.41, intercept = 3.5", "line = [1.0, 0.0, -10.0]")
                .replace("x = 2.0, z = 8.0, label = 1", "x = 2.0, z = 8.0, label = -1")
                .replace("x = 18.0, z = 5.0, label = -1", "x = 18.0, z = 5.0, label = 1"),
            &["truth: found a vertical line", "--line margin"],
        ),
    ];
    for (scenario, parts) in scenarios {
        write("bad.toml", scenario);
        let parts = [&["bad.toml"], parts].concat();
        refuses(folder.path(), &["reference", "bad.toml", "--horizon", "2"], &parts);
    }
}

#[test]
fn a_size_that_would_not_end_is_refused_with_what_is_possible() {
    let folder = folder();
    let fewer = "vehicle = { kind = \"unicycle\", step = 0.2, turn_step = 0.05 }\n";
    fs::write(folder.path().join("m.toml"), format!("{fewer}{GOOD}")).expect("a file");
    let parts =
        ["--horizon: found 9 motions of 715 actions", "at most", "--speed-step, --turn-step"];
    refuses(folder.path(), &["reference", "m.toml", "--horizon", "9"], &parts);
}
