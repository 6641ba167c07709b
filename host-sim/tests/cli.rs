//! The command line as its users meet it: the commands, and one wrong input of each kind.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

const GOOD: &str = include_str!("../scenarios/paper-noiseless.toml");

fn host_sim(folder: &Path, args: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_host-sim");
    Command::new(program).args(args).current_dir(folder).output().expect("it starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// The command succeeds; what it prints.
fn prints(folder: &Path, args: &[&str]) -> String {
    let output = host_sim(folder, args);
    assert!(output.status.success(), "{args:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// The command fails with status 2, prints nothing but one message, and leaves no file behind.
fn refuses(folder: &Path, args: &[&str], parts: &[&str]) {
    let files = |folder: &Path| {
        let mut names: Vec<_> = fs::read_dir(folder)
            .expect("a folder")
            .map(|e| e.expect("an entry").file_name())
            .collect();
        names.sort();
        names
    };
    let before = files(folder);
    let output = host_sim(folder, args);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
    assert_eq!(text(&output.stdout), "", "{args:?}");
    assert!(message.starts_with("error: "), "{args:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{args:?}: expected {part:?} in: {message}");
    }
    assert_eq!(files(folder), before, "{args:?} left a file behind");
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

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
    let vertical = include_str!("../scenarios/vertical.toml");
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
    let noisy = include_str!("../scenarios/paper-noisy.toml");
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

#[test]
fn bad_noise_is_refused() {
    let folder = folder();
    let noisy = include_str!("../scenarios/paper-noisy.toml");
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

#[test]
fn bad_flags_and_places_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    fs::create_dir(folder.path().join("d")).expect("a folder");
    let cases: [(&[&str], &[&str]); 13] = [
        (&["run", "none.toml"], &["none.toml", "readable"]),
        (&["run", "m.toml", "--steps", "99"], &["--steps", "found 99", "1 to 64"]),
        (&["run", "m.toml", "--steps", "many"], &["--steps", "many"]),
        (&["run", "m.toml", "--algorithm", "abc"], &["--algorithm", "abc", "cfc"]),
        (&["run", "m.toml", "--trace", "no/t.jsonl"], &["no/t.jsonl", "expected a place"]),
        (&["run", "m.toml", "--trace", "t.jsonl", "--figure", "d"], &["d", "directory"]),
        (&["campaign", "--fields", "0"], &["--fields", "0"]),
        (&["campaign", "--steps", "65"], &["--steps", "found 65", "1 to 64"]),
        (&["campaign", "--p", "1.5"], &["--p", "found 1.5", "[0, 1]"]),
        (&["campaign", "--p", "0.7"], &["--p", "found 0.7", "expected 1", "cfc"]),
        (
            &["campaign", "--algorithm", "scc", "--trusted-radius=-1"],
            &["--trusted-radius", "found -1"],
        ),
        (&["run", "m.toml", "--candidates", "c.svg"], &["--candidates", "without noise"]),
        (&["campaign", "--csv", "no/c.csv"], &["no/c.csv", "expected a place"]),
    ];
    for (args, parts) in cases {
        refuses(folder.path(), args, parts);
    }
}

#[test]
fn a_chip_that_cannot_be_is_refused() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    let many = (0..17).fold(String::new(), |mut text, i| {
        let _ = writeln!(text, "  {{ x = {i}.0, z = 0.0, label = -1 }},");
        text
    });
    let many = GOOD.replace("oracle = [\n", &format!("oracle = [\n{many}"));
    fs::write(folder.path().join("many.toml"), many).expect("a file");
    let other = env!("CARGO_BIN_EXE_host-sim");
    let other = format!("--emulator={other}");
    let cases: [(&[&str], &[&str]); 11] = [
        (&["m.toml"], &["--port", "--emulator"]),
        (&["m.toml", &other], &["host-sim", "firmware's ELF"]),
        (&["m.toml", "--port", "x", "--emulator"], &["--port", "--emulator"]),
        (&["m.toml", "--port", "no-such-device"], &["no-such-device", "expected a serial port"]),
        (&["m.toml", "--emulator"], &["release/firmware", "cargo firmware"]),
        (&["m.toml", "--emulator=m.toml"], &["m.toml", "ELF", "cargo firmware"]),
        (&["m.toml", "--port", "x", "--log", "l"], &["--log", "--port"]),
        (&["m.toml", "--emulator", "--fault", "drop=2"], &["drop", "found 2", "[0, 1]"]),
        (&["m.toml", "--emulator", "--fault", "delay=1s"], &["delay", "found 1s", "20ms"]),
        (&["m.toml", "--emulator", "--algorithm", "random"], &["m.toml", "random", "cfc or scc"]),
        (&["many.toml", "--emulator"], &["many.toml", "found 21 points", "at most 16"]),
    ];
    for (args, parts) in cases {
        refuses(folder.path(), &[&["hil"], args].concat(), parts);
    }
}

#[test]
fn replay_says_what_samples_determine() {
    let folder = folder();
    let rows = "# by hand\n label , x,z,note\n-1,2,1,a\n1,2,8,b\n+1.0,18.0,16,\n-1,18,5,\n";
    fs::write(folder.path().join("s.csv"), rows).expect("a file");
    let words = prints(folder.path(), &["replay", "s.csv", "--figure", "s.svg"]);
    for part in ["4 samples", "-10.62 to 43.15", "-0.875 to 8.375", "centre"] {
        assert!(words.contains(part), "{part}: {words}");
    }
    assert!(folder.path().join("s.svg").exists());
    let record: serde_json::Value =
        serde_json::from_str(&prints(folder.path(), &["replay", "s.csv", "--format", "json"]))
            .expect("JSON");
    assert_eq!((&record["samples"], &record["matter"]), (&4.into(), &4.into()));
    assert!(record["estimates"]["centre"]["slope"].is_f64());
}

#[test]
fn replay_takes_more_rows_than_any_buffer_holds() {
    let folder = folder();
    // A thousand samples of z = 0.5 x + 7001.25 kilometres away, the first hundreds of one label.
    let mut rows = String::from("x,z,label\n");
    for i in 0..1000_i32 {
        let x = f64::from(i * 37 % 1000) / 50.0 - 7000.0;
        let off =
            f64::from(i * 61 % 97 + 3) / 10.0 * if i < 300 || i % 2 == 0 { 1.0 } else { -1.0 };
        let z = 0.5 * x + 7001.25 + off;
        writeln!(rows, "{x},{z},{}", if off > 0.0 { 1 } else { -1 }).expect("a string");
    }
    fs::write(folder.path().join("s.csv"), &rows).expect("a file");
    let record: serde_json::Value =
        serde_json::from_str(&prints(folder.path(), &["replay", "s.csv", "--format", "json"]))
            .expect("JSON");
    assert_eq!(record["samples"], 1000);
    let slope = record["estimates"]["centre"]["slope"].as_f64().expect("a slope");
    assert!((slope - 0.5).abs() < 0.02, "{slope}");
    // And the row that no line allows is named.
    rows += "-6990,3515,-1\n";
    fs::write(folder.path().join("s.csv"), rows).expect("a file");
    refuses(folder.path(), &["replay", "s.csv"], &["s.csv:1002", "no line separates"]);
}

#[test]
fn bad_samples_are_refused_by_file_and_line() {
    let folder = folder();
    let cases: [(&str, &[&str]); 13] = [
        ("", &["s.csv:1", "x,z,label"]),
        ("x,y,label\n1,2,1\n", &["s.csv:1", "x,y,label", "x,z,label"]),
        ("x,z,label\n", &["s.csv", "collinear"]),
        ("x,z,label\n1,2\n", &["s.csv:2", "label: found \"\"", "finite number"]),
        ("x,z,label\n1,2,1\na,2,1\n", &["s.csv:3", "x: found \"a\"", "finite number"]),
        ("x,z,label\n1,,1\n", &["s.csv:2", "z: found \"\"", "finite number"]),
        ("x,z,label\n1,NaN,1\n", &["s.csv:2", "z: found \"NaN\"", "finite number"]),
        ("x,z,label\n1,9000,1\n", &["s.csv:2", "(1, 9000)", "8192"]),
        ("x,z,label\n1,2,0\n", &["s.csv:2", "label: found 0", "-1 or 1"]),
        ("x,z,label\n0,0,1\n1,1,1\n2,5,1\n", &["s.csv", "one label"]),
        ("x,z,label\n0,0,1\n1,1,1\n2,2,-1\n", &["s.csv", "collinear"]),
        ("x,z,label\n0,0,1\n1,1,-1\n2,2,1\n3,9,1\n", &["s.csv:4", "no line separates"]),
        (
            "x,z,label\n0,0,1\n4,0,1\n2,5,-1\n2,-1,1\n2,1,1\n2,0,-1\n",
            &["s.csv:7", "no line separates"],
        ),
    ];
    for (rows, parts) in cases {
        fs::write(folder.path().join("s.csv"), rows).expect("a file");
        refuses(folder.path(), &["replay", "s.csv", "--figure", "f.svg"], parts);
    }
}

#[test]
fn a_campaign_prints_tables_and_writes_rows() {
    let folder = folder();
    let args = ["campaign", "--fields", "20", "--steps", "12", "--csv", "c.csv"];
    let table = prints(folder.path(), &args);
    for part in
        ["20 standard fields, seed 1", "bits/step", "Ended by: steps 20", "Actions examined"]
    {
        assert!(table.contains(part), "{part}: {table}");
    }
    let rows = fs::read_to_string(folder.path().join("c.csv")).expect("rows");
    assert_eq!(rows.lines().count(), 1 + 20 * 5, "marks at 1, 2, 5, 10 and 12");
    let json = prints(
        folder.path(),
        &["campaign", "--fields", "5", "--algorithm", "random", "--format", "json"],
    );
    let summary: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!((&summary["fields"], &summary["algorithm"]), (&5.into(), &"random".into()));
}
