//! `host-sim next`, asked motion by motion, does what `host-sim run` does, byte for byte; and refuses what is no request.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use host_sim::mission::next::answer;
use host_sim::mission::recording::Recording;
use host_sim::mission::results::StepResult;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::mission::trace;
use host_sim::world::frame::Frame;
use nalgebra::Point2;
use planner_core::{Reading, Site};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use tests::{cases, seed};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../host-sim/scenarios/lakes");

const ORACLE: &str = "oracle = [{ x = 2, z = 1, label = -1 }, { x = 2, z = 18, label = 1 }, { x = 18, z = 16, label = 1 }, \
                      { x = 18, z = 2, label = -1 }]\n";

/// What each kind of mission has beside the others.
const KINDS: [&str; 14] = [
    "algorithm = \"lookahead\"\nsteps = 25\nstop = { slope_arc_deg = 20.0, audit = false }\n",
    "algorithm = \"lookahead\"\nsteps = 14\nnoise = { p = 0.9 }\nreadings = 3\n",
    "algorithm = \"lookahead\"\nsteps = 12\nnoise = { p = [8, 2] }\nstop = { slope_arc_deg = 9.0 }\n",
    "algorithm = \"cfc\"\nsteps = 12\nerrors = { position = 0.05, motion = 0.1 }\n",
    "algorithm = \"scc\"\nsteps = 10\nnoise = { p = 0.7, trusted_radius = 1.0 }\n",
    "algorithm = \"lookahead\"\nsteps = 40\nprice = 4.0\nlabels = 3\nvehicle = { kind = \"boat\", sharpest = 0.6 }\n",
    "algorithm = \"lookahead\"\nsteps = 12\nvehicle = { kind = \"car\", radius = 0.8 }\nstart = { x = 10, z = 10, heading = 1 }\n\
     keep_out = [{ x = 6, z = 7, radius = 1.5 }]\n",
    "algorithm = \"lookahead\"\nsteps = 30\noracle = []\nstart = { x = 3, z = 3 }\nsensor = [{ dropouts = 0.1 }]\n",
    "algorithm = \"lookahead\"\nsteps = 25\noracle = []\nstart = { x = 3, z = 3 }\nnoise = { p = 0.9, trusted_radius = 0.0 }\n",
    "algorithm = \"track\"\nsteps = 60\noracle = []\nstart = { x = 3, z = 3 }\ntruth = { circle = [11, 9, 5] }\n",
    "algorithm = \"track\"\nsteps = 40\noracle = []\nstart = { x = 3, z = 3 }\nfront = { watch = 8.0 }\nnoise = { p = 0.9, trusted_radius = 0.0 }\n",
    "algorithm = \"chords\"\nsteps = 15\n",
    "algorithm = \"random\"\nsteps = 8\narea = { polygon = [[0, 0], [20, 0], [20, 20], [0, 20]] }\n",
    "algorithm = \"lookahead\"\nsteps = 25\narea = { geojson = \"kyyvesi.geojson\", cells = 64 }\noracle = []\n\
     start = { lat = 60.1990, lon = 24.9020 }\nvehicle = { kind = \"boat\", reach = 20.0, step = 1.0, sharpest = 0.5 }\n\
     truth = { slope = 0.3, intercept = -40.0 }\n",
];

/// A scenario of a kind, with a line of its own.
fn scenario(number: u64) -> String {
    let kind = KINDS[(number % KINDS.len() as u64) as usize];
    let mut rng = ChaCha8Rng::seed_from_u64(seed(53) + number);
    let mut text = format!("seed = {number}\n{kind}");
    let (slope, intercept) = (rng.random_range(-0.2..0.3), rng.random_range(7.0..11.0));
    if !kind.contains("truth") {
        let _ = writeln!(text, "truth = {{ slope = {slope}, intercept = {intercept} }}");
    }
    if kind.contains("oracle") { text } else { text + ORACLE }
}

/// The same in JSON, with a state, and what the robot says of a step.
fn request(scenario: &Value, frame: Option<&Frame>, step: Option<(&Value, &StepResult)>) -> String {
    let mut request = scenario.clone();
    if let Some((state, step)) = step {
        let place = |(site, reading): (Site, Reading)| {
            let at = Point2::<f64>::from(site);
            json!({ "x": at.x, "z": at.y, "label": reading.sign() })
        };
        request["state"] = state.clone();
        request["pose"] = json!(step.pose);
        if let Some(frame) = frame {
            let [lat, lon] = frame.exactly(Point2::new(step.pose.x, step.pose.z));
            request["pose"] = json!({ "lat": lat, "lon": lon, "heading": step.pose.heading });
        }
        request["label"] = json!(step.label);
        request["on_the_way"] = step.passed().map(place).collect();
    }
    request.to_string()
}

/// The record of a line of the trace, which a planner that knows no true pose can write.
fn record(line: &str) -> String {
    let (_, record) = line.trim_end().split_once(',').expect("a record");
    let mut record: Value = serde_json::from_str(&format!("{{{record}")).expect("JSON");
    record.as_object_mut().expect("a record").remove("true_pose");
    record.to_string()
}

/// A position of an answer, metres.
fn place(frame: Option<&Frame>, at: &Value) -> [f64; 2] {
    let number = |key: &str| at[key].as_f64().expect("a number");
    match frame {
        Some(frame) => {
            Point2::<f64>::from(frame.site([number("lat"), number("lon")]).expect("near")).into()
        }
        None => [number("x"), number("z")],
    }
}

#[test]
fn a_chain_of_requests_is_a_run() {
    let mut ended = BTreeSet::new();
    for number in 0..cases(42, 140) {
        let text = scenario(number);
        let folder = Path::new(FOLDER);
        let mission = scenario::parse_in("", &text, folder, Overrides::default()).expect(&text);
        let Recording { results, .. } = Recording::of(&mission).expect(&text);
        let mut scenario =
            serde_json::to_value(toml::from_str::<toml::Table>(&text).expect("TOML"))
                .expect("JSON");
        if let Some(name) = scenario["area"]["geojson"].as_str() {
            scenario["area"]["geojson"] = json!(format!("{FOLDER}/{name}"));
        }
        let frame = mission.lake.as_ref().map(|it| &it.frame);
        let ask = |request: &str| -> (String, Value) {
            let answer =
                answer(request, None).unwrap_or_else(|why| panic!("{number}: {why:#}\n{request}"));
            let value = serde_json::from_str(&answer).expect("JSON");
            (answer, value)
        };
        let (_, mut answered) = ask(&request(&scenario, frame, None));
        for step in &results.steps {
            let next = &answered["next"];
            let target = step.target.unwrap_or(step.pose);
            let [x, z] = place(frame, next);
            assert!((x - target.x).hypot(z - target.z) < 1e-9, "{number}: {next} {target:?}");
            assert_eq!(next["heading"], target.heading, "{number}");
            assert_eq!(next["label"], step.expected.is_some(), "{number}");
            let (said, value) = ask(&request(&scenario, frame, Some((&answered["state"], step))));
            assert_eq!(value["step"].to_string(), record(&trace::step(step)), "{number}: {said}");
            answered = value;
        }
        assert_eq!(answered["next"], Value::Null, "{number}");
        assert_eq!(answered["stop"], *results.end.reason, "{number}");
        assert_eq!(answered["end"].to_string(), record(&trace::end(&results.end)), "{number}");
        ended.insert(results.end.reason);
    }
    assert!(ended.len() >= 4, "{ended:?}");
}

/// A state says itself whether it was changed. Digits beyond what a number keeps change nothing.
#[test]
fn a_spoilt_state_is_refused() {
    let scenario = json!({
        "algorithm": "lookahead",
        "oracle": [{ "x": 2, "z": 1, "label": -1 }, { "x": 2, "z": 8, "label": 1 }, { "x": 18, "z": 5, "label": -1 }],
        "noise": { "p": 0.9, "trusted_radius": 0.0 },
    });
    let ask = |request: &Value| answer(&request.to_string(), None);
    let read = |answer: String| serde_json::from_str::<Value>(&answer).expect("JSON");
    let mut request = scenario.clone();
    for label in [-1, 1, 1] {
        let answered = read(ask(&request).expect("an answer"));
        let pose = ["x", "z", "heading"].map(|key| (key.to_owned(), answered["next"][key].clone()));
        request = scenario.clone();
        request["pose"] = Value::Object(pose.into_iter().collect());
        request["label"] = json!(label);
        request["state"] = answered["state"].clone();
    }
    let right = ask(&request).expect("an answer");
    let state = request["state"].to_string();
    let mut refused = 0;
    for at in 0..state.len() {
        for other in ["", "1", "7", "-", "a", "\"", "]", "0.5"] {
            let spoilt = format!("{}{other}{}", &state[..at], &state[at + 1..]);
            let Ok(value) = serde_json::from_str(&spoilt) else { continue };
            request["state"] = value;
            match ask(&request) {
                Ok(answer) => assert_eq!(answer, right, "{spoilt}"),
                Err(why) => {
                    assert!(format!("{why:#}").starts_with("the request: state: "), "{why:#}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 500, "{refused}");
    request["state"] = serde_json::from_str(&state).expect("JSON");
    request["noise"]["p"] = json!(0.8);
    let why = format!("{:#}", ask(&request).expect_err("another scenario"));
    assert!(why.contains("state: found another one"), "{why}");
}

/// A wrong request is refused by its key; what planners are not told may change.
#[test]
fn a_wrong_request_names_its_key() {
    let first = json!({
        "algorithm": "lookahead",
        "oracle": [{ "x": 2, "z": 1, "label": -1 }, { "x": 2, "z": 8, "label": 1 }, { "x": 18, "z": 5, "label": -1 }],
        "pose": { "x": 2, "z": 1 },
        "label": null,
    });
    let with = |request: &Value, other: &Value| {
        let mut request = request.clone();
        for (key, value) in other.as_object().expect("keys") {
            request[key] = value.clone();
        }
        request.to_string()
    };
    let answered: Value =
        serde_json::from_str(&answer(&first.to_string(), None).expect("an answer")).expect("JSON");
    let mut second = first.clone();
    second["pose"] = json!({ "x": 2, "z": 3, "heading": 1.5 });
    second["label"] = json!(-1);
    second["state"] = answered["state"].clone();
    for (request, wrong, says) in [
        (&first, json!({ "pose": { "x": 2 } }), "pose: found a part of a position"),
        (&first, json!({ "pose": { "x": 2, "z": 50 } }), "pose as start: found (2, 50)"),
        (&first, json!({ "label": 1 }), "label: found one without a state"),
        (
            &first,
            json!({ "samples": [{ "x": 9, "z": 7, "label": null }] }),
            "samples[0].label: found none",
        ),
        (
            &first,
            json!({ "samples": [{ "x": 9, "z": 7, "label": 2 }] }),
            "samples[0].label: found 2",
        ),
        (
            &first,
            json!({ "samples": [{ "x": 5, "z": 1, "label": 1 }] }),
            "samples[0]: label 1 at (5, 1) contradicts",
        ),
        (&second, json!({ "pose": { "x": 2, "z": 3 } }), "pose.heading: found none"),
        (&second, json!({ "pose": null }), "pose: found none"),
        (&second, json!({ "label": 2 }), "label: found 2"),
        (&second, json!({ "on_the_way": [{ "x": 2, "z": 2 }] }), "on_the_way[0].label: found none"),
        (
            &second,
            json!({ "samples": [{ "x": 9, "z": 7, "label": 1 }] }),
            "samples: found some beside a state",
        ),
        (&second, json!({ "tolerance": 0.1 }), "state: found another one"),
        (&second, json!({ "state": "x" }), "state: invalid type"),
    ] {
        let why = format!("{:#}", answer(&with(request, &wrong), None).expect_err(says));
        assert!(why.starts_with(&format!("the request: {says}")), "{wrong}: {why}");
    }
    let right = answer(&second.to_string(), None).expect("an answer");
    for free in [json!({ "steps": 30 }), json!({ "sensor": [{ "dropouts": 0.5 }] })] {
        assert_eq!(answer(&with(&second, &free), None).expect("an answer"), right, "{free}");
    }
}
