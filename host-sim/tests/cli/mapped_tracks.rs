//! `replay --front`: the front along a recorded track, from traces and from tables; and map files (`--map`).

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::recordings::{degrees, file, number, random, sign};
use crate::{GOOD, folder, host_sim, prints, refuses, text};

const COAST: &str = include_str!("../../scenarios/coast.toml");

/// A trace of `run` maps as the mission did, to the last digit, if it is told the same.
#[test]
fn a_trace_gives_the_map_of_its_mission() {
    let folder = folder();
    let with = |more: &str| format!("{more}\n{COAST}");
    // It bends so tightly that there are alarms, and the front is found again.
    let tight =
        COAST.replace("radius = 20.0", "radius = 400.0").replace("steps = 90", "steps = 160");
    // After its alarm the front is found again.
    let tight = tight
        .replace("height = 6.0, length = 25.0", "height = 8.0, length = 15.0")
        .replace("seed = 3", "seed = 4");
    // Where it is lost, it is sought all over the area.
    let straight = tight.replace("radius = 400.0", "radius = 1e6").replace("= 160", "= 300");
    let noise = |with: &str| COAST.replace("noise = { p = 0.9 }", with);
    let cases: [(&str, String, &[&str]); 11] = [
        ("a bend told much too wide", straight, &["1e6"]),
        (
            "a stretch that is watched",
            COAST.replace("radius = 20.0", "radius = 20.0, watch = 30.0"),
            &["20"],
        ),
        ("a bend told too wide", tight, &["400"]),
        ("as it is", COAST.to_owned(), &["20"]),
        ("readings on the way", with("readings = 4"), &["20"]),
        (
            "a front that moves",
            COAST.replace("radius = 20.0", "radius = 20.0, speed = 0.05"),
            &["20,0.05"],
        ),
        ("a prior", noise("noise = { p = [8.0, 2.0] }"), &["20"]),
        ("told otherwise", noise("noise = { p = 0.8, true_p = 0.95 }"), &["20"]),
        ("true labels", noise(""), &["20"]),
        (
            "another vehicle",
            with("vehicle = { kind = \"boat\", reach = 3.0, step = 0.3 }"),
            &["20"],
        ),
        (
            "positions that err",
            with("errors = { position = 0.1, motion = 0.05 }\nreadings = 3"),
            &["20", "--tolerance", "0.3"],
        ),
    ];
    let mut alarms = 0;
    for (name, scenario, flags) in &cases {
        fs::write(folder.path().join("m.toml"), scenario).expect("a file");
        let run = ["run", "m.toml", "--trace", "t.jsonl", "--map", "run.csv", "--format", "json"];
        let trace = prints(folder.path(), &run);
        let end: Value =
            serde_json::from_str(trace.lines().last().expect("an end")).expect("a record");
        let replay = ["replay", "t.jsonl", "--map", "replay.csv", "--format", "json", "--front"];
        let replay = prints(folder.path(), &[&replay, *flags].concat());
        let found: Value = serde_json::from_str(&replay).expect("a record");
        let map = |name: &str| fs::read_to_string(folder.path().join(name)).expect("a map");
        assert!(map("run.csv").lines().count() > 20, "{name}: {end}");
        let [flown, mapped] = ["run.csv", "replay.csv"].map(map);
        let other = flown.lines().zip(mapped.lines()).find(|(a, b)| a != b);
        assert!(flown == mapped, "{name}: {other:?}");
        assert_eq!(found["numbers"], "step");
        for key in ["state", "found", "lost", "vertices", "metres", "half_width"] {
            assert_eq!(found["map"][key], end["front"][key], "{name}: {key}");
        }
        let vertices = found["vertices"].as_array().expect("a list");
        let last = vertices.last().and_then(|it| it["number"].as_u64()).expect("a step");
        let again = |it: &&Value| it.as_u64().is_some_and(|it| it + 20 < last);
        alarms += found["alarms"].as_array().expect("a list").iter().filter(again).count();
        // What is told decides.
        let told =
            prints(folder.path(), &["replay", "t.jsonl", "--front", "7", "--map", "other.csv"]);
        assert!(told.contains("radius of 7 m"), "{told}");
        assert_ne!(map("run.csv"), map("other.csv"), "{name}");
    }
    assert!(alarms > 0, "no case finds the front again after an alarm");
}

/// Samples of a boat that goes to and fro across a circle of this radius about the origin, about `apart` metres apart.
/// Even steps would cross it in the same way each time, and so be off in the same way.
fn track(apart: f64, seed: u64, p: f64) -> Vec<([f64; 2], bool)> {
    const AMPLITUDE: f64 = 6.0;
    let mut state = seed;
    let count = (RADIUS * 1.6 * PI / 0.6 / apart) as usize;
    let mut way = 0.0;
    let row = |_| {
        way += apart * (0.5 + random(&mut state));
        let (round, phase) = (0.6 * way / RADIUS, (0.8 * way) % (4.0 * AMPLITUDE));
        let off = if phase < 2.0 * AMPLITUDE { phase - AMPLITUDE } else { 3.0 * AMPLITUDE - phase };
        let radius = RADIUS + off;
        let at = [radius * round.cos(), radius * round.sin()];
        (at, (off < 0.0) == (random(&mut state) < p))
    };
    (0..count).map(row).collect()
}

const RADIUS: f64 = 100.0;

fn table(rows: &[([f64; 2], bool)]) -> String {
    file("x,z,label", rows, |[x, z], label| format!("{x},{z},{}", sign(label)))
}

fn mapped(folder: &Path, content: &str, flags: &[&str]) -> Value {
    fs::write(folder.join("s.csv"), content).expect("a file");
    let args = [&["replay", "s.csv", "--format", "json"], flags].concat();
    serde_json::from_str(&prints(folder, &args)).expect("JSON")
}

/// The stated widths hold along a circle, however dense the rows are.
#[test]
fn a_table_maps_the_front_that_it_crosses() {
    let folder = folder();
    for (apart, seed, p, flags) in [
        (2.0, 1, 1.0, &["--front", "80"][..]),
        (2.0, 2, 0.95, &["--front", "80", "--p", "0.95"]),
        (0.5, 3, 0.95, &["--front", "80", "--p", "0.95"]),
        (0.1, 4, 1.0, &["--front", "80"]),
        (0.1, 5, 0.95, &["--front", "80", "--p", "0.95"]),
        (1.0, 6, 0.95, &["--front", "80,0.01", "--p", "0.95"]),
    ] {
        let rows = track(apart, seed, p);
        let found = mapped(folder.path(), &table(&rows), flags);
        let vertices = found["vertices"].as_array().expect("a list");
        let off = |it: &&Value| {
            let off = number(&it["x"]).hypot(number(&it["z"])) - RADIUS;
            off.abs() <= number(&it["half_width"])
        };
        let covered = vertices.iter().filter(off).count() as f64 / vertices.len() as f64;
        let name = format!("{apart} m apart, seed {seed}");
        assert!(covered > 0.85, "{name}: {covered}");
        assert!(number(&found["map"]["half_width"][0]) < 2.0, "{name}: {}", found["map"]);
        assert_eq!(found["map"]["state"], "followed", "{name}");
        assert!(number(&found["map"]["metres"]) > 350.0, "{name}: {}", found["map"]);
        // The numbers are those of lines, and no row is closer than is said.
        let apart = number(&found["apart"]);
        let line = |it: &Value| it["number"].as_u64().expect("a line") as usize;
        for pair in vertices.windows(2) {
            let [from, to] = [&pair[0], &pair[1]].map(|it| rows[line(it) - 2].0);
            let way = (to[0] - from[0]).hypot(to[1] - from[1]);
            assert!(way >= apart - 1e-4 || line(&pair[1]) > line(&pair[0]) + 60, "{name}: {way}");
        }
    }
}

#[test]
fn a_map_has_a_place_on_the_globe() {
    const ORIGIN: [f64; 2] = [53.5334, 9.9424];
    let folder = folder();
    let rows: Vec<_> =
        track(1.0, 9, 0.95).into_iter().map(|(at, label)| (degrees(ORIGIN, at), label)).collect();
    let content = file("lat,lon,label", &rows, |[lat, lon], l| format!("{lat},{lon},{}", sign(l)));
    let flags = [
        "--front",
        "80",
        "--p",
        "0.95",
        "--geojson",
        "m.geojson",
        "--map",
        "m.csv",
        "--figure",
        "m.svg",
    ];
    let found = mapped(folder.path(), &content, &flags);
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("a file");
    let vertices = found["vertices"].as_array().expect("a list");
    let map = read("m.csv");
    let mut lines = map.lines();
    assert_eq!(
        lines.next(),
        Some("row,x,z,heading,curvature,half_width,turn_deviation,piece,lat,lon")
    );
    assert_eq!(lines.clone().count(), vertices.len());
    for (line, it) in lines.zip(vertices) {
        let fields: Vec<f64> = line.split(',').map(|it| it.parse().expect("a number")).collect();
        assert_eq!(fields[..1], [number(&it["number"])]);
        assert_eq!(fields[1..3], [number(&it["x"]), number(&it["z"])]);
        assert_eq!(fields[8..], [0, 1].map(|k| number(&it["in_file"][k])));
    }
    assert!(read("m.svg").contains("the front as it is mapped"));
    let drawn: Value = serde_json::from_str(&read("m.geojson")).expect("JSON");
    let features = drawn["features"].as_array().expect("features");
    let of = |kind: &'static str| {
        features.iter().filter(move |it| it["properties"]["kind"] == kind).collect::<Vec<_>>()
    };
    let pieces: Vec<_> = vertices.iter().map(|it| it["piece"].as_u64()).collect();
    let lengths =
        (1..=pieces.len()).map(|k| pieces.iter().filter(|it| **it == Some(k as u64)).count());
    let long: Vec<_> = lengths.filter(|it| *it > 1).collect();
    for (kind, shape, less) in [("front", "LineString", 0), ("band", "MultiPolygon", 1)] {
        let lengths: Vec<_> = of(kind)
            .iter()
            .inspect(|it| assert_eq!(it["geometry"]["type"], shape))
            .map(|it| it["geometry"]["coordinates"].as_array().expect("a list").len() + less)
            .collect();
        assert_eq!(lengths, long, "{kind}");
    }
    assert_eq!(of("sample").len(), rows.len());
    assert_eq!(of("vertex").len(), vertices.len());
    for (point, it) in of("vertex").iter().zip(vertices) {
        let at = &point["geometry"]["coordinates"];
        assert_eq!((&at[1], &at[0]), (&it["in_file"][0], &it["in_file"][1]));
        let told = &point["properties"];
        assert_eq!((&told["row"], &told["half_width"]), (&it["number"], &it["half_width"]));
    }
    // Rings are closed, and counter-clockwise.
    for quad in
        of("band").iter().filter_map(|it| it["geometry"]["coordinates"].as_array()).flatten()
    {
        let ring: Vec<_> = quad[0].as_array().expect("a ring").iter().collect();
        assert_eq!((ring.len(), ring[0]), (5, ring[4]));
        let at = |k: usize| [0, 1].map(|axis| number(&ring[k][axis]) - number(&ring[0][axis]));
        let twice: f64 = (0..4).map(|k| at(k)[0] * at(k + 1)[1] - at(k + 1)[0] * at(k)[1]).sum();
        assert!(twice >= 0.0, "{ring:?}");
    }
}

#[test]
fn a_front_that_is_not_known_is_said_to_be_so() {
    let folder = folder();
    let crossed = track(2.0, 11, 1.0);
    // In the end the sensor reads the other label, which no front explains.
    let lost: Vec<_> =
        crossed[..265].iter().zip(0..).map(|(&(at, label), k)| (at, label == (k < 250))).collect();
    let water: Vec<_> = crossed.iter().map(|(at, _)| (*at, false)).collect();
    for (rows, state, says) in [
        (&lost, "lost", "and is lost since line"),
        (&water, "sought", "The ground has one label, -1: no front was found."),
        (&crossed[..6].to_vec(), "sought", "The front was not found."),
    ] {
        let flags = ["--front", "80", "--map", "m.csv", "--figure", "m.svg"];
        let found = mapped(folder.path(), &table(rows), &flags);
        assert_eq!(found["map"]["state"], state);
        assert_eq!(found["one_label"].is_null(), !says.contains("one label"), "{found}");
        let output = host_sim(folder.path(), &["replay", "s.csv", "--front", "80", "--strict"]);
        let [words, message] = [&output.stdout, &output.stderr].map(|it| text(it));
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(words.contains(says), "{words}");
        assert!(message.starts_with("error: s.csv: "), "{message}");
        let output = host_sim(folder.path(), &["replay", "s.csv", "--front", "80"]);
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stderr).contains("s.csv: warning: "));
        let map = fs::read_to_string(folder.path().join("m.csv")).expect("a map");
        assert_eq!(map.lines().count() == 1, state == "sought", "{map}");
    }
}

#[test]
fn what_makes_no_map_is_refused() {
    let folder = folder();
    let write = |name: &str, content: &str| {
        fs::write(folder.path().join(name), content).expect("a file");
    };
    write("s.csv", &table(&track(2.0, 1, 1.0)));
    write("here.csv", "x,z,label\n1,1,1\n1,1,-1\n");
    write("none.csv", "x,z,label\n");
    write("m.toml", GOOD);
    write("c.toml", COAST);
    let cases: [(&[&str], &[&str]); 13] = [
        (&["replay", "s.csv", "--map", "m.csv"], &["--front"]),
        (&["replay", "s.csv", "--front", "0"], &["--front", "'0'", "0.1 to 1000000 m"]),
        (&["replay", "s.csv", "--front", "nan"], &["--front", "'nan'", "0.1 to 1000000 m"]),
        (&["replay", "s.csv", "--front", "wide"], &["--front", "radius", "\"wide\"", "40,0.02"]),
        (&["replay", "s.csv", "--front", "40,fast"], &["--front", "speed", "\"fast\""]),
        (&["replay", "s.csv", "--front", "40,-1"], &["--front", "0 to 1000 m"]),
        (&["replay", "s.csv", "--front", "40", "--geojson", "m.geojson"], &["--geojson", "metres"]),
        (&["replay", "s.csv", "--front", "40", "--map", "m.svg"], &["m.svg", ".csv", "--map"]),
        (&["replay", "s.csv", "--front", "40", "--map", "s.csv"], &["s.csv", "the samples"]),
        (&["replay", "here.csv", "--front", "40"], &["here.csv", "at one place", "a track"]),
        (&["replay", "none.csv", "--front", "40"], &["none.csv", "no samples", "a track"]),
        (&["run", "m.toml", "--map", "m.csv"], &["--map", "found algorithm cfc", "track"]),
        (&["run", "c.toml", "--map", "m.json"], &["m.json", ".csv", "--map"]),
    ];
    for (args, parts) in cases {
        refuses(folder.path(), args, parts);
    }
}
