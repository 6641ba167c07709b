//! The firmware under emulation, closed loop: the ELF that a board would run, in QEMU's STM32F405, with
//! its world at the other end of its serial link.
//!
//! Without QEMU or the target's standard library the tests say so and pass; with `CI` set they fail.

mod resume;
mod vehicle;

use std::convert::Infallible;
use std::fs;
use std::io::Write as _;
use std::path::Path;

use chips::budget::footprint::{self, Footprint};
use chips::emulator::missions::trace_here;
use chips::program::image::Image;
use host_sim::hil::faults::Faults;
use host_sim::hil::player::Played;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::results::Results;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::mission::trace;
use host_sim::world::faults::{Fault, FaultKind};
use planner_core::link::delivery::{Link, Port};
use planner_core::link::message::LabelSource;
use planner_core::robot::Body;
use planner_core::watch::{Alarm, Watched};
use planner_core::{Agent, Event, Label, Motion, Plan, Planner as _, Pose, Reading, Step};
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tempfile::NamedTempFile;
use tests::missions::{by_turns, reading};

use crate::board::{Board, answer, play_until, player, writes_to};
use crate::machines::STM32;

/// The first message. Under emulation the chip has no record of why it started, and no clock tree.
const STARTED: &str = "started: Other, clock: Emulated";

fn example(text: &str) -> Mission {
    scenario::parse("", text, Overrides::default()).expect("a good scenario")
}

/// Random missions of all that the firmware flies, by turns.
fn random(number: u64) -> Mission {
    by_turns(6, number, 10 + (number % 11) as u32)
}

/// The same with labels on the way.
fn random_reading(number: u64) -> Mission {
    reading(by_turns(6, number, 10))
}

fn start(more: &[&str]) -> Option<Board> {
    Board::start(STM32, more)
}

/// It flies a mission as this machine does.
fn flies(board: &Board, mission: &Mission, faults: Faults) -> Played {
    let played = board.fly(mission, faults).expect("it flies as here");
    assert_eq!(trace::lines(&played.recording.results), trace_here(mission), "{mission:?}");
    played
}

/// Scenarios with a table `[stop]`: the chip says why it ends, and logs it.
#[test]
fn the_chip_stops_when_enough_is_known() {
    let Some(chip) = start(&[]) else { return };
    let overrides = Overrides {
        algorithm: Some(Algorithm::Lookahead),
        steps: Some(32),
        ..Overrides::default()
    };
    for (number, (text, stop)) in (1..).zip([
        (scenario::PAPER_NOISELESS, "slope_arc_deg = 0.5"),
        (scenario::PAPER_NOISELESS, "misclassified = 0.001"),
        (scenario::PAPER_NOISY, "slope_arc_deg = 5.0"),
        (scenario::PAPER_NOISY, "misclassified = 0.15\nlevel = 0.8"),
    ]) {
        // Long motions, so that the steps suffice for the audit as well.
        let vehicle = "vehicle = { kind = \"unicycle\", reach = 6.0, step = 0.1 }\n";
        let text = format!("{vehicle}{text}\n[stop]\n{stop}\n").replace("p = 0.7", "p = 0.9");
        let mission = scenario::parse("", &text, overrides).expect("a good scenario");
        let Results { steps, end, .. } =
            flies(&chip, &mission, Faults::default()).recording.results;
        assert_eq!(
            (&*end.reason, end.goal.map(|goal| goal.is_met)),
            ("known", Some(true)),
            "{stop}"
        );
        assert!((5..32).contains(&steps.len()), "{stop}: {} steps", steps.len());
        let log = chip.messages_until(number, "bisector");
        let ended = format!("ended after {} steps: Stopped(Known)", steps.len());
        assert_eq!(log[log.len() - 4], ended, "{stop}");
    }
}

#[test]
fn a_bad_link_changes_nothing() {
    let faults = "drop=0.1,cut=0.02,corrupt=0.05,duplicate=0.1,delay=20ms";
    let faults: Faults = faults.parse().expect("faults");
    (0..16).into_par_iter().for_each(|number| {
        let Some(chip) = start(&[]) else { return };
        let mission = if number < 12 { random(number) } else { random_reading(number) };
        flies(&chip, &mission, faults);
    });
}

#[test]
fn garbage_is_passed_over() {
    let Some(mut chip) = start(&[]) else { return };
    let mut garbage = [0; 5_000];
    ChaCha8Rng::seed_from_u64(1).fill_bytes(&mut garbage);
    for mission in [random(0), random(1)] {
        chip.link.write_all(&garbage).expect("the link is open");
        flies(&chip, &mission, Faults::default());
    }
}

/// What the chip logs of a step.
fn step_message(number: usize, Step { motion, pose, reading, .. }: &Step) -> String {
    let (stage, recovery, action) = (motion.stage, motion.recovery, motion.action.0);
    let (x, z, heading) = (pose.site.x(), pose.site.z(), pose.heading.0);
    let label = reading.map(Reading::sign);
    format!(
        "step {number}: {stage:?} {recovery:?}, action {action}, to x {x}, z {z}, \
         heading {heading:#010x}, label {label:?}"
    )
}

#[test]
fn the_log_tells_the_mission() {
    let Some(chip) = start(&[]) else { return };
    let mission = example(scenario::PAPER_NOISELESS);
    let played = chip.fly(&mission, Faults::default()).expect("it flies");
    let log = chip.messages_until(1, "bisector");
    let steps = played.recording.steps.iter().zip(1..);
    let mut expected = vec![STARTED.to_owned(), "mission: Cfc, 10 steps at most".to_owned()];
    expected.extend(steps.map(|(step, number)| step_message(number, step)));
    expected.push("ended after 10 steps: Steps".to_owned());
    let estimates = played.recording.belief.estimates();
    for (name, line) in [
        ("centre", estimates.centre),
        ("maximum margin", estimates.maximum_margin),
        ("bisector", estimates.bisector),
    ] {
        let line = line.expect("a line");
        let (about, along) = (line.about(), line.along());
        expected.push(format!(
            "{name}: about x {}, z {}, along x {}, z {}: slope {:?}, intercept {:?}",
            about.x(),
            about.z(),
            along.x(),
            along.z(),
            line.slope(),
            line.intercept(),
        ));
    }
    assert_eq!(log, expected);
}

/// The sensor is stuck where labels are true, and inverts them where they may be wrong. The log has a warning and an alarm
/// after the labels that bring the evidence so far.
#[test]
fn the_log_warns_of_labels_that_no_line_explains() {
    let Some(chip) = start(&[]) else { return };
    let (stuck, inverted) = (FaultKind::Stuck(Label::Positive), FaultKind::Inverted);
    let mut expected = Vec::new();
    for (number, (text, algorithm, kind)) in (1..).zip([
        (scenario::PAPER_NOISELESS, Algorithm::Cfc, stuck),
        (scenario::PAPER_NOISELESS, Algorithm::Lookahead, stuck),
        (scenario::PAPER_NOISY, Algorithm::Scc, inverted),
        (scenario::PAPER_NOISY, Algorithm::Lookahead, stuck),
    ]) {
        let overrides =
            Overrides { algorithm: Some(algorithm), steps: Some(32), ..Overrides::default() };
        let text = text.replace("p = 0.7", "p = 0.95");
        let mut mission = scenario::parse("", &text, overrides).expect("a good scenario");
        mission.sensor = vec![Fault { kind, from: 3, to: u32::MAX }];
        let played = flies(&chip, &mission, Faults::default());
        let mut planner = mission.planner();
        let (mut planner, mut pose) = (Watched::new(&mut *planner), mission.start);
        for (step, number) in played.recording.steps.iter().zip(1..) {
            let evidence = |alarm: Option<Alarm>| alarm.map_or(0.0, |it| it.evidence);
            let before = evidence(planner.alarm());
            assert!(matches!(planner.plan(pose), Plan::Move(_)));
            planner.observe(step.pose, step.reading).expect("no label contradicts another");
            pose = step.pose;
            let passes = |level| before < level && evidence(planner.alarm()) >= level;
            if let Some(Alarm { evidence, suspect }) = planner.alarm()
                && (passes(Alarm::WARNING) || passes(Alarm::ALARM))
            {
                expected.push(format!(
                    "step {number}: evidence {evidence:?} against a straight, still line: {suspect:?}"
                ));
            }
        }
        let log = chip.messages_until(number, "bisector");
        let told = log.into_iter().filter(|it| it.contains("evidence"));
        assert_eq!(told.collect::<Vec<_>>(), expected);
    }
    assert!(expected.len() >= 6);
}

/// What was written to a port's set and reset register, by QEMU's log: it has no GPIO but says so.
fn drive_enable(writes: &Path) -> Vec<&'static str> {
    let log = fs::read_to_string(writes).expect("QEMU left a log");
    log.lines()
        .filter_map(|line| line.strip_prefix("GPIOB: unimplemented device write (size 4, offset "))
        .filter_map(|write| match write.strip_prefix("0x018, value ")?.strip_suffix(")")? {
            "0x00000001" => Some("on"),
            "0x00010000" => Some("off"),
            other => panic!("an unexpected write to GPIOB: {other}"),
        })
        .collect()
}

#[test]
fn a_cut_link_stops_the_mission_safely_within_the_bound_and_the_next_can_begin() {
    let writes = NamedTempFile::new().expect("a temporary file").into_temp_path();
    let Some(mut chip) = start(&writes_to(&writes)) else { return };
    let mission = random(0);
    // Answers up to the third motion, and then no more.
    let mut player = player(&mission, LabelSource::Vehicle);
    play_until(3, &mut chip.link, &mut player).expect("it flies");
    chip.messages_until(1, "stopped");
    let [.., (cut, _), (stopped, last)] = &chip.log()[..] else { panic!("a step before it stops") };
    assert_eq!(last, "stopped after 3 steps: Silent");
    // By the chip's clock. The plan takes less than a beat of 10 ms; each wait ends on one, after 100 ms.
    let (took, bound) = (stopped - cut, 10 + 110 * u32::from(Link::<Never>::ATTEMPTS));
    assert!((bound / 2..=bound).contains(&took), "{took} ms");
    assert_eq!(drive_enable(&writes), ["off", "on", "off"]);
    // What it asked meanwhile, nobody reads: a new cable finds it asking for a mission.
    flies(&chip, &mission, Faults::default());
    assert_eq!(drive_enable(&writes), ["off", "on", "off", "on", "off"]);
}

struct Never;

impl Port for Never {
    fn send(&mut self, _: &[u8]) {}

    fn receive(&mut self) -> Option<u8> {
        None
    }
}

/// A robot whose label sensor is on a pin that nothing pulls up.
struct AlwaysLow;

impl Body for AlwaysLow {
    type Error = Infallible;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, Infallible> {
        *pose = motion.target;
        Ok(motion.wants_label.then_some(Label::Negative.into()))
    }
}

#[test]
fn the_chip_can_read_labels_from_its_own_pin() {
    let Some(chip) = start(&[]) else { return };
    let mission = random(1);
    let mut player = player(&mission, LabelSource::Chip);
    chip.play(&mut player, Faults::default(), 1).expect("it flies");
    let played = player.finish().expect("it ends");
    let mut planner = mission.planner();
    let mut agent = Agent::new(&mut *planner, AlwaysLow, mission.start);
    let mut steps = Vec::new();
    while steps.len() < mission.steps as usize {
        match agent.step() {
            Ok(Event::Step(step)) => steps.push(step),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(played.recording.steps, steps);
}

/// USART2's data register: the firmware's log goes through it.
const LOG_DATA: u32 = 0x4000_4404;

#[test]
fn a_fault_disables_the_drive_first_then_tells_and_starts_anew() {
    let writes = NamedTempFile::new().expect("a temporary file").into_temp_path();
    let started = Board::with_debugger(STM32, &writes_to(&writes));
    let Some((chip, mut debugger)) = started else { return };
    debugger.say("c");
    chip.messages_until(1, STARTED);
    debugger.halt();
    assert_eq!(debugger.ask(&format!("Z2,{LOG_DATA:x},4")), "OK");
    debugger.say("c");
    // Taking the mission, it enables the drive, and logs; while it waits it has the log in hand.
    let mission = random(0);
    let mut player = player(&mission, LabelSource::Vehicle);
    let mut link = chip.link.try_clone().expect("a socket");
    let setup = answer(&mut link, &mut player).expect("the chip asks");
    link.write_all(setup.bytes()).expect("the link is open");
    let halted = debugger.answer();
    assert!(halted.contains("watch"), "{halted}");
    // The debugger sends it to where no memory is.
    debugger.jump(0xf000_0000);
    assert_eq!(debugger.ask(&format!("z2,{LOG_DATA:x},4")), "OK");
    assert_eq!(debugger.ask("D"), "OK");
    let log = chip.messages_until(2, STARTED);
    assert!(log[log.len() - 2].starts_with("fault at 0x"), "{log:#?}");
    assert_eq!(drive_enable(&writes), ["off", "on", "off", "off"]);
    // And it flies again.
    flies(&chip, &mission, Faults::default());
}

#[test]
fn the_stack_stays_within_its_bound() {
    let Some((chip, mut debugger)) = Board::with_debugger(STM32, &[]) else { return };
    debugger.say("c");
    for number in 0..6 {
        chip.fly(&random(number), Faults::default()).expect("it flies");
        chip.fly(&random_reading(number), Faults::default()).expect("it flies");
    }
    let elf = fs::read(STM32.elf().expect("it runs")).expect("cargo left an ELF");
    let image = Image::read(&elf);
    let bound = Footprint::of(&image).expect("a graph").stack as usize;
    // QEMU's RAM begins as zeros: what lies between statics and stack still is.
    debugger.halt();
    let size = footprint::ram() - image.statics();
    let between = debugger.memory(0x2000_0000 + image.statics(), size);
    let used = between.iter().skip_while(|byte| **byte == 0).count();
    assert!(bound / 2 < used && used <= bound, "{used} of {bound}");
}
