//! Scenario files, good ones and one wrong one of each kind.

use std::fs;

use crate::{GOOD, folder, prints, refuses};

#[test]
fn bad_noise_is_refused() {
    let folder = folder();
    let noisy = include_str!("../../scenarios/paper-noisy.toml");
    let good = "p = 0.7, trusted_radius = 0.5";
    let cases: [(&str, &[&str]); 8] = [
        ("p = 1.1", &["noise.p", "found 1.1", "[0, 1]"]),
        ("p = -0.1", &["noise.p", "found -0.1", "[0, 1]"]),
        ("p = nan", &["noise.p", "found NaN", "[0, 1]"]),
        ("p = 0.7, trusted_radius = -0.5", &["noise.trusted_radius", "found -0.5", "at least 0"]),
        ("p = 0.7, trusted_radius = inf", &["noise.trusted_radius", "found inf"]),
        ("p = 0.7, band = -1.0", &["noise.band", "found -1", "distance"]),
        ("p = 0.7, band = 1.0, trusted_radius = 1.0", &["noise", "both", "one of them"]),
        ("trusted_radius = 0.5", &["bad.toml:10", "missing field `p`"]),
    ];
    for (bad, parts) in cases {
        fs::write(folder.path().join("bad.toml"), noisy.replace(good, bad)).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
}

#[test]
fn bad_scenarios_are_refused_by_file_and_field() {
    let folder = folder();
    let cases: [(&str, &str, &[&str]); 22] = [
        ("steps = 10", "steps = ten", &["bad.toml:4"]),
        ("steps = 10", "stepz = 10", &["bad.toml:4", "stepz", "expected one of", "`steps`"]),
        ("steps = 10", "steps = 65", &["steps", "found 65", "1 to 64", "68 samples"]),
        ("steps = 10", "steps = 0", &["steps", "found 0", "1 to 64"]),
        ("steps = 10", "steps = -3", &["bad.toml:4", "-3"]),
        ("\"cfc\"", "\"dfc\"", &["bad.toml:3", "dfc", "`cfc`"]),
        ("varrho = 0.1", "varrho = 1.0", &["varrho", "found 1", "[0, 1)"]),
        ("varrho = 0.1", "varrho = -0.1", &["varrho", "found -0.1", "[0, 1)"]),
        ("varrho = 0.1", "varrho = nan", &["varrho", "found NaN", "[0, 1)"]),
        ("x = [0.0, 20.0]", "x = [20.0, 0.0]", &["area", "[20, 0]", "smaller to larger"]),
        ("x = [0.0, 20.0]", "x = [0.0, 9000.0]", &["area.x", "found 9000", "8192"]),
        ("x = [0.0, 20.0]", "x = [0.0, inf]", &["area.x", "found inf", "finite"]),
        ("heading = 0.0", "heading = nan", &["start.heading", "NaN", "radians"]),
        ("heading = 0.0", "x = 21.0", &["start", "(21, 1)", "inside the area"]),
        ("slope = 0.41, ", "", &["truth", "only one of slope and intercept"]),
        ("slope = 0.41", "slope = inf", &["truth", "inf", "finite"]),
        ("slope = 0.41, intercept = 3.5", "line = [0, 0, 1]", &["truth", "[0.0, 0.0, 1.0]"]),
        ("slope = 0.41", "slope = -4.1", &["oracle[0].label", "found -1", "expected 1", "truth"]),
        (
            "x = 2.0, z = 8.0, label = 1",
            "x = 2.0, z = 8.0, label = 2",
            &["oracle[1].label", "found 2", "-1 or 1"],
        ),
        ("x = 2.0, z = 8.0", "x = 2.0, z = nan", &["oracle[1].z", "NaN", "finite"]),
        ("x = 2.0, z = 8.0", "x = 2.0, z = 20.5", &["oracle[1]", "(2, 20.5)", "inside the area"]),
        ("x = 2.0, z = 8.0", "x = 2.0", &["bad.toml", "missing field `z`"]),
    ];
    for (good, bad, parts) in cases {
        assert!(GOOD.contains(good), "{good}");
        fs::write(folder.path().join("bad.toml"), GOOD.replace(good, bad)).expect("a file");
        let args = ["run", "bad.toml", "--trace", "t.jsonl", "--figure", "f.svg"];
        refuses(folder.path(), &args, &[&["bad.toml"], parts].concat());
    }
}

/// Oracle points as position and label.
type Points<'a> = &'a [(f64, f64, i8)];

#[test]
fn bad_oracles_are_refused() {
    let folder = folder();
    let (before, _) = GOOD.split_once("oracle = [").expect("an oracle");
    let points = |points: &[(f64, f64, i8)]| {
        let each =
            points.iter().map(|(x, z, label)| format!("{{ x = {x}, z = {z}, label = {label} }}"));
        format!("{before}oracle = [{}]\n", each.collect::<Vec<_>>().join(", "))
    };
    let cases: [(Points, &[&str]); 4] = [
        (
            &[(2.0, 8.0, 1), (3.0, 9.0, 1), (4.0, 8.0, 1)],
            &["oracle", "only the label 1", "both labels"],
        ),
        (
            &[(2.0, 2.0, -1), (2.0, 3.0, -1), (2.0, 8.0, 1)],
            &["oracle", "one line", "not collinear"],
        ),
        (&[], &["oracle", "not collinear"]),
        (&[(2.0, 1.0, -1), (2.0, 8.0, 1)], &["oracle", "not collinear"]),
    ];
    for (oracle, parts) in cases {
        fs::write(folder.path().join("bad.toml"), points(oracle)).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
}

#[test]
fn an_oracle_may_have_many_points() {
    let folder = folder();
    let (before, _) = GOOD.split_once("oracle = [").expect("an oracle");
    let oracle = |points: &mut dyn Iterator<Item = (f64, f64, i8)>| {
        let each = points.map(|(x, z, label)| format!("{{ x = {x}, z = {z}, label = {label} }}"));
        format!("{before}oracle = [{}]\n", each.collect::<Vec<_>>().join(", "))
    };
    // Twenty in two rows: few of them bound the line.
    let mut rows = (0..20).map(|i| {
        let (x, above) = (f64::from(i), i % 2 == 1);
        (x, if above { 0.41 * x + 7.0 } else { 0.3 * x }, if above { 1 } else { -1 })
    });
    fs::write(folder.path().join("many.toml"), oracle(&mut rows)).expect("a file");
    for algorithm in ["cfc", "scc", "random"] {
        prints(folder.path(), &["run", "many.toml", "--algorithm", algorithm]);
    }
    // Forty on two parabolas that face each other: all of them do.
    let mut facing = (0..40).map(|i| {
        let (x, above) = (f64::from(i) / 2.0, i % 2 == 1);
        let off = 0.5 + 0.02 * (x - 10.0).powi(2);
        let line = 0.41 * x + 3.5;
        (x, if above { line + off } else { line - off }, if above { 1 } else { -1 })
    });
    fs::write(folder.path().join("bad.toml"), oracle(&mut facing)).expect("a file");
    refuses(folder.path(), &["run", "bad.toml"], &["oracle", "bound the line", "at most 15"]);
}
