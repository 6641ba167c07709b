//! Missions that a vehicle flies over `MAVLink`: one simulated with pymavlink, which is not ours, at the end of a bad link.
//! Those that finish have the trace of `run`, byte for byte. Those to which something happens name it at their end, and
//! the vehicle comes to rest as soon as it can.
//!
//! There is one exception. The vehicle takes any setpoint as `ArduPilot` does: also one that a newer one has overtaken on
//! the link. Such a setpoint may undo the end of a motion. Then the flight goes on from where the vehicle says it is. From
//! there on its trace differs from that of `run`.
//!
//! This test builds host-sim with another feature, so only the long run has it.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::UdpSocket;
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use std::{fs, io, thread};

use host_sim::campaign::standard_field::standard;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::report::trace;
use nalgebra::Point2;
use planner_core::Label;
use serde_json::{Value, json};
use tests::build;

const SEED: u64 = 14;
const MISSIONS: u64 = 200;

/// So many at a time: they mostly wait, and need a fiftieth of a core each.
const AT_ONCE: usize = 14;

/// The machine was too busy to judge a mission that failed if a vehicle's tick or a heartbeat of ours came so many
/// seconds late.
const LATE: f64 = 0.05;

/// What happens to a vehicle, and what the flight then ends with. A vehicle that was taken over or disarmed does not
/// hear stops.
const FAULTS: [(&str, i32, &str); 16] = [
    ("mode", 1, "its failsafe or its operator; nothing more was sent to it"),
    (
        "ekf",
        1,
        "its failsafe or its operator; nothing more was sent to it; it said \"EKF failsafe\"",
    ),
    ("restart", 1, "the autopilot was started anew; nothing more was sent to it"),
    (
        "held",
        1,
        "fence holds it back (breach_mitigation): the place it was sent to is too near the",
    ),
    ("slide", 1, "that its speed does not explain"),
    ("disarm", 1, "the vehicle was disarmed; it was told to stop, and says that it is at rest"),
    ("fence", 1, "the vehicle has left its geofence; it was told to stop, and says that it is"),
    ("failsafe", 1, "failsafe has acted: system status MAV_STATE_CRITICAL; it was told to"),
    ("silent", 1, "no position for 2 s; it was told to stop, and does not say that it is at"),
    ("heartless", 1, "no heartbeat for 5 s; it was told to stop, and says that it is at rest"),
    ("lost", 1, "no position for 2 s; it was told to stop, and does not say that it is at"),
    ("stuck", 1, "not there within 8 s"),
    ("car", 1, "of its turn: a vehicle that does not turn on the spot is a `boat`"),
    ("mute", 1, "no label within 3 s"),
    ("lie", 1, "`noise` for labels that are wrong; it was told to stop"),
    ("interrupt", 130, "interrupted by signal 2; it was told to stop, and says that it is at"),
];

/// A process that simulates a vehicle a line.
struct Vehicle {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Vehicle {
    fn new() -> Self {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("mavlink_vehicle.py");
        let mut python = Command::new("python3");
        python.arg(script).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = python.spawn().expect("python3");
        let to = child.stdin.take().expect("a pipe");
        let from = BufReader::new(child.stdout.take().expect("a pipe"));
        Self { child, to, from }
    }

    fn tell(&mut self, line: &Value) {
        writeln!(self.to, "{line}").expect("it listens");
    }

    fn hear(&mut self) -> Value {
        let mut line = String::new();
        self.from.read_line(&mut line).expect("a line");
        serde_json::from_str(&line).expect("JSON")
    }
}

impl Drop for Vehicle {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A mission: its scenario, and what is to happen.
struct Case {
    number: u64,
    scenario: String,
    fault: Option<(&'static str, i32, &'static str)>,
}

impl Case {
    fn new(number: u64) -> Self {
        let of = (number / 2) as usize % FAULTS.len();
        let fault = (number % 2 == 1).then_some(FAULTS[of]);
        let lies = fault.is_some_and(|it| it.0 == "lie");
        let (algorithm, vehicle) = match number % 5 {
            // One that asks where the label is certain.
            _ if lies => (Algorithm::Random, "unicycle"),
            0 => (Algorithm::Cfc, "unicycle"),
            1 => (Algorithm::Lookahead, "boat"),
            _ => (Algorithm::Lookahead, "unicycle"),
        };
        let field = standard(SEED, number, algorithm, 1);
        let [a, b, c] = field.world.line().expect("a line").coefficients();
        let mut scenario = format!(
            "algorithm = \"{}\"\nsteps = {}\nseed = {number}\ntolerance = 0.02\n\
             vehicle = {{ kind = \"{vehicle}\" }}\nstart = {{ heading = {:?} }}\n\
             truth = {{ line = [{a:?}, {b:?}, {c:?}] }}\noracle = [\n",
            algorithm.name(),
            // What happens may be told late, and takes a while to come out.
            if fault.is_some() { 40 } else { 8 },
            field.start.heading.radians(),
        );
        for sample in field.given.samples() {
            let at = Point2::<f64>::from(sample.site);
            let label = if sample.label == Label::Positive { 1 } else { -1 };
            let _ = writeln!(scenario, "  {{ x = {:?}, z = {:?}, label = {label} }},", at.x, at.y);
        }
        scenario.push_str("]\n");
        Self { number, scenario, fault }
    }

    /// What `run` makes of it.
    fn expected(&self) -> (Recording, String) {
        let mission = scenario::parse("m", &self.scenario, Overrides::default());
        let recording = Recording::of(&mission.expect("a scenario")).expect("labels are true");
        let lines = trace::lines(&recording.results);
        (recording, lines)
    }

    /// Flies it; what the program said, the trace that it wrote, and what the vehicle says.
    fn fly(&self, program: &Path, vehicle: &mut Vehicle, folder: &Path) -> Flown {
        let (expected, lines) = self.expected();
        let [a, b, c] = expected.mission.world.line().expect("a line").coefficients();
        let start = expected.mission.start;
        let (at, heading) = (Point2::<f64>::from(start.site), start.heading.radians());
        let number = self.number;
        let crafts = ["rover", "sub", "boat"];
        let label = if number % 4 < 2 { "WET" } else { "channel:7" };
        // It is spoken to, or speaks first.
        let listens = !number.is_multiple_of(3);
        // An address of its own: what another vehicle still says to a port that was left comes to nobody.
        let host = format!("127.0.{}.{}", 1 + number / 250, 1 + number % 250);
        let socket = UdpSocket::bind((&*host, 0)).expect("a port");
        let port = socket.local_addr().expect("bound").port();
        vehicle.tell(&json!({
            "host": host,
            "port": if listens { json!(port) } else { Value::Null },
            "seed": number,
            "craft": crafts[number as usize / 3 % 3],
            "line": [a, b, c],
            "start": [at.y as f32, at.x as f32, std::f64::consts::FRAC_PI_2 - heading],
            "label": label,
            "drop": 0.1, "late": 0.1, "double": 0.05,
            "fault": self.fault.map(|it| it.0),
            "at": 2 + number % 5,
            "table": number == 0,
        }));
        let theirs = vehicle.hear()["port"].as_u64().expect("a port");
        // Not before the vehicle has a port: it could get this one.
        drop(socket);
        let address =
            if listens { format!("udp:{host}:{port}") } else { format!("udpout:{host}:{theirs}") };
        let (file, written) = (folder.join("m.toml"), folder.join("t.jsonl"));
        fs::write(&file, &self.scenario).expect("a file");
        let _ = fs::remove_file(&written);
        let child = Command::new(program)
            .args(["fly", "m.toml", "--quiet", "--mavlink", &address, "--label", label])
            .args(["--trace", "t.jsonl", "--label-time", "3", "--motion-time", "8"])
            .current_dir(folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        let id = child.id();
        if self.fault.is_some_and(|it| it.0 == "interrupt") {
            assert_eq!(vehicle.hear(), json!({ "interrupt": true }), "{number}");
            let kill = Command::new("sh").args(["-c", &format!("kill -s INT {id}")]).status();
            assert!(kill.expect("a shell").success(), "{number}");
        }
        let output = child.wait_with_output().expect("it ends");
        vehicle.tell(&json!("over"));
        let told = vehicle.hear();
        let written = fs::read_to_string(written).unwrap_or_default();
        let written = written.lines().map(without_times).collect();
        Flown { output, written, expected: lines, told }
    }
}

/// A line of the trace without what a flight adds, which comes last.
fn without_times(line: &str) -> String {
    let rest = line.split_once(",\"flown\":{").map(|(before, _)| format!("{before}}}\n"));
    rest.unwrap_or_else(|| format!("{line}\n"))
}

struct Flown {
    output: Output,
    written: String,
    expected: String,
    told: Value,
}

impl Flown {
    /// How late the machine was at most, seconds.
    fn late(&self) -> f64 {
        self.told["late"].as_f64().unwrap_or(0.0)
    }

    /// Whether its steps are those of `run` from the first one on. Where it [is undone](Self::is_undone), they may differ
    /// from a step on that ended apart from its target.
    fn is_as_run(&self) -> bool {
        let mut pairs = self.written.lines().zip(self.expected.lines());
        let ends = |it: &str| it.starts_with("{\"record\":\"end\"");
        let other = pairs.find(|(a, b)| a != b && !ends(a));
        other.is_none_or(|(a, _)| self.is_undone() && a.contains("\"target\":"))
    }

    /// Whether a newer setpoint overtook one, and a motion ended apart from its target.
    fn is_undone(&self) -> bool {
        self.told["overtaken"].as_u64() > Some(0) && self.written.contains("\"target\":")
    }

    /// What is wrong with it.
    fn faults(&self, case: &Case) -> Vec<String> {
        let mut faults = Vec::new();
        let mut check = |holds: bool, what: String| {
            if !holds {
                faults.push(what);
            }
        };
        let message = String::from_utf8_lossy(&self.output.stderr);
        let status = self.output.status.code();
        let told = &self.told;
        check(told["illicit"] == json!([]), format!("was sent {}", told["illicit"]));
        check(told["early"] == 0, format!("{} setpoints before it was ready", told["early"]));
        check(told["moved_after"] == 0.0, format!("moved {} m after", told["moved_after"]));
        check(told["orders_after"] == 0, format!("{} orders after", told["orders_after"]));
        check(told["restarted"] == 0, format!("{} legs begun anew", told["restarted"]));
        // What does not turn on the spot flies a mission in which it need not.
        let fault = case.fault.filter(|it| it.0 != "car" || told["happened"] == true);
        let Some((name, expected, part)) = fault else {
            check(status == Some(0), format!("status {status:?}: {message}"));
            let is_whole = self.written == self.expected || self.is_undone();
            check(is_whole && self.is_as_run(), "another trace than run's".to_owned());
            check(
                told["was_stopped"] == true,
                format!("it was not stopped in the end; it took {}", told["last"]),
            );
            return faults;
        };
        check(told["happened"] == true, "nothing happened".to_owned());
        check(status == Some(expected), format!("status {status:?}"));
        check(message.contains(part), format!("expected {part:?} in: {message}"));
        check(message.lines().count() == 1, format!("one message: {message}"));
        // What is disarmed or held takes no setpoint, and a stop is one.
        let hears = !["mode", "ekf", "restart", "disarm"].contains(&name);
        check(told["was_stopped"] == hears, format!("was_stopped {}", told["was_stopped"]));
        let reacted = told["reacted"].as_f64().unwrap_or(0.0);
        check(reacted < 1.5, format!("told to stop after {reacted} s"));
        // The steps so far are those of run.
        let steps: Vec<_> = self.written.lines().collect();
        let Some(end) = steps.last() else {
            check(false, "no trace".to_owned());
            return faults;
        };
        check(self.is_as_run() || name == "lie", "another trace than run's so far".to_owned());
        check(end.contains("\"reason\":\"broken off\""), format!("it ends {end}"));
        faults
    }
}

#[test]
fn missions_over_a_bad_link_are_those_of_run_or_end_at_rest() {
    let what = "missions over MAVLink";
    if !build::is_long(what, "mavlink") {
        return;
    }
    let _alone = crate::alone();
    if !build::has_module("pymavlink", "pymavlink", what) {
        return;
    }
    let program = build::flying().expect("it builds");
    let (next, began) = (AtomicU64::new(0), Instant::now());
    let flown = Mutex::new(BTreeMap::new());
    thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                let folder = tempfile::tempdir().expect("a folder");
                let mut vehicle = Vehicle::new();
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= MISSIONS {
                        break;
                    }
                    let it = Case::new(number).fly(&program, &mut vehicle, folder.path());
                    flown.lock().expect("no panic").insert(number, it);
                }
            });
        }
    });
    let mut flown = flown.into_inner().expect("no panic");
    let (folder, mut vehicle) = (tempfile::tempdir().expect("a folder"), Vehicle::new());
    for (number, it) in &mut flown {
        let case = Case::new(*number);
        let (faults, late) = (it.faults(&case), it.late());
        if !faults.is_empty() && late > LATE {
            let why = format!("the machine was busy for {late:.2} s ({})", faults.join("; "));
            // Straight to the handle: libtest shows it though the test passes.
            let line = format!("AGAIN, alone: mission {number} of seed {SEED}: {why}\n");
            let _ = io::stderr().write_all(line.as_bytes());
            *it = case.fly(&program, &mut vehicle, folder.path());
        }
    }
    tell(&flown, began.elapsed().as_secs_f64());
    let faults: Vec<_> = flown
        .iter()
        .flat_map(|(number, it)| {
            let case = Case::new(*number);
            let name = case.fault.map_or("none", |it| it.0);
            let faults = it.faults(&case).into_iter();
            faults.map(move |it| format!("mission {number} of seed {SEED}, {name}: {it}"))
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let undone = flown.values().filter(|it| it.is_undone()).count() as u64;
    assert!(undone <= MISSIONS / 20, "{undone} were undone by overtaken setpoints");
    let habits = habits(&flown);
    assert!(habits.len() == 4 && habits.values().all(|it| *it > 0.0), "{habits:?}");
}

/// How much vehicles did of what real ones do: metres coasted and crawled, positions while they swayed, turns on the
/// spot that were passed over.
fn habits(flown: &BTreeMap<u64, Flown>) -> BTreeMap<String, f64> {
    let mut sums = BTreeMap::new();
    for it in flown.values() {
        for (habit, much) in it.told["habits"].as_object().expect("habits") {
            *sums.entry(habit.clone()).or_insert(0.0) += much.as_f64().expect("a number");
        }
    }
    sums
}

/// How many ended how, and what vehicles were sent.
fn tell(flown: &BTreeMap<u64, Flown>, seconds: f64) {
    let (mut ends, mut sent) = (BTreeMap::new(), BTreeMap::new());
    for (number, it) in flown {
        *ends.entry(Case::new(*number).fault.map_or("finished", |it| it.0)).or_insert(0) += 1;
        for (kind, count) in it.told["received"].as_object().expect("counts") {
            *sent.entry(kind).or_insert(0) += count.as_u64().expect("a count");
        }
    }
    println!("{} missions in {seconds:.0} s: {ends:?}", flown.len());
    println!("Vehicles were sent: {sent:?}; their habits: {:?}", habits(flown));
    println!(
        "Undone by overtaken setpoints: {}",
        flown.values().filter(|it| it.is_undone()).count()
    );
    let table = flown.get(&0).and_then(|it| it.told["table"].as_array());
    for row in table.into_iter().flatten() {
        println!("{row}");
    }
}
