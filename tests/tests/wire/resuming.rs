//! Missions that a restart cuts off continue where they were, whichever end restarts and whenever. The trace equals
//! that of an uninterrupted mission, byte for byte.
//!
//! Chip and vehicle run here, in one thread and in virtual time.

use std::cell::RefCell;
use std::fs;
use std::path::Path;
use std::time::Duration;

use host_sim::hil::faults::Faults;
use host_sim::hil::player::Player;
use host_sim::hil::setup;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::mission::trace;
use host_sim::world::errors::Errors;
use planner_core::link::frame::Decoder;
use planner_core::link::message::{CHARTED, LabelSource, Request};
use planner_core::{Reading, Reliability};
use rayon::prelude::*;
use tests::cases;
use tests::chip::{FarEnd, Off, Reads, power_up};
use tests::fronts::following;
use tests::lakes;
use tests::missions::{mission, of_any_vehicle, reading};
use tests::wire::{self, Wire};

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
    /// The chip's last request, and how many came since the last restart, at what time, while it does not fly again.
    last: Vec<u8>,
    since: Option<(u64, Duration)>,
    /// The most requests and the longest time until a chip flew again.
    again: (u64, Duration),
}

impl<'a> Yard<'a> {
    fn new(mission: &'a Mission, labels: LabelSource, place: Option<&'a Path>) -> Self {
        let mut yard = Self {
            wire: Wire::new(Faults::default(), 0),
            mission,
            labels,
            place,
            player: None,
            starts: 0,
            frames: 0,
            restarts: Vec::new(),
            last: Vec::new(),
            since: None,
            again: Default::default(),
        };
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

    /// Counts requests from a restart on, until the chip asks for a motion of its new beginning.
    fn count(&mut self, frame: &[u8]) {
        let mut decoder = Decoder::default();
        let request = frame.iter().find_map(|byte| decoder.feed::<Request>(*byte));
        let request = request.expect("a whole frame").message;
        let is_new = self.last != frame;
        self.last = frame.to_vec();
        let Some((requests, at)) = &mut self.since else { return };
        if *requests > 0 && matches!(request, Request::Move(_)) {
            let time = self.wire.now.saturating_sub(*at);
            self.again = (self.again.0.max(*requests), self.again.1.max(time));
            self.since = None;
        } else {
            let is_of_ground = matches!(
                request,
                Request::Outline(_) | Request::Chart | Request::Cells(_) | Request::Move(_)
            );
            *requests += u64::from(is_new && !is_of_ground);
        }
    }
}

impl FarEnd for Yard<'_> {
    fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
        self.frames += 1;
        while let Some(restart) = self.restarts.pop() {
            match restart {
                Restart::Chip(at) if at <= self.frames => {
                    self.since = Some((0, self.wire.now));
                    self.last.clear();
                    self.wire.forget();
                    return Err(Off);
                }
                Restart::Host(at) if at <= self.frames => {
                    // The request that the chip repeats now is still of the session that was broken off.
                    self.since = Some((0, self.wire.now));
                    self.last = frame.to_vec();
                    self.start();
                }
                later => {
                    self.restarts.push(later);
                    break;
                }
            }
        }
        self.count(frame);
        self.wire.ask(frame);
        Ok(())
    }

    fn receive(&mut self) -> Option<u8> {
        let player = self.player.as_mut()?;
        self.wire.answer(|byte| player.hear(byte).expect("it is as it was"))
    }
}

/// What the chip's own sensor reads: where the robot stands, wherever the chip believes to be. In noise one place in nine
/// reads wrong, always the same, but none beside a given sample.
fn sensed(yard: &Yard<'_>) -> Reading {
    let site = yard.player.as_ref().expect("it has started").place();
    let Mission { given, world, .. } = yard.mission;
    let noise = yard.mission.noise_known().expect("a number");
    let is_certain = noise.at(site, given.samples()) == Reliability::CERTAIN;
    let wrong = !is_certain && (site.x() ^ site.z()).rem_euclid(9) == 0;
    match world.reading(site) {
        Reading::Side(label) if wrong => Reading::Side(-label),
        reading => reading,
    }
}

/// Chips, one after the other as their power fails, until the mission is over: the trace, how many frames they sent, and
/// the most requests and the longest time until one flew again.
fn flown(yard: Yard<'_>) -> (String, u64, (u64, Duration)) {
    let (place, yard) = (yard.place, RefCell::new(yard));
    let mut sensor = Reads(|| Ok(sensed(&yard.borrow())));
    while power_up(&yard, Some(&mut sensor)).is_err() {}
    let Yard { player, restarts, frames, again, .. } = yard.into_inner();
    assert!(restarts.is_empty(), "{restarts:?} never came");
    let played = player.expect("it has started").finish().expect("the mission is over");
    let results = &played.recording.results;
    if let (Some(logbook), Some(place)) = (played.logbook, place) {
        logbook.complete(&results.end).expect("it takes its place");
        assert_eq!(fs::read_to_string(place).expect("a trace"), trace::lines(results));
    }
    (trace::lines(results), frames, again)
}

/// The missions of every planner and vehicle, among keep-outs and with robots that err, by who reads labels.
fn missions() -> Vec<(Mission, LabelSource)> {
    let few = |count| cases(count / 2, count);
    let by_turns =
        (0..few(12)).map(mission).chain((0..few(6)).map(|number| reading(mission(number))));
    let of_vehicles = (0..few(24)).map(|number| of_any_vehicle(number, 6));
    // Every pair of a planner and a vehicle, of robots that err too.
    let of_readings = (0..few(12)).map(|number| reading(of_any_vehicle(number, 4)));
    let of_fronts = (0..4).map(|number| following(6, number, 12));
    let of_fronts = of_fronts.chain((0..few(4)).map(|number| reading(following(7, number, 6))));
    let of_lakes = (0..few(4)).map(|number| lakes::for_a_chip(10 * number, 64, 6));
    let all = by_turns.chain(of_vehicles).chain(of_readings).chain(of_fronts).chain(of_lakes);
    let by_source = |mission: Mission| {
        // A chip's sensor has no robot that errs to ask where it truly is.
        let by_chip =
            (mission.errors == Errors::default()).then(|| (mission.clone(), LabelSource::Chip));
        [(mission, LabelSource::Vehicle)].into_iter().chain(by_chip)
    };
    all.flat_map(by_source).collect()
}

/// The trace without a restart, and the frames that the chip sent: a hello, for outlines and a chart, that it accepts, two a motion
/// with a label on the way or along a front, one for any other, and the end.
fn undisturbed(mission: &Mission, labels: LabelSource) -> (String, u64) {
    let (trace, frames, _) = flown(Yard::new(mission, labels, None));
    if labels == LabelSource::Vehicle {
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
    let outlines = setup.keep_outs.map_or(0, |count| u64::from(count % CHARTED) + 1);
    let pieces =
        mission.lake.as_ref().map_or(0, |it| it.chart.cells().len().div_ceil(64) as u64 + 1);
    1 + outlines + pieces + 1
}

/// Chip, host or both restart before each frame of a mission. On a good link it flies again after a hello and its
/// acceptance, and no time passes. On a bad one a frame of before the restart that comes late can cost more requests.
#[test]
fn whichever_end_restarts_anywhere_the_mission_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    missions().into_par_iter().enumerate().for_each(|(number, (mission, labels))| {
        let (whole, frames) = undisturbed(&mission, labels);
        for at in 1..=frames {
            // In a quick run one of these at each frame, by turns. The last of some restarts is the first to come.
            let kinds = [
                (Faults::default(), false, vec![Restart::Chip(at)]),
                (Faults::default(), true, vec![Restart::Host(at)]),
                (
                    wire::bad(),
                    true,
                    vec![Restart::Chip(at + 9), Restart::Host(at + 4), Restart::Chip(at)],
                ),
                (Faults::default(), true, vec![Restart::Host(at), Restart::Chip(at)]),
            ];
            // The host waits for its disc.
            let turn = [0, 1, 0, 2, 0, 0, 3, 0][(number as u64 + at) as usize % 8];
            let is_due = |k: usize| tests::is_long() || k == turn;
            let due = kinds.into_iter().enumerate().filter(|(k, _)| is_due(*k));
            for (_, (faults, keeps, restarts)) in due {
                let place = folder.path().join(format!("{number}-{at}-{}.jsonl", restarts.len()));
                let mut yard = Yard::new(&mission, labels, keeps.then_some(&*place));
                yard.wire = Wire::new(faults, 1_000 * number as u64 + at);
                let context = format!("{labels:?}, {restarts:?}: {mission:?}");
                yard.restarts = restarts;
                let (trace, _, (requests, time)) = flown(yard);
                assert!(trace == whole, "{context}");
                let most = if faults == Faults::default() { (2, 0) } else { (6, 4) };
                let is_soon = requests <= most.0 && time <= Duration::from_secs(most.1);
                assert!(is_soon, "{requests} requests, {time:?}: {context}");
                let _ = fs::remove_file(place);
            }
        }
    });
}

/// The chip restarts whenever it has come one motion further, and again as it flies that again.
#[test]
fn a_chip_that_restarts_all_the_time_comes_to_the_end() {
    missions().par_iter().for_each(|(mission, labels)| {
        let (whole, _) = undisturbed(mission, *labels);
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
        assert!(flown(yard).0 == whole, "{labels:?}: {mission:?}");
    });
}
