//! Logs for viewers, and the trace as flat rows: what they say is what the trace says. Logs are read by a library
//! that is not ours, in Python.

#![allow(clippy::float_cmp)] // what is said is said to the last bit

use std::f64::consts::TAU;
use std::fs;
use std::process::Command;

use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::mission::trace;
use host_sim::report::{flat, log};
use serde_json::{Map, Value};
use tests::build;

const SCENARIOS: [&str; 5] =
    ["paper-noiseless", "paper-noisy", "vertical", "car-among-keep-outs", "kilometres-away"];

/// Each scenario as its file has it, and by look-ahead.
fn recordings() -> impl Iterator<Item = (String, Recording)> {
    let planners = [None, Some(Algorithm::Lookahead)];
    SCENARIOS.into_iter().flat_map(move |name| planners.map(|planner| (name, planner))).map(
        |(name, algorithm)| {
            let file = format!("host-sim/scenarios/{name}.toml");
            let file = build::root().join(file);
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

/// The lines that a script in Python prints of a mission's log.
fn read_by(script: &str, recording: &Recording) -> Vec<Map<String, Value>> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mission.mcap");
    fs::write(&file, log::mcap(recording).expect("a log")).expect("a file");
    records(&build::printed(Command::new("python3").arg(script).arg(&file)))
}

#[test]
fn a_reader_of_others_finds_in_a_log_what_the_trace_says() {
    if !build::has_module("mcap_protobuf", "mcap-protobuf-support", "the log's reader") {
        return;
    }
    for (name, recording) in recordings().step_by(3) {
        let messages = read_by("read_log.py", &recording);
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
            let off = libm::remainder(heading - number(&row["heading"]), TAU);
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

/// What Rerun sees of a log.
struct InRerun(Vec<Map<String, Value>>);

impl InRerun {
    /// The values of a component over time. Rerun holds a list for each component and time.
    fn of(&self, entity: &str, component: &str) -> Vec<(f64, Value)> {
        let of = self.0.iter().filter(|line| line["entity"] == entity);
        of.filter_map(|line| {
            Some((number(&line["time"]), line["components"].get(component)?.clone()))
        })
        .collect()
    }

    /// Where the points of a cloud lie, at each of its times.
    fn clouds(&self, entity: &str) -> Vec<(f64, Vec<[f64; 3]>)> {
        let points = |cloud: Value| {
            let points = cloud.as_array().expect("points").iter();
            points.map(|at| [0, 1, 2].map(|k| number(&at[k]))).collect()
        };
        let clouds = self.of(entity, "Points3D:positions").into_iter();
        clouds.map(|(time, cloud)| (time, points(cloud))).collect()
    }
}

/// Rerun has single precision.
fn near(found: f64, wanted: &Value, name: &str) {
    assert!((found - number(wanted)).abs() < 1e-3, "{name}: {found} is not {wanted}");
}

#[test]
fn rerun_shows_the_robot_the_map_and_the_curves_of_a_log() {
    if !build::has_module("rerun.chunk", "rerun-sdk", "the log in Rerun") {
        return;
    }
    for (name, recording) in recordings().step_by(3) {
        let seen = InRerun(read_by("read_log_in_rerun.py", &recording));
        let rows = records(&flat::lines(&recording.results));
        // The robot is a cloud of points in a frame of its own, which moves about the field.
        let moves = seen.of("/tf", "Transform3D:translation");
        let turns = seen.of("/tf", "Transform3D:quaternion");
        // What /step has can be plotted by a selector such as .bits.
        let steps = seen.of("/step", "host_sim.Step:message");
        let counts = [moves.len(), turns.len(), steps.len() + 1];
        assert_eq!(counts, [rows.len() + 1; 3], "{name}");
        for (k, row) in rows.iter().enumerate() {
            let ((time, place), (_, turn), (at, step)) = (&moves[k + 1], &turns[k + 1], &steps[k]);
            assert_eq!([*time, *at], [number(&row["step"]); 2], "{name}");
            near(number(&place[0][0]), &row["x"], &name);
            near(number(&place[0][1]), &row["z"], &name);
            let heading = 2.0 * libm::atan2(number(&turn[0][2]), number(&turn[0][3]));
            let off = libm::remainder(heading - number(&row["heading"]), TAU);
            assert!(off.abs() < 1e-5, "{name}: {off}");
            for key in ["bits", "control_cost", "metres", "label", "slope_from", "intercept_to"] {
                assert_eq!(step[0][key].as_f64(), row[key].as_f64(), "{name}: {key}");
            }
        }
        let frames = seen.of("/tf", "Transform3D:child_frame");
        assert!(frames.iter().all(|(_, it)| it[0] == "robot"), "{name}");
        assert_eq!(seen.of("/robot", "CoordinateFrame:frame")[0].1[0], "robot", "{name}");
        assert!(seen.clouds("/robot")[0].1.len() > 3, "{name}");
        the_map_is_seen(&name, &seen, &rows, &records(&trace::lines(&recording.results)));
    }
}

type Records = [Map<String, Value>];

fn the_map_is_seen(name: &str, seen: &InRerun, rows: &Records, trace: &Records) {
    // All of it is in the field's frame, lies in the plane and has a colour for each point.
    for (entity, changes) in [
        ("/map/area", false),
        ("/map/true_line", false),
        ("/map/given", false),
        ("/map/ground", true),
        ("/map/estimate", true),
        ("/map/path", true),
        ("/map/samples", true),
    ] {
        let clouds = seen.clouds(entity);
        let until = if changes { rows.len() as f64 } else { 0.0 };
        assert_eq!(clouds.last().map(|it| it.0), Some(until), "{name}: {entity}");
        let frames = seen.of(entity, "CoordinateFrame:frame");
        assert!(frames.iter().all(|(_, it)| it[0] == "field"), "{name}: {entity}");
        // Rerun reports an error for as long as an entity has no frame.
        assert_eq!(frames[0].0, 0.0, "{name}: {entity}");
        for ((_, cloud), (_, colors)) in clouds.iter().zip(&seen.of(entity, "Points3D:colors")) {
            assert_eq!(colors.as_array().map(Vec::len), Some(cloud.len()), "{name}: {entity}");
            assert!(cloud.iter().all(|at| at[2] == 0.0), "{name}: {entity}");
        }
    }
    let [start, end] = [&trace[0], &trace[trace.len() - 1]];
    let last = |entity: &str| seen.clouds(entity).pop().expect("a cloud").1;
    // The border has the area's extent, lines are where the trace has them.
    for (k, axis) in ["x", "z"].into_iter().enumerate() {
        let along = last("/map/area").into_iter().map(|at| at[k]);
        near(along.clone().fold(f64::MAX, f64::min), &start["area"][axis][0], name);
        near(along.fold(f64::MIN, f64::max), &start["area"][axis][1], name);
    }
    for (entity, line) in
        [("/map/true_line", &start["truth"]), ("/map/estimate", &end["estimates"]["centre"])]
    {
        let cloud = last(entity);
        assert!(cloud.len() > 100, "{name}: {entity} has {} points", cloud.len());
        let (sin, cos) = number(&line["angle"]).to_radians().sin_cos();
        let off = |at: &[f64; 3]| ((at[1] - cloud[0][1]) * cos - (at[0] - cloud[0][0]) * sin).abs();
        assert!(cloud.iter().all(|at| off(at) < 5e-3), "{name}: {entity}");
        if let Some(intercept) = line["intercept"].as_f64() {
            let above = cloud[0][1] - number(&line["slope"]) * cloud[0][0] - intercept;
            assert!((above * cos).abs() < 5e-3, "{name}: {entity}: {above}");
        }
    }
    // A +1 is a cross of 17 points, a -1 a bar of 9; in the middle of each is its sample.
    let mut marks = last("/map/samples").into_iter();
    let of_label = |label: i64| rows.iter().filter(move |row| row["label"] == label);
    for row in of_label(-1).chain(of_label(1)) {
        let mark: Vec<_> = marks.by_ref().take(if row["label"] == 1 { 17 } else { 9 }).collect();
        for (k, axis) in ["x", "z"].into_iter().enumerate() {
            near(mark.iter().map(|at| at[k]).sum::<f64>() / mark.len() as f64, &row[axis], name);
        }
    }
    assert_eq!(marks.count(), 0, "{name}");
}

fn number(value: &Value) -> f64 {
    // 64-bit integers are strings in the JSON of protobuf.
    let text = || value.as_str().and_then(|text| text.parse().ok());
    value.as_f64().or_else(text).unwrap_or_else(|| panic!("a number: {value}"))
}
