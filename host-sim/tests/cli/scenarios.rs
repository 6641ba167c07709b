//! Scenario files, good ones and one wrong one of each kind.

use std::fs;

use serde_json::Value;

use crate::{GOOD, folder, host_sim, prints, refuses, text};

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
    let cases: [(&str, &str, &[&str]); 24] = [
        ("truth = { slope = 0.41, intercept = 3.5 }", "", &["bad.toml", "truth", "found none"]),
        ("steps = 10", "steps = ten", &["bad.toml:4"]),
        ("steps = 10", "stepz = 10", &["bad.toml:4", "stepz", "expected one of", "`steps`"]),
        ("steps = 10", "steps = 10001", &["steps", "found 10001", "1 to 10000"]),
        ("steps = 10", "steps = 0", &["steps", "found 0", "1 to 10000"]),
        ("steps = 10", "steps = -3", &["bad.toml:4", "-3"]),
        ("steps = 10", "fan = \"finer\"", &["bad.toml:4", "finer", "`paper` or `fine`"]),
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

#[test]
fn bad_vehicles_are_refused() {
    let folder = folder();
    let cases: [(&str, &str, &[&str]); 20] = [
        ("", "{ kind = \"tank\" }", &["bad.toml:1", "tank", "`car`"]),
        ("", "[\"car\", 3.0]", &["bad.toml:1", "a table"]),
        ("", "{ radius = 3.0 }", &["bad.toml:1", "missing field `kind`"]),
        ("", "{ kind = \"car\", wheels = 3 }", &["bad.toml:1", "wheels", "expected one of"]),
        ("", "{ kind = \"car\" }", &["vehicle.radius", "found none", "turning circle"]),
        ("", "{ kind = \"car\", radius = 3.0, sharpest = 1.0 }", &["vehicle.sharpest", "a car"]),
        ("", "{ kind = \"boat\", radius = 3.0 }", &["vehicle.radius", "a boat"]),
        ("", "{ kind = \"unicycle\", shortest = 3.0 }", &["vehicle.shortest", "a unicycle"]),
        ("", "{ kind = \"car\", radius = 5000.0 }", &["vehicle", "below 2048 m"]),
        ("", "{ kind = \"car\", radius = nan }", &["vehicle.radius", "found NaN", "metres"]),
        ("", "{ kind = \"car\", radius = 3.0, shortest = 2.1 }", &["vehicle", "goes round it"]),
        ("", "{ kind = \"boat\", reach = 2.05 }", &["vehicle.reach", "found 2.05", "steps"]),
        (
            "",
            "{ kind = \"unicycle\", reach = 3000 }",
            &["vehicle.reach: found 3000 m", "less than 3000 m"],
        ),
        (
            "",
            "{ kind = \"car\", reach = 4000, radius = 3 }",
            &["vehicle.reach: found 4000 m", "3000 m"],
        ),
        ("", "{ kind = \"boat\", step = 0.0 }", &["vehicle.step", "found 0", "millimetre"]),
        ("", "{ kind = \"boat\", sharpest = 4.0 }", &["vehicle", "0.001 to pi rad"]),
        ("", "{ kind = \"unicycle\", turn_step = 1e-9 }", &["vehicle.turn_step", "microradian"]),
        ("fan = \"fine\"", "{ kind = \"boat\", turn_step = 0.01 }", &["vehicle.turn_step", "fan"]),
        ("", "{ kind = \"car\", radius = 12.0 }", &["vehicle", "20 m x 20 m", "25110 mm across"]),
        ("", "{ kind = \"boat\" }", &["vehicle", "with random", "cfc, scc or lookahead"]),
    ];
    for (before, vehicle, parts) in cases {
        let good = if parts.contains(&"with random") {
            GOOD.replace("\"cfc\"", "\"random\"")
        } else {
            GOOD.to_owned()
        };
        let bad = format!("vehicle = {vehicle}\n{before}\n{good}");
        fs::write(folder.path().join("bad.toml"), bad).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
}

/// The paper's unicycle may be spelt out; a car needs its radius alone.
#[test]
fn bad_areas_are_refused() {
    const SQUARE: &str = "[[0, 0], [20, 0], [20, 20], [0, 20]]";
    let folder = folder();
    let many = format!("[{}]", ["[0, 0]"; 9].join(", "));
    let polygons: [(&str, &[&str]); 9] = [
        ("[]", &["area.polygon", "0 corners", "3 at least"]),
        ("[[0, 0], [20, 0]]", &["area.polygon", "2 corners", "3 at least"]),
        ("[[0, 0], [20, 0], [5, 5], [0, 20]]", &["area.polygon", "[5, 5]", "convex", "at most 8"]),
        ("[[0, 0], [20, 20], [20, 0], [0, 20]]", &["area.polygon", "convex"]),
        ("[[0, 0], [10, 0], [20, 0], [0, 20]]", &["area.polygon", "no three are in line"]),
        ("[[0, 0], [20, 0], [0, 20, 3]]", &["bad.toml:1", "array of 2 numbers"]),
        ("[[0, 0], [9000, 0], [0, 20]]", &["area.polygon[1].x", "found 9000", "8192"]),
        ("[[0, 0], [10, 0], [0, 10]]", &["oracle[2]", "(18, 16)", "inside the area"]),
        (&many, &["area.polygon", "at most 8"]),
    ];
    let good = GOOD.replace("area = { x = [0.0, 20.0], z = [0.0, 20.0] }\n", "");
    assert_ne!(good, GOOD);
    for (polygon, parts) in polygons {
        let bad = format!("area = {{ polygon = {polygon} }}\n{good}");
        fs::write(folder.path().join("bad.toml"), bad).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
    let disc = "{ x = 12, z = 3, radius = 1 }";
    let nine = [disc; 9].join(", ");
    let keep_outs: [(&str, &[&str]); 10] = [
        ("{ x = 5, z = 6 }", &["keep_out[0]", "{ x, z, radius } or { polygon }"]),
        ("{ x = 5, z = 6, radius = 0 }", &["keep_out[0].radius", "found 0", "above 0"]),
        ("{ x = 5, z = 6, radius = -1 }", &["keep_out[0].radius", "found -1"]),
        ("{ x = 5, z = 6, radius = nan }", &["keep_out[0].radius", "found NaN"]),
        ("{ x = 5, z = inf, radius = 1 }", &["keep_out[0].z", "found inf", "finite"]),
        ("{ polygon = [[5, 6]] }", &["keep_out[0].polygon", "1 corners", "2 at least"]),
        ("{ polygon = [[5, 6], [5, 6]] }", &["keep_out[0].polygon", "convex"]),
        ("{ x = 2, z = 1.5, radius = 1 }", &["oracle[0]", "(2, 1)", "outside keep_out[0]"]),
        ("{ x = 12, z = 3, radius = 1, colour = 2 }", &["bad.toml:1", "colour"]),
        (&nine, &["keep_out", "found 9", "at most 8"]),
    ];
    for (keep_out, parts) in keep_outs {
        let bad = format!("keep_out = [{keep_out}]\n{GOOD}");
        fs::write(folder.path().join("bad.toml"), bad).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
    let over_start = GOOD.replace("heading = 0.0", "x = 12.0, z = 3.5");
    fs::write(folder.path().join("bad.toml"), format!("keep_out = [{disc}]\n{over_start}"))
        .expect("a file");
    let parts = ["bad.toml", "start", "(12, 3.5)", "outside keep_out[0]"];
    refuses(folder.path(), &["run", "bad.toml"], &parts);
    let both = format!("area = {{ polygon = {SQUARE}, x = [0, 20] }}\n{good}");
    fs::write(folder.path().join("bad.toml"), both).expect("a file");
    refuses(folder.path(), &["run", "bad.toml"], &["bad.toml", "area", "either { x, z }"]);
}

#[test]
fn an_area_with_keep_outs_flies() {
    let folder = folder();
    let trace = |area: &str| {
        let good = GOOD.replace("area = { x = [0.0, 20.0], z = [0.0, 20.0] }\n", "");
        fs::write(folder.path().join("good.toml"), format!("{area}\n{good}")).expect("a file");
        prints(folder.path(), &["run", "good.toml", "--format", "json", "--figure", "f.svg"])
    };
    let plain = trace("");
    assert!(!plain.contains("polygon") && !plain.contains("keep_out"));
    let square = "area = { polygon = [[0, 20], [20, 20], [20, 0], [0, 0]] }";
    assert_eq!(trace(square), plain, "a rectangle is a polygon");
    let cut = "area = { polygon = [[0, 0], [20, 0], [20, 20], [1, 20]] }";
    let flown = trace(&format!("{cut}\nkeep_out = [{{ x = 12, z = 3, radius = 1 }}]"));
    let start: Value = serde_json::from_str(flown.lines().next().expect("a record")).expect("JSON");
    assert_eq!(start["area"]["polygon"][3], serde_json::json!([1.0, 20.0]));
    let disc = serde_json::json!([{ "polygon": [[12.0, 3.0]], "radius": 1.0 }]);
    assert_eq!(start["keep_out"], disc);
    let figure = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
    assert!(figure.contains("kept out of"));
}

#[test]
fn a_vehicle_flies() {
    let folder = folder();
    let trace = |vehicle: &str| {
        let text = format!("{vehicle}\n{GOOD}");
        fs::write(folder.path().join("good.toml"), text).expect("a file");
        prints(folder.path(), &["run", "good.toml", "--format", "json"])
    };
    let paper = trace("");
    let spelt = "reach = 2.0, step = 0.1, sharpest = 1.5707963267948966, turn_step = 0.01";
    assert_eq!(trace(&format!("vehicle = {{ kind = \"unicycle\", {spelt} }}")), paper);
    assert!(!paper.contains("\"vehicle\""), "the paper's is the fan's");
    let mut traces = vec![paper];
    for vehicle in [
        "{ kind = \"unicycle\", reach = 3.0 }",
        "{ kind = \"boat\", sharpest = 0.35 }",
        "{ kind = \"car\", radius = 1.0, shortest = 0.5 }",
    ] {
        let flown = trace(&format!("vehicle = {vehicle}"));
        assert!(flown.contains("\"reason\":\"steps\"") && !traces.contains(&flown), "{flown}");
        // The trace names it, by keys that make the same vehicle again.
        let start = flown.lines().next().expect("a record");
        let start: Value = serde_json::from_str(start).expect("JSON");
        let keys = start["vehicle"].as_object().expect("a table").iter();
        let spelt: Vec<_> = keys.map(|(key, value)| format!("{key} = {value}")).collect();
        assert!(spelt.len() >= 4, "{spelt:?}");
        assert_eq!(trace(&format!("vehicle = {{ {} }}", spelt.join(", "))), flown);
        traces.push(flown);
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
    let cases: [(Points, &[&str]); 2] = [
        (
            &[(2.0, 2.0, -1), (2.0, 3.0, -1), (2.0, 8.0, 1)],
            &["oracle", "one line", "not collinear"],
        ),
        (&[(2.0, 1.0, -1), (2.0, 8.0, 1)], &["oracle", "not collinear"]),
    ];
    for (oracle, parts) in cases {
        fs::write(folder.path().join("bad.toml"), points(oracle)).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
}

/// Without points, or with points of one label, the robot first seeks the line.
#[test]
fn a_mission_may_begin_from_nothing() {
    let folder = folder();
    let scenario =
        include_str!("../../scenarios/from-nothing.toml").replace("steps = 60", "steps = 200");
    let begins = |oracle: &str, intercept: &str| {
        let text = scenario.replace("oracle = []", &format!("oracle = [{oracle}]"));
        let text = text.replace("intercept = 9.5", &format!("intercept = {intercept}"));
        fs::write(folder.path().join("m.toml"), text).expect("a file");
    };
    let one = "{ x = 2.0, z = 1.0, label = -1 }, { x = 9.0, z = 1.0, label = -1 }";
    for oracle in ["", one] {
        begins(oracle, "9.5");
        let text = prints(folder.path(), &["run", "m.toml", "--algorithm", "lookahead"]);
        assert!(text.contains("The boundary was found at step"), "{text}");
        begins(oracle, "90.0");
        let text = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
        let end: Value =
            serde_json::from_str(text.lines().last().expect("an end")).expect("a record");
        assert_eq!((&end["reason"], &end["seek"]["label"]), (&"one label".into(), &(-1).into()));
        assert!(end["seek"]["other"].as_f64().is_some_and(|it| it < 0.01), "{end}");
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

#[test]
fn shapes_are_taken_literally() {
    let folder = folder();
    let area = "area = { x = [0.0, 20.0], z = [0.0, 20.0] }";
    let start = "start = { heading = 0.0 }";
    let truth = "truth = { slope = 0.41, intercept = 3.5 }";
    let point = "{ x = 2.0, z = 8.0, label = 1 }";
    let two = "an array of 2 numbers";
    let cases: [(&str, &str, &[&str]); 10] = [
        (area, "area = { x = [0, 20, 30], z = [0, 20] }", &[":7: ", "length 3", two]),
        (area, "area = { x = [0, 20], z = [0] }", &[":7: ", "length 1", two]),
        (area, "area = [[0, 20], [0, 20]]", &[":7: ", "expected a table"]),
        (area, "area = { x = { from = 0, to = 20 }, z = [0, 20] }", &[":7: ", two]),
        (start, "start = [1, 2]", &[":8: ", "expected a table"]),
        (truth, "truth = [0.41, 3.5]", &[":9: ", "expected a table"]),
        (truth, "truth = { line = [1, 2, 3, 4] }", &[":9: ", "length 4", "an array of 3 numbers"]),
        (truth, "truth = { line = [1, 2] }", &[":9: ", "length 2", "an array of 3 numbers"]),
        (truth, "noise = [0.7]\ntruth = { slope = 0.41, intercept = 3.5 }", &[":9: ", "a table"]),
        (point, "[2.0, 8.0, 1]", &[":12: ", "expected a table"]),
    ];
    for (good, bad, parts) in cases {
        assert!(GOOD.contains(good), "{good}");
        fs::write(folder.path().join("bad.toml"), GOOD.replace(good, bad)).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
}

#[test]
fn a_line_may_have_coefficients_of_any_size() {
    let folder = folder();
    let slope = "slope = 0.41, intercept = 3.5";
    let trace = |line: &str| {
        fs::write(folder.path().join("m.toml"), GOOD.replace(slope, line)).expect("a file");
        prints(folder.path(), &["run", "m.toml", "--format", "json"])
    };
    // The same up to a power of two: the same to the last bit.
    let large = 2.0_f64.powi(1022);
    let line = format!("line = [{:e}, {large:e}, {:e}]", -0.5 * large, -2.5 * large);
    assert_eq!(trace(&line), trace("line = [-0.5, 1, -2.5]"));
    let bad = GOOD.replace(slope, "line = [1e308, -1e308, 0]");
    fs::write(folder.path().join("bad.toml"), bad).expect("a file");
    let parts = ["oracle[0].label", "found -1", "expected 1, as the truth"];
    refuses(folder.path(), &["run", "bad.toml"], &parts);
}

#[test]
fn so_many_oracle_points_that_no_step_is_left_are_refused_plainly() {
    let folder = folder();
    let good = GOOD.replace("\"cfc\"", "\"random\"\nnoise = { p = 0.9 }");
    let (before, _) = good.split_once("oracle = [").expect("an oracle");
    for (count, message) in [
        (
            67,
            "steps: found 10, expected 1 to 1 where labels may be wrong (the planner holds 68 samples, 67",
        ),
        (68, "oracle: found 68 points, expected at most 67: a planner holds 68 samples"),
        (69, "oracle: found 69 points, expected at most 67: a planner holds 68 samples"),
    ] {
        let points = (0..count).map(|i| {
            let x = f64::from(i) / 4.0;
            let (z, label) = if i % 2 == 0 { (0.1 * x, -1) } else { (18.0, 1) };
            format!("{{ x = {x}, z = {z}, label = {label} }}")
        });
        let text = format!("{before}oracle = [{}]\n", points.collect::<Vec<_>>().join(", "));
        fs::write(folder.path().join("many.toml"), text).expect("a file");
        refuses(folder.path(), &["run", "many.toml"], &["many.toml", message]);
        if count > 67 {
            let args = ["run", "many.toml", "--steps", "3"];
            refuses(folder.path(), &args, &["oracle", "at most 67", "room for one step"]);
        } else {
            prints(folder.path(), &["run", "many.toml", "--steps", "1"]);
        }
    }
}

#[test]
fn bad_errors_and_tolerances_are_refused() {
    let folder = folder();
    let cases: [(&str, &[&str]); 12] = [
        ("errors = { motion = -0.1 }", &["errors.motion", "found -0.1", "metres, 0 to 100"]),
        ("errors = { motion = nan }", &["errors.motion", "found NaN", "metres, 0 to 100"]),
        ("errors = { position = 101 }", &["errors.position", "found 101", "metres, 0 to 100"]),
        ("errors = { turn = 1.1 }", &["errors.turn", "found 1.1", "radians, 0 to 1"]),
        ("errors = { heading = -0.1 }", &["errors.heading", "found -0.1", "radians, 0 to 1"]),
        ("errors = { sideways = 0.1 }", &["bad.toml:1", "sideways", "`position`"]),
        ("errors = 0.05", &["bad.toml:1", "a table"]),
        ("tolerance = -0.1", &["tolerance", "found -0.1", "0 to 1024"]),
        ("tolerance = inf", &["tolerance", "found inf", "0 to 1024"]),
        ("tolerance = \"3 cm\"", &["bad.toml:1", "3 cm"]),
        ("tolerance = 10.0", &["tolerance", "found 10 m", "half the breadth of the area"]),
        ("errors = { position = 4.0 }", &["tolerance", "found 12 m", "half the breadth"]),
    ];
    for (line, parts) in cases {
        fs::write(folder.path().join("bad.toml"), format!("{line}\n{GOOD}")).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
    let wide = GOOD.replace("[0.0, 20.0]", "[0.0, 100.0]");
    fs::write(folder.path().join("bad.toml"), format!("tolerance = 22.0\n{wide}")).expect("a file");
    let parts = ["bad.toml", "tolerance", "found 22 m", "the oracle's points", "apart"];
    refuses(folder.path(), &["run", "bad.toml"], &parts);
}

#[test]
fn errors_without_a_tolerance_draw_a_warning() {
    let folder = folder();
    let warning = |lines: &str| {
        fs::write(folder.path().join("good.toml"), format!("{lines}\n{GOOD}")).expect("a file");
        let output = host_sim(folder.path(), &["run", "good.toml", "--steps", "1"]);
        assert!(output.status.success(), "{lines}");
        text(&output.stderr)
    };
    let warned = warning("errors = { position = 0.05 }\ntolerance = 0.1");
    let parts = ["warning: tolerance: 0.1", "err by up to 0.15", "refused, or cut the true line"];
    assert!(parts.iter().all(|part| warned.contains(part)), "{warned}");
    assert_eq!(warned.lines().count(), 1, "{warned}");
    for enough in ["errors = { position = 0.05 }", "errors = { motion = 0.05 }", "tolerance = 0.1"]
    {
        assert_eq!(warning(enough), "", "{enough}");
    }
}
