//! A boundary that may bend and move: `allow` goes into the tolerance, and results name its parts.

use std::fs;

use serde_json::{Value, json};

use crate::{GOOD, folder, host_sim, prints, refuses, text};

/// A mission whose boundary is `truth`, with these settings.
fn mission(truth: &str, settings: &str) -> String {
    format!(
        r#"algorithm = "lookahead"
steps = 60
truth = {truth}
oracle = [
  {{ x = 2.0, z = 1.0, label = -1 }},
  {{ x = 2.0, z = 8.0, label = 1 }},
  {{ x = 18.0, z = 16.0, label = 1 }},
  {{ x = 18.0, z = 5.0, label = -1 }},
]
{settings}
"#
    )
}

const SINE: &str = "{ sine = [0.2, 20.0, 0.0], slope = 0.41, intercept = 3.5 }";
const STOP: &str = "stop = { slope_arc_deg = 10.0 }";

fn end(printed: &str) -> Value {
    serde_json::from_str(printed.lines().last().expect("an end")).expect("JSON")
}

/// A goal that a bend refutes is met where the bend is allowed for. The result, the page and the trace name the parts.
#[test]
fn what_is_allowed_for_is_told_and_refutes_nothing() {
    let folder = folder();
    let write = |settings: &str| {
        fs::write(folder.path().join("m.toml"), mission(SINE, settings)).expect("a file");
    };
    write("stop = { slope_arc_deg = 0.5 }");
    let told = prints(folder.path(), &["run", "m.toml"]);
    assert!(told.contains("no straight, still line explains"), "{told}");
    write("tolerance = 0.03\nallow = { bend = 0.2 }\nstop = { slope_arc_deg = 5.0 }");
    let flags = ["run", "m.toml", "--report", "r.html", "--trace", "t.jsonl"];
    let told = prints(folder.path(), &flags);
    let parts = "within 0.23 m (0.03 position + 0.2 bend) of the reported position";
    for said in [
        parts,
        "Known: any two of the lines left differ by 5 deg at most.",
        "If the boundary bends by at most 0.2 m and moves by at most 0 m, one of these lines was within 0.2 m of it",
    ] {
        assert!(told.contains(said), "{said}: {told}");
    }
    let page = fs::read_to_string(folder.path().join("r.html")).expect("a page");
    assert!(page.contains(parts));
    let trace = fs::read_to_string(folder.path().join("t.jsonl")).expect("a trace");
    let start: Value = serde_json::from_str(trace.lines().next().expect("a start")).expect("JSON");
    let sum = json!({ "sum": 0.23, "position": 0.03, "bend": 0.2, "drift": 0.0, "lag": 0.0 });
    assert_eq!(start["tolerance"], sum);
    assert_eq!(
        (&end(&trace)["reason"], &end(&trace)["goal"]["is_met"]),
        (&json!("known"), &json!(true))
    );
}

/// The sum is the tolerance: a mission that is told it in parts flies as one that is told it whole.
#[test]
fn parts_fly_as_their_sum() {
    let folder = folder();
    let drift = "{ slope = 0.41, intercept = 3.5, drift = [0.01, 0.0] }";
    let fly = |settings: &str| {
        let text = mission(drift, &format!("{settings}\n{STOP}"));
        fs::write(folder.path().join("m.toml"), text).expect("a file");
        let printed = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
        printed.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    let whole = fly("tolerance = 0.875");
    for parts in [
        "tolerance = 0.125\nallow = { bend = 0.25, drift = 0.375, lag = 0.125 }",
        "allow = { drift = 0.875 }",
        "tolerance = 0.875\nallow = {}",
    ] {
        assert_eq!(fly(parts), whole, "{parts}");
    }
    let campaign = |flags: &[&str]| {
        let all = [&["campaign", "--fields", "4", "--algorithm", "lookahead"], flags].concat();
        prints(folder.path(), &all)
    };
    let whole = campaign(&["--tolerance", "0.75"]);
    assert_eq!(campaign(&["--bend", "0.25", "--drift", "0.5"]), whole);
    assert_eq!(campaign(&["--bend", "0.25", "--drift", "0.25", "--tolerance", "0.25"]), whole);
    assert_ne!(campaign(&[]), whole);
}

#[test]
fn bad_allowances_are_refused() {
    let folder = folder();
    let cases: [(&str, &[&str]); 8] = [
        ("allow = { bend = -0.1 }", &["allow.bend: found -0.1, expected a distance in metres"]),
        ("allow = { drift = nan }", &["allow.drift: found NaN"]),
        ("allow = { lag = inf }", &["allow.lag: found inf"]),
        ("allow = { bend = 2000.0 }", &["allow.bend: found 2000", "0 to 1024"]),
        ("allow = { wave = 0.1 }", &["bad.toml:1", "wave"]),
        ("allow = [0.1]", &["bad.toml:1", "a table"]),
        (
            "allow = { bend = 5.0, drift = 6.0 }",
            &["tolerance: found 11 m (0 position + 5 bend + 6 drift)", "half the breadth"],
        ),
        (
            "tolerance = 1000.0\nallow = { bend = 30.0 }",
            &["tolerance: found 1030 m (1000 position + 30 bend)", "0 to 1024"],
        ),
    ];
    for (settings, parts) in cases {
        fs::write(folder.path().join("bad.toml"), format!("{settings}\n{GOOD}")).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
    fs::write(folder.path().join("bad.toml"), format!("allow = {{ bend = 0.1 }}\n{GOOD}"))
        .expect("a file");
    refuses(folder.path(), &["reference", "bad.toml", "--horizon", "2"], &["allow: found"]);
    for (flag, parts) in [
        ("--bend=-1", ["--bend: found -1", "a distance in metres"]),
        ("--drift=nan", ["--drift: found NaN", "a distance in metres"]),
        ("--bend=11", ["--tolerance: found 11 m", "half the breadth"]),
    ] {
        refuses(folder.path(), &["campaign", "--fields", "2", flag], &parts);
    }
}

/// The oracle's points are taken to be true of the straight line, so they must be far enough from the boundary.
#[test]
fn an_oracle_near_the_boundary_draws_a_warning() {
    let folder = folder();
    let warns = |bend: &str| {
        let text = mission(SINE, &format!("allow = {{ bend = {bend} }}\n{STOP}"));
        fs::write(folder.path().join("m.toml"), text).expect("a file");
        text_of(&host_sim(folder.path(), &["run", "m.toml"]))
    };
    let warned = warns("3.2");
    assert!(
        warned.contains("warning: oracle[0]: ") && warned.contains("drift by 3.2 m"),
        "{warned}"
    );
    assert!(!warns("0.2").contains("oracle"));
}

fn text_of(output: &std::process::Output) -> String {
    text(&output.stderr)
}
