//! Logs for viewers, and the trace as flat rows: what they say is what the trace says. Logs are read by a library
//! that is not ours, in Python.

#![allow(clippy::float_cmp)] // what is said is said to the last bit

use std::path::Path;
use std::process::Command;
use std::{env, fs};

use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::report::{flat, log, trace};
use serde_json::{Map, Value};
use tests::program::build;

const SCENARIOS: [&str; 5] =
    ["paper-noiseless", "paper-noisy", "vertical", "car-among-keep-outs", "kilometres-away"];

/// Each scenario as its file has it, and by look-ahead.
fn recordings() -> impl Iterator<Item = (String, Recording)> {
    let planners = [None, Some(Algorithm::Lookahead)];
    SCENARIOS.into_iter().flat_map(move |name| planners.map(|planner| (name, planner))).map(
        |(name, algorithm)| {
            let file = format!("../host-sim/scenarios/{name}.toml");
            let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
            let mission = scenario::read(&file, Overrides { algorithm, ..Overrides::default() });
            let recording = mission.and_then(|mission| Recording::of(&mission));
            (format!("{name} by {algorithm:?}"), recording.expect("a sound scenario"))
        },
    )
}

fn records(lines: &str) -> Vec<Map<String, Value>> {
    lines.lines().map(|line| serde_json::from_str(line).expect("an object a line")).collect()
}

#[test]
fn flat_rows_have_one_shape_and_say_what_the_trace_says() {
    for (name, recording) in recordings() {
        let rows = records(&flat::lines(&recording.results));
        let trace = records(&trace::lines(&recording.results));
        assert_eq!(trace[0]["version"], 1, "{name}");
        assert_eq!(rows.len() + 2, trace.len(), "{name}");
        let keys: Vec<_> = rows[0].keys().collect();
        let (mut cost, mut metres) = (0.0, 0.0);
        for (row, step) in rows.iter().zip(&trace[1..]) {
            assert_eq!(row.keys().collect::<Vec<_>>(), keys, "{name}");
            assert!(row.values().all(|value| !value.is_array() && !value.is_object()), "{name}");
            for key in ["step", "problem", "recovery", "label", "bits", "examined"] {
                assert_eq!(row[key], step[key], "{name}: {key}");
            }
            for (key, within) in [("x", "pose"), ("heading", "pose"), ("v", "action")] {
                assert_eq!(row[key], step[within][key], "{name}: {key}");
            }
            assert_eq!(row.get("entropy"), Some(step.get("entropy").unwrap_or(&Value::Null)));
            let arcs = step["slope_arcs"].as_array().expect("arcs");
            let (first, last) = (&arcs[0], &arcs[arcs.len() - 1]);
            assert_eq!(row["slope_from"], last[0], "{name}");
            let beyond = if arcs.len() > 1 { 180.0 } else { 0.0 };
            assert_eq!(number(&row["slope_to"]), number(&first[1]) + beyond, "{name}");
            let [v, w] = ["v", "w"].map(|key| number(&row[key]));
            (cost, metres) = (cost + v * v + w * w, metres + v);
            assert!((number(&row["control_cost"]) - cost).abs() < 1e-5, "{name}");
            assert!((number(&row["metres"]) - metres).abs() < 1e-5, "{name}");
        }
    }
}

#[test]
fn a_reader_of_others_finds_in_a_log_what_the_trace_says() {
    let import = Command::new("python3").args(["-c", "import mcap_protobuf"]).output();
    if !import.is_ok_and(|it| it.status.success()) {
        let why = "python3 has no mcap-protobuf-support";
        return build::skip(env!("CARGO_TARGET_TMPDIR"), "the log's reader", why);
    }
    let reader = Path::new(env!("CARGO_MANIFEST_DIR")).join("read_log.py");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mission.mcap");
    for (name, recording) in recordings() {
        fs::write(&file, log::mcap(&recording).expect("a log")).expect("a file");
        let read = Command::new("python3").arg(&reader).arg(&file).output().expect("python3");
        assert!(read.status.success(), "{name}: {}", String::from_utf8_lossy(&read.stderr));
        let messages = records(&String::from_utf8(read.stdout).expect("UTF-8"));
        let of = |topic: &str| {
            let of = messages.iter().filter(|message| message["topic"] == topic);
            of.map(|it| (number(&it["time"]), it["message"].clone())).collect::<Vec<_>>()
        };
        let rows = records(&flat::lines(&recording.results));
        let steps = of("/step");
        assert_eq!(steps.len(), rows.len(), "{name}");
        for ((time, step), row) in steps.iter().zip(&rows) {
            assert_eq!(*time, 1e9 * number(&row["step"]), "{name}");
            // In the rows what there is not is null; in the log it is absent, or empty.
            for (key, said) in step.as_object().expect("an object") {
                match key.as_str() {
                    "timestamp" | "slope_error_deg" | "misclassified" => {}
                    "problem" | "recovery" => {
                        assert_eq!(said.as_str(), row[key].as_str().or(Some("")), "{name}: {key}");
                    }
                    _ => assert_eq!(number(said), number(&row[key]), "{name}: {key}"),
                }
            }
            let counted = row.keys().filter(|key| step.get(key).is_some()).count();
            assert!(counted >= 7, "{name}: {step}");
        }
        let error = recording.results.end.estimates.centre.and_then(|line| line.error);
        let last = steps.last().and_then(|(_, step)| step["slope_error_deg"].as_f64());
        assert_eq!(last, error.map(|error| error.degrees), "{name}");
        let poses = of("/pose");
        assert_eq!(poses.len(), rows.len() + 1, "{name}");
        for ((_, pose), row) in poses.iter().skip(1).zip(&rows) {
            let place = &pose["pose"]["position"];
            assert_eq!((&place["x"], &place["y"]), (&row["x"], &row["z"]), "{name}");
            let [z, w] = ["z", "w"].map(|part| number(&pose["pose"]["orientation"][part]));
            let heading = 2.0 * libm::atan2(z, w);
            let off = libm::remainder(heading - number(&row["heading"]), std::f64::consts::TAU);
            assert!(off.abs() < 1e-9, "{name}: {off}");
        }
        let scenes = of("/scene");
        assert_eq!(scenes.len(), rows.len() + 1, "{name}");
        let drawn = |scene: &Value, id: &str, kind: &str| {
            let entities = scene["entities"].as_array().expect("entities");
            let entity = entities.iter().find(|it| it["id"] == id).expect("an entity");
            entity[kind].as_array().map_or(0, Vec::len)
        };
        assert_eq!(drawn(&scenes[0].1, "true line", "lines"), 1, "{name}");
        for ((_, scene), count) in scenes.iter().skip(1).zip(1..) {
            let labels = rows[..count].iter().filter_map(|row| row["label"].as_i64());
            let [plus, minus] =
                [1, -1].map(|label| labels.clone().filter(|it| *it == label).count());
            assert_eq!(drawn(scene, "samples", "spheres"), plus, "{name}");
            assert_eq!(drawn(scene, "samples", "cubes"), minus, "{name}");
        }
    }
}

fn number(value: &Value) -> f64 {
    // 64-bit integers are strings in the JSON of protobuf.
    let text = || value.as_str().and_then(|text| text.parse().ok());
    value.as_f64().or_else(text).unwrap_or_else(|| panic!("a number: {value}"))
}
