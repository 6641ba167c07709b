//! `docs/vehicle.py`, a vehicle by `docs/protocol.md` and `docs/protocol.schema` alone, flies missions with the firmware.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::env;
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use host_sim::hil::faults::{Faults, Spoiler};
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::world::on_the_way::Way;
use host_sim::world::robot::{Glimpse, Ideal, Robot as _};
use planner_core::robot::Body;
use planner_core::{Agent, Estimates, Event, FrontState, Motion, Pose, Reading, Site};
use rayon::prelude::*;
use tests::build;

use crate::firmware::start;

/// A mission that the vehicle is told by its flags.
#[derive(Clone, Copy, Debug)]
struct Flight {
    algorithm: Algorithm,
    steps: u32,
    /// Labels a motion.
    readings: u32,
    p: f64,
    /// Which labels are read wrong.
    wrong: &'static [usize],
    /// Metres of front that are watched.
    watch: Option<u32>,
}

const USUAL: Flight = Flight {
    algorithm: Algorithm::Lookahead,
    steps: 12,
    readings: 1,
    p: 1.0,
    wrong: &[],
    watch: None,
};

const ALONG_FRONT: Flight = Flight {
    algorithm: Algorithm::Track,
    steps: 24,
    readings: 2,
    p: 0.9,
    wrong: &[9, 20],
    ..USUAL
};

const FLIGHTS: [Flight; 8] = [
    Flight { algorithm: Algorithm::Cfc, ..USUAL },
    USUAL,
    Flight { steps: 9, p: 0.9, wrong: &[3, 7], ..USUAL },
    Flight { algorithm: Algorithm::Scc, steps: 9, p: 0.7, wrong: &[2, 5, 6], ..USUAL },
    Flight { readings: 4, ..USUAL },
    Flight { steps: 8, readings: 3, p: 0.9, wrong: &[3, 7, 8], ..USUAL },
    ALONG_FRONT,
    Flight { watch: Some(6), ..ALONG_FRONT },
];

impl Flight {
    fn flags(self) -> Vec<String> {
        let Self { algorithm, steps, readings, p, wrong, watch } = self;
        let mut flags =
            vec![format!("--algorithm={}", algorithm.name()), format!("--steps={steps}")];
        flags.extend([format!("--p={p}"), format!("--readings={readings}")]);
        flags.extend(watch.map(|metres| format!("--watch={metres}")));
        if !wrong.is_empty() {
            flags.push("--wrong".to_owned());
            flags.extend(wrong.iter().map(ToString::to_string));
        }
        flags
    }

    /// The same mission here.
    fn mission(self) -> Mission {
        let Self { algorithm, steps, readings, p, .. } = self;
        let text = if p < 1.0 {
            scenario::PAPER_NOISY.replace("p = 0.7", &format!("p = {p}"))
        } else {
            scenario::PAPER_NOISELESS.to_owned()
        };
        // What planners differ in beside their name is theirs by default.
        let text = text.replace("varrho = 0.1\n", &format!("readings = {readings}\n"));
        let overrides =
            Overrides { algorithm: Some(algorithm), steps: Some(steps), ..Overrides::default() };
        let mission = scenario::parse("", &text, overrides).expect("a good scenario");
        Mission { watch: self.watch.map(f64::from), ..mission }
    }
}

/// An ideal robot that reads some labels wrong.
struct Misread {
    ideal: Ideal,
    way: Way,
    wrong: &'static [usize],
    labels: usize,
}

impl Body for Misread {
    type Error = Infallible;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, Infallible> {
        self.perform_reading(motion, pose, &mut |_, _| ())
    }

    fn perform_reading(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        tell: &mut dyn FnMut(Site, Reading),
    ) -> Result<Option<Reading>, Infallible> {
        let Self { ideal, way, wrong, labels } = self;
        let mut misread = |reading| {
            *labels += 1;
            match reading {
                Reading::Side(label) if wrong.contains(labels) => Reading::Side(-label),
                reading => reading,
            }
        };
        let reading = ideal.travel(motion, pose, *way, &mut |it: Glimpse| {
            if let Some(reading) = it.reading {
                tell(it.reported, misread(reading));
            }
        });
        Ok(reading.map(misread))
    }
}

/// A step: action, target, label.
type Step = (u32, [i64; 3], i8);

/// Lines by their names: site, direction, slope and intercept. Vertices of a map by their steps: site, heading, and
/// curvature and deviations.
type Lines = BTreeMap<String, (Vec<i64>, Vec<f32>)>;

/// What the planner makes of a flight here.
fn here(flight: Flight) -> (Vec<Step>, Lines) {
    let mission = flight.mission();
    let mut planner = mission.planner();
    let ideal = Ideal { world: mission.world.clone() };
    let body = Misread { ideal, way: mission.way(), wrong: flight.wrong, labels: 0 };
    let mut agent = Agent::new(&mut *planner, body, mission.start);
    let (mut steps, mut lines) = (Vec::new(), Lines::new());
    for number in 1..=flight.steps {
        let Ok(Event::Step(step)) = agent.step() else { panic!("{flight:?} ends early") };
        if let Some(FrontState { waist: Some(it), .. }) = agent.planner.front() {
            let exact = vec![it.site.x().into(), it.site.z().into(), it.heading.0.into()];
            let rest = vec![it.curvature, it.deviation, it.turn_deviation];
            lines.insert(format!("vertex {number}"), (exact, rest));
        }
        let Pose { site, heading } = step.motion.target;
        let target = [site.x().into(), site.z().into(), heading.0.into()];
        let label = step.reading.map_or(0, Reading::sign);
        steps.push((step.motion.action.0, target, label));
    }
    let Estimates { bisector, centre, maximum_margin } = planner.belief().estimates();
    let named = [("bisector", bisector), ("centre", centre), ("maximum_margin", maximum_margin)];
    lines.extend(named.into_iter().filter_map(|(name, line)| {
        let line = line?;
        let (about, along) = (line.about(), line.along());
        let exact = [about.x(), about.z(), along.x(), along.z()].map(i64::from);
        Some((name.to_owned(), (exact.to_vec(), vec![line.slope(), line.intercept()])))
    }));
    (steps, lines)
}

/// What the vehicle printed.
fn told(output: &str) -> (Vec<Step>, Lines) {
    let numbers = |text: &str| -> Vec<f64> {
        let words = text.split([' ', ',']).filter(|word| !word.is_empty());
        words.map(|word| word.parse().expect("a number")).collect()
    };
    let step = |line: &str| {
        let (_, rest) = line.strip_prefix("step ")?.split_once(": action ")?;
        let (action, rest) = rest.split_once(" to ")?;
        let (target, label) = rest.split_once(" (")?.1.split_once("), label ")?;
        let target = numbers(target).into_iter().map(|it| it as i64).collect::<Vec<_>>();
        let label = if label == "none" { 0 } else { label.parse().ok()? };
        Some((action.parse().ok()?, target.try_into().ok()?, label))
    };
    let estimate = |line: &str| {
        let (name, exact) = line.split_once(": ")?;
        let exact = numbers(exact.split_once(", exactly ")?.1);
        let (whole, rest) = exact.split_at(if name.starts_with("vertex") { 3 } else { 4 });
        let rest = rest.iter().map(|it| *it as f32).collect();
        Some((name.to_owned(), (whole.iter().map(|it| *it as i64).collect(), rest)))
    };
    (output.lines().filter_map(step).collect(), output.lines().filter_map(estimate).collect())
}

/// Hands on frames, spoiled as asked, until the link ends or so many have passed.
fn hand_on(
    mut from: &TcpStream,
    mut to: &TcpStream,
    spoiler: &mut Spoiler,
    most: usize,
    is_over: &AtomicBool,
) {
    let (mut frame, mut passed) = (Vec::new(), 0);
    let mut buffer = [0; 512];
    while !is_over.load(Ordering::Relaxed) {
        let read = match from.read(&mut buffer) {
            Ok(0) => break,
            Ok(read) => read,
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => continue,
            Err(_) => break,
        };
        for &byte in &buffer[..read] {
            frame.push(byte);
            if byte != 0 || frame.iter().all(|byte| *byte == 0) {
                continue;
            }
            for (_, bytes) in spoiler.spoil(&std::mem::take(&mut frame)) {
                if to.write_all(&bytes).is_err() {
                    is_over.store(true, Ordering::Relaxed);
                }
            }
            passed += 1;
            if passed >= most {
                is_over.store(true, Ordering::Relaxed);
            }
        }
    }
    is_over.store(true, Ordering::Relaxed);
}

/// Has the vehicle fly with chips, each of which loses its power after so many frames, then with one that does not;
/// what it printed. `None` where that cannot be.
fn fly(flight: Flight, faults: Faults, powers: &[usize]) -> Option<String> {
    if !build::has_tool("python3") {
        build::skip("docs/vehicle.py", "python3 is not on PATH");
        return None;
    }
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/vehicle.py");
    let mut chip = start(&[])?;
    let vehicle = Command::new("python3")
        .arg(program)
        .arg(listener.local_addr().expect("its address").to_string())
        .args(flight.flags())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("python3 starts");
    let (wheels, _) = listener.accept().expect("the vehicle connects");
    wheels.set_read_timeout(Some(Duration::from_millis(20))).expect("a socket");
    let mut spoilers = [0, 1].map(|way| Spoiler::new(faults, 5, way));
    let mut powers = powers.iter().copied();
    loop {
        let power = powers.next();
        let is_over = AtomicBool::new(false);
        let [from_chip, to_chip] = &mut spoilers;
        let link = &chip.link;
        link.set_read_timeout(Some(Duration::from_millis(20))).expect("a socket");
        thread::scope(|scope| {
            scope.spawn(|| hand_on(&wheels, link, to_chip, usize::MAX, &is_over));
            hand_on(link, &wheels, from_chip, power.unwrap_or(usize::MAX), &is_over);
        });
        if power.is_none() {
            break;
        }
        // One after the other, as one chip's power would come again.
        drop(chip);
        chip = start(&[]).expect("it started before");
    }
    let output = vehicle.wait_with_output().expect("it ends");
    let [said, complaint] =
        [output.stdout, output.stderr].map(|it| String::from_utf8(it).expect("text"));
    assert!(output.status.success(), "{flight:?}: {said}{complaint}");
    Some(said)
}

#[test]
fn a_vehicle_written_from_the_page_flies_as_planned() {
    let mut flown: Vec<(Flight, &str, &[usize])> =
        FLIGHTS.iter().map(|it| (*it, "", &[][..])).collect();
    let bad = "drop=0.1,cut=0.03,corrupt=0.05,duplicate=0.1";
    flown.extend(FLIGHTS.iter().map(|it| (*it, bad, &[][..])));
    // Where the chip restarts it goes on; of those with labels on the way some restarts are in the middle of a motion.
    for (flight, powers) in [(5, &[6, 10][..]), (2, &[5, 9]), (1, &[7])] {
        flown.push((FLIGHTS[flight], "", powers));
    }
    flown.into_par_iter().for_each(|(flight, faults, powers)| {
        let is_bad = !faults.is_empty();
        let spoiled = if is_bad { faults.parse().expect("faults") } else { Faults::default() };
        let Some(said) = fly(flight, spoiled, powers) else { return };
        let (steps, lines) = here(flight);
        let (flown, estimates) = told(&said);
        assert_eq!(flown, steps, "{flight:?}: {said}");
        assert_eq!(estimates, lines, "{flight:?}: {said}");
        assert!(said.contains("\nended: Steps\n") && !lines.is_empty(), "{flight:?}: {said}");
        let restarts = said.matches("the chip has restarted").count();
        assert!(is_bad || restarts == powers.len(), "{said}");
    });
}
