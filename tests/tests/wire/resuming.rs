//! Missions that a restart cuts off continue where they were, whichever end restarts and whenever. The trace equals
//! that of an uninterrupted mission, byte for byte.
//!
//! Chip and vehicle run here, in one thread and in virtual time.

use std::cell::RefCell;
use std::convert::Infallible;
use std::fs;
use std::path::Path;

use host_sim::hil::faults::Faults;
use host_sim::hil::player::Player;
use host_sim::hil::setup;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::report::trace;
use planner_core::link::message::{self, ClockRate, LabelSource, Reply, Request};
use planner_core::robot::LabelSensor;
use planner_core::{Reading, Reliability};
use rayon::prelude::*;
use tests::chip::{FarEnd, Off, power_up};
use tests::fronts::following;
use tests::missions::{mission, of_any_vehicle, reading};
use tests::wire::Wire;

/// Which end restarts, just before the chip sends its so-many-th frame.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Restart {
    Chip(u64),
    Host(u64),
}

/// A player at the other end of a wire, and ends that restart.
struct Yard<'a> {
    wire: Wire,
    mission: &'a Mission,
    labels: LabelSource,
    /// Where the host keeps the mission, if it does.
    place: Option<&'a Path>,
    /// There is none only while the host restarts.
    player: Option<Player>,
    starts: u32,
    frames: u64,
    restarts: Vec<Restart>,
}

impl<'a> Yard<'a> {
    fn new(mission: &'a Mission, labels: LabelSource, place: Option<&'a Path>) -> Self {
        let wire = Wire::new(Faults::default(), 0);
        let (restarts, player) = (Vec::new(), None);
        let mut yard =
            Self { wire, mission, labels, place, player, starts: 0, frames: 0, restarts };
        yard.start();
        yard
    }

    /// The host starts, with what there is of the mission.
    fn start(&mut self) {
        self.starts += 1;
        // It ends before the next one starts.
        drop(self.player.take());
        let player = Player::new(self.mission, self.labels, 1_000 * self.starts);
        let player = player.expect("a mission for a chip");
        let player = match self.place {
            Some(place) => player.keeping(place).expect("its own steps"),
            None => player.resuming(),
        };
        self.player = Some(player);
    }
}

impl FarEnd for Yard<'_> {
    fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
        self.frames += 1;
        while let Some(restart) = self.restarts.pop() {
            match restart {
                Restart::Chip(at) if at <= self.frames => {
                    self.wire.forget();
                    return Err(Off);
                }
                Restart::Host(at) if at <= self.frames => self.start(),
                later => {
                    self.restarts.push(later);
                    break;
                }
            }
        }
        self.wire.ask(frame);
        Ok(())
    }

    fn receive(&mut self) -> Option<u8> {
        let player = self.player.as_mut()?;
        self.wire.answer(|byte| player.hear(byte).expect("it is as it was"))
    }
}

/// The chip's own sensor: it reads where the robot stands, wherever the chip believes to be. In noise one place in nine
/// reads wrong, always the same, but none beside a given sample.
struct Sensor<'a, 'b>(&'a RefCell<Yard<'b>>);

impl LabelSensor for Sensor<'_, '_> {
    type Error = Infallible;

    fn read(&mut self) -> Result<Reading, Infallible> {
        let yard = self.0.borrow();
        let site = yard.player.as_ref().expect("it has started").place();
        let Mission { given, world, .. } = yard.mission;
        let noise = yard.mission.noise_known().expect("a number");
        let is_certain = noise.at(site, given.samples()) == Reliability::CERTAIN;
        let wrong = !is_certain && (site.x() ^ site.z()).rem_euclid(9) == 0;
        Ok(match world.reading(site) {
            Reading::Side(label) if wrong => Reading::Side(-label),
            reading => reading,
        })
    }
}

/// Chips, one after the other as their power fails, until the mission is over; the trace.
fn flown(yard: Yard<'_>) -> String {
    flown_in_frames(yard).0
}

/// The same, and how many frames the chips sent.
fn flown_in_frames(yard: Yard<'_>) -> (String, u64) {
    let (place, yard) = (yard.place, RefCell::new(yard));
    while power_up(&yard, Some(&mut Sensor(&yard))).is_err() {}
    let Yard { player, restarts, frames, .. } = yard.into_inner();
    assert!(restarts.is_empty(), "{restarts:?} never came");
    let played = player.expect("it has started").finish().expect("the mission is over");
    let results = &played.recording.results;
    if let (Some(logbook), Some(place)) = (played.logbook, place) {
        logbook.complete(&results.end).expect("it takes its place");
        assert_eq!(fs::read_to_string(place).expect("a trace"), trace::lines(results));
    }
    (trace::lines(results), frames)
}

/// The missions of every planner and vehicle, among keep-outs and with robots that err, by who reads labels.
fn missions() -> Vec<(Mission, LabelSource)> {
    let by_turns = (0..12).map(mission).chain((0..6).map(|number| reading(mission(number))));
    let of_vehicles = (0..24).map(|number| of_any_vehicle(number, 6));
    // Every pair of a planner and a vehicle, of robots that err too.
    let of_readings = (0..12).map(|number| reading(of_any_vehicle(number, 4)));
    let of_fronts = (0..4).map(|number| following(6, number, 12));
    let of_fronts = of_fronts.chain((0..4).map(|number| reading(following(7, number, 6))));
    let all = by_turns.chain(of_vehicles).chain(of_readings).chain(of_fronts);
    let by_source = |mission: Mission| {
        // A chip's sensor has no robot that errs to ask where it truly is.
        let by_chip = (mission.errors == host_sim::world::errors::Errors::default())
            .then(|| (mission.clone(), LabelSource::Chip));
        [(mission, LabelSource::Vehicle)].into_iter().chain(by_chip)
    };
    all.flat_map(by_source).collect()
}

/// The trace without a restart, and the frames that the chip sent: a hello, for outlines, that it accepts, two a motion
/// with a label on the way or along a front, one for any other, and the end.
fn undisturbed((mission, labels): &(Mission, LabelSource)) -> (String, u64) {
    let (trace, frames) = flown_in_frames(Yard::new(mission, *labels, None));
    if *labels == LabelSource::Vehicle {
        let here = Recording::of(mission).expect("labels that are certain are true");
        assert_eq!(trace, trace::lines(&here.results));
    }
    let motions = trace.lines().count() as u64 - 2;
    let least = before(mission) + motions + 1;
    let says_more = mission.readings > 1 || !mission.algorithm.seeks_line();
    assert_eq!(frames > least, says_more, "{mission:?}");
    (trace, frames)
}

/// Frames that a chip sends before the first motion, on a link that loses none.
fn before(mission: &Mission) -> u64 {
    let setup = setup::setup(mission, LabelSource::Vehicle).expect("a mission");
    let outlines = setup.keep_outs.map_or(0, |count| u64::from(count) + 1);
    1 + outlines + 1
}

#[test]
fn a_chip_that_restarts_anywhere_goes_on() {
    let cut = missions().into_par_iter().map(|case| {
        let (mission, labels) = &case;
        let (whole, frames) = undisturbed(&case);
        for at in 1..=frames {
            let mut yard = Yard::new(mission, *labels, None);
            yard.restarts = vec![Restart::Chip(at)];
            assert!(flown(yard) == whole, "{labels:?}, restart at {at}: {mission:?}");
        }
        frames
    });
    println!("{} restarts", cut.sum::<u64>());
}

/// The chip restarts whenever it has come one motion further, and again as it flies that again.
#[test]
fn a_chip_that_restarts_all_the_time_comes_to_the_end() {
    missions().par_iter().for_each(|case| {
        let (mission, labels) = case;
        let (whole, _) = undisturbed(case);
        let before = before(mission);
        let mut yard = Yard::new(mission, *labels, None);
        let (mut restarts, mut frames) = (Vec::new(), 0);
        for step in 1..whole.lines().count() as u64 - 1 {
            frames += before + step;
            restarts.push(Restart::Chip(frames));
            if step % 3 == 0 {
                frames += before + step / 2;
                restarts.push(Restart::Chip(frames));
            }
        }
        yard.restarts = restarts.into_iter().rev().collect();
        assert!(flown(yard) == whole, "{labels:?}: {mission:?}");
    });
}

#[test]
fn a_host_that_restarts_anywhere_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let cut = missions().into_par_iter().enumerate().map(|(number, case)| {
        let (mission, labels) = &case;
        let (whole, frames) = undisturbed(&case);
        for at in 1..=frames {
            let place = folder.path().join(format!("{number}-{at}.jsonl"));
            let mut yard = Yard::new(mission, *labels, Some(&place));
            // And the chip with it, every other time.
            yard.restarts = vec![Restart::Host(at)];
            yard.restarts.extend((at % 2 == 0).then_some(Restart::Chip(at)));
            assert!(flown(yard) == whole, "{labels:?}, restart at {at}: {mission:?}");
        }
        frames * 3 / 2
    });
    println!("{} restarts", cut.sum::<u64>());
}

#[test]
fn over_a_bad_link_too() {
    let faults: Faults =
        "drop=0.1,cut=0.02,corrupt=0.05,duplicate=0.1,delay=20ms".parse().expect("faults");
    let folder = tempfile::tempdir().expect("a folder");
    let cut = missions().into_par_iter().enumerate().map(|(number, case)| {
        let (mission, labels) = &case;
        let (whole, frames) = undisturbed(&case);
        for at in 1..=frames {
            let place = folder.path().join(format!("{number}-{at}.jsonl"));
            let mut yard = Yard::new(mission, *labels, Some(&place));
            yard.wire = Wire::new(faults, 1_000 * number as u64 + at);
            yard.restarts = vec![Restart::Chip(at + 9), Restart::Host(at + 4), Restart::Chip(at)];
            assert!(flown(yard) == whole, "{labels:?}, restarts from {at}: {mission:?}");
        }
        frames * 3
    });
    println!("{} restarts", cut.sum::<u64>());
}

/// A chip that asks for something else when it flies again has another planner: the step is named, and nothing moves.
#[test]
fn a_chip_that_changed_its_mind_is_found_out() {
    let mission = mission(0);
    let here = Recording::of(&mission).expect("labels are true");
    let mut player = Player::new(&mission, LabelSource::Vehicle, 1).expect("a mission").resuming();
    let mut says = |session: u32, number: u32, request: Request| {
        use planner_core::link::frame::{Decoder, Envelope, Frame};
        let frame = Frame::of(&Envelope::new(session, number, request));
        let mut answered = Ok(None);
        for byte in frame.bytes() {
            answered = player.hear(*byte);
        }
        let mut decoder = Decoder::default();
        answered.map(|frame| {
            let frame = frame.expect("an answer");
            let envelope = frame.bytes().iter().find_map(|byte| decoder.feed::<Reply>(*byte));
            envelope.expect("a whole frame").message
        })
    };
    let took = message::Took::default();
    let ready = || {
        let capacity = message::Capacity { samples: 68, hypotheses: 1 };
        let clock = ClockRate { per_second: 1, emulated: false };
        Request::Ready(message::Accepted { capacity, clock })
    };
    let moves = |step: usize, last| {
        Request::Move(message::Move { motion: here.steps[step].motion, last, took })
    };
    let [first, second] = [0, 1].map(|step: usize| here.steps[step].reading);
    assert_eq!(says(2, 1, ready()).expect("it begins"), Reply::Noted);
    let told = says(2, 2, moves(0, None)).expect("it moves");
    says(2, 3, moves(1, first)).expect("it moves");
    assert_eq!(says(3, 1, ready()).expect("it begins again"), Reply::Noted);
    assert_eq!(says(3, 2, moves(0, None)).expect("as before"), told);
    let error = says(3, 3, moves(2, first)).expect_err("another motion").to_string();
    assert!(error.contains("step 2: the board asks for action"), "{error}");
    // It says that it took in what it was told then, too.
    assert_eq!(says(4, 1, ready()).expect("it begins again"), Reply::Noted);
    says(4, 2, moves(0, None)).expect("as before");
    let error = says(4, 3, moves(1, None)).expect_err("it was told a reading").to_string();
    assert!(error.contains("step 1: sensed"), "{error}");
    assert!(second.is_some());
    // It does not get anywhere.
    let error = (5..).find_map(|session| says(session, 1, ready()).err()).expect("an end");
    assert!(error.to_string().contains("again and again after step 1"), "{error}");
}
