//! The program `fly` and a vehicle that is not ours, by UDP: one simulated with pymavlink. This test checks what the program
//! writes and says. The tests of `fly` in host-sim fly many missions of that vehicle, in virtual time and over a bad link.
//!
//! This test builds host-sim with another feature, so only the long run has it.

use std::io::{BufRead as _, BufReader, Write as _};
use std::net::UdpSocket;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::{fs, thread};

use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides, PAPER_NOISELESS};
use host_sim::mission::trace;
use nalgebra::Point2;
use serde_json::{Value, json};
use tests::build;

use crate::is_starved;

/// A flight: whether the program listens or speaks first, what tells labels, what happens, the status that it ends with,
/// and what it then says.
struct Case {
    listens: bool,
    label: &'static str,
    fault: Option<&'static str>,
    status: i32,
    said: &'static str,
}

const CASES: [Case; 4] = [
    Case { listens: true, label: "WET", fault: None, status: 0, said: "" },
    Case { listens: false, label: "channel:7", fault: None, status: 0, said: "" },
    Case {
        listens: true,
        label: "channel:7",
        fault: Some("disarm"),
        status: 1,
        said: "the vehicle was disarmed; it was told to stop, and says that it is at rest",
    },
    Case {
        listens: false,
        label: "WET",
        fault: Some("interrupt"),
        status: 130,
        said: "interrupted by signal 2; it was told to stop, and says that it is at rest",
    },
];

impl Case {
    /// Flies it; how the program ended, the trace that it wrote and that of `run`.
    fn fly(&self, program: &Path) -> (Output, String, String) {
        let scenario = format!("tolerance = 0.02\n{PAPER_NOISELESS}");
        let overrides = Overrides { steps: Some(6), ..Overrides::default() };
        let mission = scenario::parse("m", &scenario, overrides).expect("a scenario");
        let line = mission.world.line().expect("a line").coefficients();
        let at = Point2::<f64>::from(mission.start.site);
        let yaw = std::f64::consts::FRAC_PI_2 - mission.start.heading.radians();
        let expected = Recording::of(&mission).expect("labels are true");

        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("mavlink_vehicle.py");
        let mut python = Command::new("python3");
        python.arg(script).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut vehicle = python.spawn().expect("python3");
        let mut to = vehicle.stdin.take().expect("a pipe");
        let mut from = BufReader::new(vehicle.stdout.take().expect("a pipe"));
        let mut hear = || {
            let mut line = String::new();
            from.read_line(&mut line).expect("a line");
            serde_json::from_str::<Value>(&line).expect("JSON")
        };
        let host = "127.0.0.1";
        let own = UdpSocket::bind((host, 0)).expect("a port");
        let port = own.local_addr().expect("bound").port();
        let flight = json!({
            "host": host, "port": self.listens.then_some(port), "seed": 1, "craft": "rover", "line": line,
            "start": [at.y as f32, at.x as f32, yaw], "label": self.label, "drop": 0, "late": 0, "double": 0,
            "fault": self.fault, "at": 3,
        });
        writeln!(to, "{flight}").expect("it listens");
        let theirs = hear()["port"].as_u64().expect("a port");
        // Not before the vehicle has a port: it could get this one.
        drop(own);
        let address = if self.listens {
            format!("udp:{host}:{port}")
        } else {
            format!("udpout:{host}:{theirs}")
        };

        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        fs::write(folder.join("m.toml"), scenario).expect("a file");
        let child = Command::new(program)
            .args(["fly", "m.toml", "--quiet", "--mavlink", &address, "--label", self.label])
            .args(["--steps", "6", "--trace", "t.jsonl"])
            .current_dir(folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        if self.fault == Some("interrupt") {
            assert_eq!(hear(), json!({ "interrupt": true }));
            let id = child.id().to_string();
            let kill = Command::new("kill").args(["-s", "INT", &id]).status();
            assert!(kill.expect("it is there").success());
        }
        let output = child.wait_with_output().expect("it ends");
        writeln!(to, "over").expect("it listens");
        let told = hear();
        assert_eq!((&told["illicit"], &told["early"]), (&json!([]), &json!(0)), "{told}");
        drop(to);
        vehicle.wait().expect("it ends");
        let written = fs::read_to_string(folder.join("t.jsonl")).unwrap_or_default();
        (output, written.lines().map(without_times).collect(), trace::lines(&expected.results))
    }
}

/// A line of the trace without what a flight adds, which comes last.
fn without_times(line: &str) -> String {
    let rest = line.split_once(",\"flown\":{").map(|(before, _)| format!("{before}}}\n"));
    rest.unwrap_or_else(|| format!("{line}\n"))
}

#[test]
fn the_program_flies_by_udp_what_run_flies_and_says_why_it_ends() {
    let what = "missions over MAVLink";
    if !build::is_long(what, "mavlink") || !build::has_module("pymavlink", "pymavlink", what) {
        return;
    }
    let program = build::flying().expect("it builds");
    let fly = |case: &Case| {
        let mut flown = case.fly(&program);
        if is_starved(&String::from_utf8_lossy(&flown.0.stderr)) {
            flown = case.fly(&program);
        }
        let (output, written, expected) = flown;
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(case.status), "{said}");
        assert!(said.contains(case.said), "expected {:?} in: {said}", case.said);
        if case.fault.is_none() {
            assert_eq!(written, expected);
            return;
        }
        assert_eq!(said.lines().count(), 1, "one message: {said}");
        let steps: Vec<_> = written.lines().collect();
        let (end, steps) = steps.split_last().expect("a trace");
        assert!(end.contains("\"reason\":\"broken off\""), "{end}");
        assert!(!steps.is_empty() && steps.iter().zip(expected.lines()).all(|(a, b)| *a == b));
    };
    thread::scope(|scope| {
        for case in &CASES {
            scope.spawn(|| fly(case));
        }
    });
}
