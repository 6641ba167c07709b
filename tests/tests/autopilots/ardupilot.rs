//! Flights against `ArduPilot`'s own simulation. Rovers, a boat in wind and a submarine find a line, by UDP, TCP and a
//! serial line. A rover in motion is made to fail, and `fly` tells the true reason.
//!
//! The simulators are `ardurover` and `ardusub`, with `ArduPilot`'s default parameters of its frames in `params/`. The environment
//! variable `ARDUPILOT` names their folder; else it is `../shared/autopilot` beside the repository. Where there are none, a
//! line says that this was left out.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{env, fs, process, thread};

use serde_json::{Value, json};
use tests::build;

use crate::is_starved;

/// So many at a time.
const AT_ONCE: usize = 2;

/// The slope of the line that is sought, degrees: 0.3 m a metre.
const TRUE_SLOPE: f64 = 16.699;

/// How far off it may be found after twenty steps, where the oracle leaves some 80 degrees at first.
const SLOPE_WITHIN: f64 = 8.0;

const AREA: &str = "
area = { x = [-50.0, 50.0], z = [-50.0, 50.0] }
oracle = [
  { x = -40.0, z = -40.0, label = -1 },
  { x = -40.0, z = 30.0, label = 1 },
  { x = 40.0, z = 40.0, label = 1 },
  { x = 40.0, z = -30.0, label = -1 },
]
";

/// What flies, by which link, and what is to happen.
#[derive(Clone, Copy)]
struct Case {
    craft: &'static str,
    link: &'static str,
    wind: f64,
    speedup: f64,
    is_true: bool,
    /// Whether its operator drives first, and takes labels so.
    is_by_hand: bool,
    /// What happens, what is told of it, the status, and how far the vehicle may go after the end, metres.
    fault: Option<(&'static str, &'static str, i32, f64)>,
}

const fn finishes(craft: &'static str, link: &'static str, wind: f64, speedup: f64) -> Case {
    Case { craft, link, wind, speedup, is_true: false, is_by_hand: false, fault: None }
}

/// Labels by the true position of a vehicle that goes by the estimated one.
const fn finishes_by_truth(craft: &'static str, link: &'static str) -> Case {
    Case { is_true: true, ..finishes(craft, link, 0.0, 5.0) }
}

/// Three labels by hand first.
const fn finishes_by_hand(craft: &'static str, link: &'static str) -> Case {
    Case { is_by_hand: true, ..finishes(craft, link, 0.0, 4.0) }
}

const fn fails(
    link: &'static str,
    event: &'static str,
    told: &'static str,
    status: i32,
    after: f64,
) -> Case {
    Case {
        craft: "skid",
        link,
        wind: 0.0,
        speedup: 2.0,
        is_true: false,
        is_by_hand: false,
        fault: Some((event, told, status, after)),
    }
}

/// Rover and Sub first, which any long run flies. `LONG=1` flies all.
const CASES: [Case; 12] = [
    finishes("sub", "udp", 0.0, 20.0),
    finishes("skid", "udp", 0.0, 20.0),
    finishes("boat", "serial", 5.0, 10.0),
    finishes("car", "tcp", 0.0, 10.0),
    finishes_by_truth("skid", "udp"),
    finishes_by_hand("skid", "tcp"),
    fails(
        "udp",
        "hold",
        "the mode is HOLD, no longer GUIDED: its failsafe or its operator",
        1,
        1.5,
    ),
    fails("tcp", "disarm", "the vehicle was disarmed; it was told to stop", 1, 0.5),
    fails(
        "serial",
        "interrupt",
        "interrupted by signal 2; it was told to stop, and says",
        130,
        0.5,
    ),
    fails("udp", "freeze", "no position for 2 s; it was told to stop, and does not say", 1, 0.0),
    fails("udp", "reboot", "no position for 2 s; it was told to stop, and does not say", 1, 1.5),
    fails("udp", "param:SIM_GPS1_GLTCH_X=0.00003", "its position slid by", 1, 3.5),
];

impl Case {
    fn scenario(&self) -> String {
        let vehicle = match self.craft {
            "car" | "boat" => "kind = \"boat\", sharpest = 0.5",
            _ => "kind = \"unicycle\"",
        };
        let tolerance = if self.craft == "boat" { 2.0 } else { 1.5 };
        format!(
            "algorithm = \"lookahead\"\nsteps = 20\ntolerance = {tolerance}\n\
             vehicle = {{ {vehicle}, reach = 10.0, step = 2.5 }}{AREA}"
        )
    }

    /// Flies it; what came of it, and its trace.
    fn fly(&self, number: usize, simulators: &Path, program: &Path) -> (Value, String) {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("m.toml"), self.scenario()).expect("a file");
        // The heartbeat of `fly` is one a second of ours, which is late by the clock of a Sub that is sped up.
        let params = if self.craft == "sub" {
            json!({ "FS_GCS_ENABLE": 3, "FS_GCS_TIMEOUT": 60 })
        } else {
            json!({ "WP_RADIUS": 0.5 })
        };
        let drives = json!([[1500, 1800, 6], [1700, 1500, 2], [1500, 1800, 6]]);
        let drives = if self.is_by_hand { drives } else { json!([]) };
        let flight = json!({
            "craft": self.craft, "link": self.link, "number": number, "is_true": self.is_true,
            "speedup": self.speedup, "wind": self.wind, "line": [0.3, 5.0], "params": params,
            "by_hand": drives, "event": self.fault.map(|it| it.0), "at": 12, "after": 6,
        });
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("ardupilot_flight.py");
        let output = Command::new("python3")
            .arg(script)
            .args([simulators, program, folder.path()])
            .arg(flight.to_string())
            .output()
            .expect("python3");
        let text = String::from_utf8_lossy(&output.stdout);
        let last = text.lines().last().and_then(|line| serde_json::from_str(line).ok());
        let errors = String::from_utf8_lossy(&output.stderr);
        let came = last.unwrap_or_else(|| json!({ "said": errors }));
        (came, fs::read_to_string(folder.path().join("t.jsonl")).unwrap_or_default())
    }

    /// What is wrong with a flight.
    fn faults(&self, came: &Value, trace: &str) -> Vec<String> {
        let said = came["said"].as_str().unwrap_or_default();
        let mut faults = Vec::new();
        let mut check = |holds: bool, what: String| {
            if !holds {
                faults.push(format!("{} by {}: {what}: {came}", self.craft, self.link));
            }
        };
        let Some((event, told, status, after)) = self.fault else {
            check(came["status"] == 0, "it did not finish".to_owned());
            let slope = slope(trace);
            let is_near = slope.is_some_and(|it| (it - TRUE_SLOPE).abs() <= SLOPE_WITHIN);
            check(is_near, format!("slope {slope:?}"));
            check(is_left(trace), "the true slope was ruled out".to_owned());
            let by_hand = trace.lines().next().map_or(0, |it| it.matches("\"label\"").count() - 4);
            let expected = if self.is_by_hand { 3 } else { 0 };
            check(by_hand == expected, format!("{by_hand} labels by hand"));
            return faults;
        };
        check(came["happened"] == true, format!("{event} did not happen"));
        check(came["status"] == status, format!("expected status {status}"));
        check(said.contains(told), format!("expected {told:?}"));
        let moved = came["moved_after"].as_f64().unwrap_or(f64::MAX);
        check(moved <= after, format!("moved {moved} m after the end"));
        faults
    }
}

fn end(trace: &str) -> Option<Value> {
    serde_json::from_str(trace.lines().last()?).ok()
}

/// What was found, degrees.
fn slope(trace: &str) -> Option<f64> {
    end(trace)?["estimates"]["centre"]["angle"].as_f64()
}

/// Whether the labels leave the true slope.
fn is_left(trace: &str) -> bool {
    let step = trace.lines().rev().nth(1).and_then(|it| serde_json::from_str::<Value>(it).ok());
    let arcs = step.and_then(|it| it["slope_arcs"].as_array().cloned()).unwrap_or_default();
    arcs.iter().any(|arc| {
        let [low, high] = [0, 1].map(|end| arc[end].as_f64().unwrap_or(f64::NAN));
        (low..=high).contains(&TRUE_SLOPE)
    })
}

fn simulators() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/autopilot");
    let folder = env::var_os("ARDUPILOT").map_or(beside, PathBuf::from);
    let is_there = ["ardurover", "ardusub", "params"].iter().all(|it| folder.join(it).exists());
    is_there.then(|| fs::canonicalize(folder).ok()).flatten()
}

#[test]
fn vehicles_of_ardupilot_find_a_line_and_what_happens_is_told() {
    let what = "flights of ArduPilot";
    if !build::is_long(what, "ardupilot") {
        return;
    }
    let Some(simulators) = simulators() else {
        let why =
            "no ardurover, ardusub and params/ where ARDUPILOT says, or in ../shared/autopilot";
        return build::leave_out(what, why);
    };
    if !build::has_module("pymavlink", "pymavlink", what) {
        return;
    }
    let program = build::flying().expect("it builds");
    // Ports of its own, beside another run of this: the simulation takes numbers below 256.
    let own = 20 + process::id() as usize % 19 * 12;
    let fly = |number: usize| {
        let case = &CASES[number];
        let (came, trace) = case.fly(own + number, &simulators, &program);
        let is_provoked = case.fault.is_some_and(|it| it.1.starts_with("no position"));
        let is_starved = !is_provoked && is_starved(came["said"].as_str().unwrap_or_default());
        (case.faults(&came, &trace), is_starved)
    };
    let flights = tests::cases(2, CASES.len() as u64) as usize;
    let (next, failed) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= flights {
                        break;
                    }
                    let (faults, is_starved) = fly(number);
                    if !faults.is_empty() {
                        failed.lock().expect("no panic").push((number, faults, is_starved));
                    }
                }
            });
        }
    });
    // One that got too few messages is flown again, alone.
    let again = |(number, faults, is_starved)| if is_starved { fly(number).0 } else { faults };
    let faults: Vec<_> =
        failed.into_inner().expect("no panic").into_iter().flat_map(again).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
