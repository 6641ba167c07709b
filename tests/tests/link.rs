//! The link: missions over one that loses, cuts, spoils, doubles and delays frames, and a decoder fed
//! with garbage.
//!
//! Chip and vehicle run here, in one thread and in virtual time, so that a thousand missions with all
//! their waits take seconds, and each is the same whenever it is run.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::convert::Infallible;
use std::fmt::Debug;
use std::panic::{self, AssertUnwindSafe};
use std::time::Duration;

use host_sim::campaign::standard_field;
use host_sim::hil::faults::{Faults, Spoiler};
use host_sim::hil::player::{self, Player};
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::report::trace;
use host_sim::world::noise::{Extent, NoiseModel};
use host_sim::world::robot::Robot;
use planner_core::belief::Belief as _;
use planner_core::belief::estimate::Estimates;
use planner_core::belief::sample::Reading;
use planner_core::belief::version_space::NoVersionSpace;
use planner_core::geometry::line::Line;
use planner_core::link::delivery::{Heard, Link, LinkLost, Port, Responder};
use planner_core::link::frame::{Decoder, Envelope, FRAME, Frame, Message};
use planner_core::link::message::{
    self, Capacity, ClockRate, Declined, LabelSource, PROTOCOL, Reply, Request,
};
use planner_core::link::station::{Flown, Station};
use planner_core::motion::dynamics::Pose;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How long the chip waits for an answer before it asks again.
const WAIT: Duration = Duration::from_millis(100);

const SEED: u64 = 4;

/// Which way a frame goes.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    ToChip,
    ToVehicle,
}

/// A network in virtual time with the vehicle at its other end.
struct Network {
    now: Duration,
    /// When the chip's wait is over.
    until: Duration,
    under_way: BTreeMap<(Duration, u64), (Way, Vec<u8>)>,
    launched: u64,
    /// Cut for good after so many frames, in one way or both.
    cut: Option<(u64, Option<Way>)>,
    to_chip: Spoiler,
    to_vehicle: Spoiler,
    arrived: VecDeque<u8>,
    player: Player,
    failure: Option<String>,
    frames_of_chip: u64,
}

impl Network {
    fn new(mission: &Mission, faults: Faults) -> Self {
        Self {
            now: Duration::ZERO,
            until: Duration::ZERO,
            under_way: BTreeMap::new(),
            launched: 0,
            cut: None,
            to_chip: Spoiler::new(faults, mission.seed, 0),
            to_vehicle: Spoiler::new(faults, mission.seed, 1),
            arrived: VecDeque::new(),
            player: Player::new(mission, LabelSource::Vehicle, 1).expect("a mission for a chip"),
            failure: None,
            frames_of_chip: 0,
        }
    }

    fn launch(&mut self, way: Way, frame: &[u8]) {
        let spoiler = if way == Way::ToChip { &mut self.to_chip } else { &mut self.to_vehicle };
        for (late, bytes) in spoiler.spoil(frame) {
            self.launched += 1;
            let is_cut = |(after, only): (u64, Option<Way>)| {
                self.launched > after && only.is_none_or(|only| only == way)
            };
            if !self.cut.is_some_and(is_cut) {
                self.under_way.insert((self.now + late, self.launched), (way, bytes));
            }
        }
    }
}

/// The chip's end of a network.
#[derive(Clone, Copy)]
struct Plug<'a>(&'a RefCell<Network>);

impl Port for Plug<'_> {
    fn send(&mut self, frame: &[u8]) {
        let mut net = self.0.borrow_mut();
        net.until = net.now + WAIT;
        net.frames_of_chip += 1;
        net.launch(Way::ToVehicle, frame);
    }

    fn receive(&mut self) -> Option<u8> {
        let mut net = self.0.borrow_mut();
        loop {
            if let Some(byte) = net.arrived.pop_front() {
                return Some(byte);
            }
            let until = net.until;
            let due = net.under_way.first_entry().filter(|it| it.key().0 < until);
            let Some(due) = due else {
                net.now = until;
                return None;
            };
            let ((at, _), (way, bytes)) = due.remove_entry();
            net.now = net.now.max(at);
            match way {
                Way::ToChip => net.arrived.extend(bytes),
                Way::ToVehicle => {
                    for byte in bytes {
                        match net.player.hear(byte) {
                            Ok(Some(frame)) => net.launch(Way::ToChip, frame.bytes()),
                            Ok(None) => {}
                            Err(error) => net.failure = Some(error.to_string()),
                        }
                    }
                }
            }
        }
    }
}

type Chip<'a> = Station<Plug<'a>, Infallible>;

fn chip(network: &RefCell<Network>) -> Chip<'_> {
    let clock = ClockRate { per_second: 1, emulated: false };
    Station { link: Link::new(Plug(network)), sensor: None, ticks: || 0, clock }
}

/// What the firmware does with a setup.
fn fly<P: Port>(
    chip: &mut Station<P, Infallible>,
    setup: &message::Setup,
) -> Result<Flown, LinkLost> {
    match setup.algorithm {
        message::Algorithm::Cfc => chip.fly(setup, &mut setup.cfc::<68>(), |_| {}),
        message::Algorithm::Scc { noise, policy, prior } => {
            let mut planner = setup.scc::<36, 529>(policy);
            chip.fly(setup, &mut setup.prepare(&mut planner, prior, noise), |_| {})
        }
    }
}

/// Missions of both algorithms by turns.
fn mission(number: u64) -> Mission {
    let algorithm = if number.is_multiple_of(2) { Algorithm::Cfc } else { Algorithm::Scc };
    let mut mission = standard_field::standard(SEED, number, algorithm, 10);
    if algorithm == Algorithm::Scc {
        mission.noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });
    }
    mission
}

#[test]
fn a_thousand_missions_over_a_bad_link_end_as_over_a_good_one() {
    let faults: Faults =
        "drop=0.1,cut=0.02,corrupt=0.05,duplicate=0.1,delay=20ms".parse().expect("faults");
    let asked: u64 = (0..1000)
        .into_par_iter()
        .map(|number| {
            let mission = mission(number);
            let network = RefCell::new(Network::new(&mission, faults));
            let mut chip = chip(&network);
            let setup = chip.await_setup();
            let flown = fly(&mut chip, &setup);
            assert!(matches!(flown, Ok(Flown::Ended(_))), "mission {number}: {flown:?}");
            drop(chip);
            let Network { player, failure, frames_of_chip, .. } = network.into_inner();
            assert!(failure.is_none(), "mission {number}: {failure:?}");
            let here = Recording::of(&mission).expect("trusted labels are true");
            assert_eq!(player.motions(), here.steps.len(), "mission {number}: motions made");
            let there = player.finish().expect("the mission is over").recording;
            assert_eq!(
                trace::lines(&there.results),
                trace::lines(&here.results),
                "mission {number}"
            );
            frames_of_chip - (3 + here.steps.len() as u64)
        })
        .sum();
    println!("1000 missions end as without faults; requests were repeated {asked} times");
    assert!(asked > 1000, "the link was not bad");
}

#[test]
fn a_cut_link_ends_every_mission_within_the_bound_and_with_no_motion_after_it() {
    let bound = WAIT * u32::from(Link::<Plug<'_>>::ATTEMPTS);
    (0..1000u64).into_par_iter().for_each(|number| {
        let mission = mission(number);
        let network = RefCell::new(Network::new(&mission, Faults::default()));
        let mut chip = chip(&network);
        let setup = chip.await_setup();
        let ways = [None, Some(Way::ToChip), Some(Way::ToVehicle)];
        // A setup takes two frames, a mission of ten steps 24 more.
        let after = 2 + number / 3 % 20;
        network.borrow_mut().cut = Some((after, ways[(number % 3) as usize]));
        let flown = fly(&mut chip, &setup);
        assert!(
            matches!(flown, Err(LinkLost::Silent)),
            "mission {number}, cut after {after}: {flown:?}"
        );
        let Network { now, player, .. } = &*network.borrow();
        // Until the cut no virtual time passes.
        assert_eq!(*now, bound, "mission {number}");
        // Requests are the odd frames; Hello and Ready come before the first motion.
        let heard = match ways[(number % 3) as usize] {
            None | Some(Way::ToVehicle) => after.div_ceil(2),
            Some(Way::ToChip) => after / 2 + 1,
        };
        assert_eq!(player.motions() as u64, heard.saturating_sub(2), "mission {number}");
    });
}

#[test]
fn a_chip_declines_what_it_has_no_room_for_and_says_how_much_it_has() {
    let mut long = mission(1);
    long.steps = 60;
    let network = RefCell::new(Network::new(&long, Faults::default()));
    let mut chip = chip(&network);
    let setup = chip.await_setup();
    let flown = fly(&mut chip, &setup);
    assert!(matches!(flown, Ok(Flown::Declined(Declined::Capacity(_)))), "{flown:?}");
    drop(chip);
    let error = network.into_inner().player.finish().expect_err("it was declined").to_string();
    assert!(error.contains("at most 32") && error.contains("529 hypotheses"), "{error}");
}

/// A vehicle that serves one mission after the other, over a network that it is at the end of.
struct Garage {
    responder: Responder,
    mission: Mission,
    setup: message::Setup,
    robot: Robot,
    pose: Pose,
    /// Motions of the last mission, and whether it has ended.
    motions: usize,
    ended: bool,
}

impl Garage {
    fn new(mission: &Mission, seed: u32) -> Self {
        Self {
            responder: Responder::new(seed),
            mission: mission.clone(),
            setup: player::setup(mission, LabelSource::Vehicle).expect("a mission for a chip"),
            robot: mission.robot(),
            pose: mission.start,
            motions: 0,
            ended: false,
        }
    }

    fn hear(&mut self, byte: u8) -> Option<Frame> {
        let request = match self.responder.hear(byte)? {
            Heard::Old(frame) => return Some(frame),
            Heard::Hello(hello) => return Some(self.responder.offer(hello, self.setup.clone())),
            Heard::New(request) => request,
        };
        let reply = match request {
            Request::Ready(_) => {
                (self.robot, self.pose) = (self.mission.robot(), self.mission.start);
                (self.motions, self.ended) = (0, false);
                Reply::Noted
            }
            Request::Move(message::Move { motion, .. }) => {
                self.motions += 1;
                let Ok(reading) = self.robot.perform(&motion, &mut self.pose);
                Reply::Arrived { pose: self.pose, reading }
            }
            Request::End(_) => {
                self.ended = true;
                Reply::Noted
            }
            other => panic!("{other:?}"),
        };
        Some(self.responder.answer(reply).clone())
    }
}

/// Which ends restart, just before a chip's so-many-th request is sent.
#[derive(Clone, Copy, Debug)]
struct Restart {
    at: usize,
    chip: bool,
    vehicle: bool,
}

/// A network in virtual time between chips and a garage, of which one or both restart.
struct Yard {
    now: Duration,
    /// When the chip's wait is over.
    until: Duration,
    under_way: BTreeMap<(Duration, u64), (Way, Vec<u8>)>,
    launched: u64,
    spoilers: [Spoiler; 2],
    arrived: VecDeque<u8>,
    garage: Garage,
    restart: Option<Restart>,
    /// The chip's last request, and how many came before it: since the restart, once that was.
    last: Vec<u8>,
    asked: usize,
    /// When that was.
    restarted: Duration,
    /// Requests and time from there until the next mission began.
    flown_after: Option<(usize, Duration)>,
}

/// The chip's power failed.
struct Off;

impl Yard {
    fn new(mission: &Mission, faults: Faults, seed: u64, restart: Restart) -> Self {
        Self {
            now: Duration::ZERO,
            until: Duration::ZERO,
            under_way: BTreeMap::new(),
            launched: 0,
            spoilers: [0, 1].map(|way| Spoiler::new(faults, seed, way)),
            arrived: VecDeque::new(),
            garage: Garage::new(mission, 1),
            restart: Some(restart),
            last: Vec::new(),
            asked: 0,
            restarted: Duration::ZERO,
            flown_after: None,
        }
    }

    fn launch(&mut self, way: Way, frame: &[u8]) {
        for (late, bytes) in self.spoilers[usize::from(way == Way::ToChip)].spoil(frame) {
            self.launched += 1;
            self.under_way.insert((self.now + late, self.launched), (way, bytes));
        }
    }

    /// What the chip sends; its power may fail instead.
    fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
        if frame != self.last {
            (self.last, self.asked) = (frame.to_vec(), self.asked + 1);
        }
        if let Some(Restart { chip, vehicle, .. }) = self.restart.take_if(|it| it.at == self.asked)
        {
            (self.asked, self.restarted) = (0, self.now);
            if vehicle {
                self.garage = Garage::new(&self.garage.mission, 77_777);
            }
            if chip {
                self.last.clear();
                self.arrived.clear();
                return Err(Off);
            }
        }
        // It flies when it asks for a motion of a mission, other than the one that was broken off.
        let mut decoder = Decoder::default();
        let asks = |byte| decoder.feed::<Request>(byte).map(|it| it.message);
        let flies = matches!(frame.iter().copied().find_map(asks), Some(Request::Move(_)));
        if self.restart.is_none() && flies && self.asked > 0 && self.flown_after.is_none() {
            let since = self.now.saturating_sub(self.restarted);
            self.flown_after = Some((self.asked - 1, since));
        }
        self.until = self.now + WAIT;
        self.launch(Way::ToVehicle, frame);
        Ok(())
    }

    fn receive(&mut self) -> Option<u8> {
        loop {
            if let Some(byte) = self.arrived.pop_front() {
                return Some(byte);
            }
            let until = self.until;
            let Some(due) = self.under_way.first_entry().filter(|it| it.key().0 < until) else {
                self.now = until;
                return None;
            };
            let ((at, _), (way, bytes)) = due.remove_entry();
            self.now = self.now.max(at);
            if way == Way::ToChip {
                self.arrived.extend(bytes);
                continue;
            }
            for byte in bytes {
                if let Some(frame) = self.garage.hear(byte) {
                    self.launch(Way::ToChip, frame.bytes());
                }
            }
        }
    }
}

/// The chip's end of a yard.
#[derive(Clone, Copy)]
struct Socket<'a>(&'a RefCell<Yard>);

impl Port for Socket<'_> {
    fn send(&mut self, frame: &[u8]) {
        let sent = self.0.borrow_mut().send(frame);
        if let Err(off) = sent {
            panic::resume_unwind(Box::new(off));
        }
    }

    fn receive(&mut self) -> Option<u8> {
        self.0.borrow_mut().receive()
    }
}

/// A chip from its start: it flies missions until one ends as it should, or its power fails.
fn run(yard: &RefCell<Yard>) -> Result<(), Off> {
    let clock = ClockRate { per_second: 1, emulated: false };
    let ended = panic::catch_unwind(AssertUnwindSafe(|| {
        let link = Link::new(Socket(yard));
        let mut chip = Station { link, sensor: None::<Infallible>, ticks: || 0, clock };
        loop {
            let setup = chip.await_setup();
            if matches!(fly(&mut chip, &setup), Ok(Flown::Ended(_))) {
                break;
            }
        }
    }));
    ended.map_err(|cause| match cause.downcast::<Off>() {
        Ok(off) => *off,
        Err(other) => panic::resume_unwind(other),
    })
}

/// Restarts one end or both at each request of a mission: for each, the requests and the time until the
/// next mission flew.
fn restarts(number: u64, faults: Faults) -> Vec<(usize, Duration)> {
    let mission = mission(number);
    let motions = Recording::of(&mission).expect("trusted labels are true").steps.len();
    let mut all = Vec::new();
    // A hello, the acceptance, each motion and the end.
    for at in 1..=motions + 3 {
        for (chip, vehicle) in [(true, false), (false, true), (true, true)] {
            let restart = Restart { at, chip, vehicle };
            let context = format!("mission {number}: {restart:?}");
            let seed = number * 1_000 + at as u64;
            let yard = RefCell::new(Yard::new(&mission, faults, seed, restart));
            let off = run(&yard).is_err();
            assert_eq!(off, chip, "{context}");
            if off {
                assert!(run(&yard).is_ok(), "{context}");
            }
            let Yard { garage, flown_after, .. } = yard.into_inner();
            assert!(garage.ended && garage.motions == motions, "{context}");
            all.push(flown_after.unwrap_or_else(|| panic!("{context}: it never flew again")));
        }
    }
    all
}

#[test]
fn whichever_end_restarts_the_next_mission_flies_within_two_exchanges() {
    for number in 0..8 {
        for (requests, time) in restarts(number, Faults::default()) {
            assert!(requests <= 2 && time.is_zero(), "mission {number}: {requests}, {time:?}");
        }
    }
}

#[test]
fn over_a_bad_link_too() {
    let faults: Faults =
        "drop=0.1,cut=0.02,corrupt=0.05,duplicate=0.1,delay=20ms".parse().expect("faults");
    let all: Vec<_> = (0..100).into_par_iter().flat_map_iter(|it| restarts(it, faults)).collect();
    let more = all.iter().filter(|(requests, _)| *requests > 2).count();
    let longest = all.iter().map(|(_, time)| *time).max();
    println!(
        "{} restarts; the next mission flew within {longest:?}; {more} took more than two requests",
        all.len()
    );
    // A frame of before the restart that comes late can cost a request; so often it is.
    assert!(more * 100 < all.len() && all.iter().all(|(requests, _)| *requests <= 4), "{more}");
    assert!(longest < Some(Duration::from_secs(2)));
}

/// A player and what a chip of our own says to it.
struct Liar {
    player: Player,
    link: (u32, u32),
}

impl Liar {
    fn new(mission: &Mission) -> Self {
        let player = Player::new(mission, LabelSource::Vehicle, 1).expect("a mission for a chip");
        let mut liar = Self { player, link: (0, 0) };
        liar.says(Request::Hello { protocol: PROTOCOL }).expect("it offers a mission");
        let capacity = Capacity { samples: 68, hypotheses: 1 };
        let clock = ClockRate { per_second: 1, emulated: false };
        liar.says(Request::Ready(message::Accepted { capacity, clock })).expect("it takes note");
        liar
    }

    fn says(&mut self, request: Request) -> anyhow::Result<Reply> {
        self.link.1 += 1;
        let frame = Frame::of(&Envelope::new(self.link.0, self.link.1, request));
        let mut decoder = Decoder::default();
        for byte in frame.bytes() {
            let Some(answer) = self.player.hear(*byte)? else { continue };
            let envelope = answer.bytes().iter().find_map(|byte| decoder.feed::<Reply>(*byte));
            let envelope = envelope.expect("a whole frame");
            self.link.0 = envelope.session;
            return Ok(envelope.message);
        }
        panic!("no answer");
    }
}

#[test]
fn a_player_finds_out_a_chip_that_took_in_another_reading() {
    let mission = mission(0);
    let took = message::Took::default();
    let steps = Recording::of(&mission).expect("labels are true").steps;
    let motion = |n: usize| steps[n].motion;
    let mut liar = Liar::new(&mission);
    let reply = liar.says(Request::Move(message::Move { motion: motion(0), last: None, took }));
    let Ok(Reply::Arrived { reading: Some(Reading::Side(sensed)), .. }) = reply else {
        panic!("{reply:?}")
    };
    for last in [None, Some(Reading::Boundary), Some((-sensed).into())] {
        let mut liar = Liar::new(&mission);
        let moved = liar.says(Request::Move(message::Move { motion: motion(0), last: None, took }));
        assert!(moved.is_ok());
        let lie = liar.says(Request::Move(message::Move { motion: motion(1), last, took }));
        let error = lie.expect_err("it was found out").to_string();
        assert!(error.contains("step 1: sensed"), "{error}");
    }
    let last = Some(sensed.into());
    assert!(liar.says(Request::Move(message::Move { motion: motion(1), last, took })).is_ok());
}

#[test]
fn a_player_compares_every_estimate_to_the_last_bit() {
    let mission = mission(0);
    let right = mission.given.estimates();
    let end = |estimates| {
        let (last, took) = (None, message::Took::default());
        Request::End(message::MissionEnd {
            reason: message::EndReason::Steps,
            last,
            took,
            estimates,
        })
    };
    let judge = |estimates| {
        let mut liar = Liar::new(&mission);
        assert!(matches!(liar.says(end(estimates)), Ok(Reply::Noted)));
        liar.player.finish().map(drop).map_err(|error| error.to_string())
    };
    assert_eq!(judge(right), Ok(()));
    let [a, b, c] = right.centre.expect("a line").coefficients();
    let near = Line::from_coefficients(a, b, f64::from_bits(c.to_bits() + 1));
    for (wrong, name) in [
        (Estimates { bisector: None, ..right }, "the bisector"),
        (Estimates { centre: near, ..right }, "the centre"),
        (Estimates { maximum_margin: right.bisector, ..right }, "the maximum margin"),
    ] {
        let error = judge(wrong).expect_err("it was found out");
        assert!(error.starts_with(name), "{error}");
    }
}

#[test]
fn a_vehicle_that_takes_its_time_is_waited_for() {
    /// Says that it is busy so many times before it answers.
    struct Slow {
        garage: Garage,
        busy: u32,
        arriving: VecDeque<u8>,
        begun: u32,
    }
    impl Port for &mut Slow {
        fn send(&mut self, frame: &[u8]) {
            let slow = &mut **self;
            for byte in frame {
                match slow.garage.responder.hear(*byte) {
                    Some(Heard::Hello(hello)) => {
                        let setup = slow.garage.setup.clone();
                        slow.arriving.extend(slow.garage.responder.offer(hello, setup).bytes());
                    }
                    Some(Heard::New(_)) => slow.begun += 1,
                    Some(Heard::Old(frame)) => slow.arriving.extend(frame.bytes()),
                    None => {}
                }
            }
            slow.busy = slow.busy.saturating_sub(1);
            if slow.busy == 0 {
                slow.arriving.extend(slow.garage.responder.answer(Reply::Noted).bytes());
            }
        }

        fn receive(&mut self) -> Option<u8> {
            self.arriving.pop_front()
        }
    }
    let garage = Garage::new(&mission(0), 1);
    let mut slow = Slow { garage, busy: 1000, arriving: VecDeque::new(), begun: 0 };
    let mut link = Link::new(&mut slow);
    let hello = link.ask(Request::Hello { protocol: PROTOCOL });
    assert!(matches!(hello, Ok(Reply::Setup(_))));
    let declined = Request::Declined(Declined::Algorithm);
    assert_eq!(link.ask(declined), Ok(Reply::Noted));
    assert_eq!((slow.begun, slow.busy), (1, 0));
}

/// Frames of every message, of missions with all that makes messages long.
fn corpus() -> Vec<Vec<u8>> {
    /// Hears what passes.
    struct Tap<'a>(Plug<'a>, &'a RefCell<Vec<Vec<u8>>>);
    impl Port for Tap<'_> {
        fn send(&mut self, frame: &[u8]) {
            self.1.borrow_mut().push(frame.to_vec());
            self.0.send(frame);
        }

        fn receive(&mut self) -> Option<u8> {
            let arrived = self.0.receive()?;
            let mut frames = self.1.borrow_mut();
            match frames.last_mut() {
                Some(last) if last.len() < 2 || last.last() != Some(&0) => last.push(arrived),
                _ => frames.push(vec![arrived]),
            }
            Some(arrived)
        }
    }
    let frames = RefCell::new(Vec::new());
    for number in 0..20 {
        let mission = mission(number);
        let network = RefCell::new(Network::new(&mission, Faults::default()));
        let clock = ClockRate { per_second: 168_000_000, emulated: true };
        let link = Link::new(Tap(Plug(&network), &frames));
        let mut chip = Station::<_, Infallible> { link, sensor: None, ticks: || 77, clock };
        let setup = chip.await_setup();
        assert!(fly(&mut chip, &setup).is_ok());
    }
    let mut frames = frames.into_inner();
    // What no good mission says.
    let capacity = Capacity { samples: 36, hypotheses: 529 };
    for declined in [
        Declined::Protocol(PROTOCOL),
        Declined::Algorithm,
        Declined::Capacity(capacity),
        Declined::Given(NoVersionSpace::NotSeparable(3)),
        Declined::Labels,
    ] {
        frames.push(Frame::of(&Envelope::new(5, 6, Request::Declined(declined))).bytes().to_vec());
    }
    for reply in [Reply::Failed, Reply::Busy, Reply::Stale] {
        frames.push(Frame::of(&Envelope::new(5, u32::MAX, reply)).bytes().to_vec());
    }
    frames
}

/// The kinds of message that there are, by the byte that tells them apart.
fn kinds(frames: &[Vec<u8>]) -> [BTreeSet<String>; 2] {
    fn kind<M: Message + Debug>(frame: &[u8]) -> Option<String> {
        let mut decoder = Decoder::default();
        let envelope = frame.iter().find_map(|byte| decoder.feed::<M>(*byte))?;
        let debug = format!("{:?}", envelope.message);
        Some(debug.split([' ', '(']).next().expect("a name").to_owned())
    }
    [
        frames.iter().filter_map(|it| kind::<Request>(it)).collect(),
        frames.iter().filter_map(|it| kind::<Reply>(it)).collect(),
    ]
}

fn decode<M: Message>(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut decoder = Decoder::default();
    let envelopes = bytes.iter().filter_map(|byte| decoder.feed::<M>(*byte));
    envelopes.map(|envelope: Envelope<M>| Frame::of(&envelope).bytes().to_vec()).collect()
}

/// Every message that either side makes of these bytes, as frames.
fn accepted(bytes: &[u8]) -> Vec<Vec<u8>> {
    [decode::<Request>(bytes), decode::<Reply>(bytes)].concat()
}

/// A reply that this version does not know.
#[derive(Debug, Serialize, Deserialize)]
struct Unknown(u8);

impl Message for Unknown {
    const WAY: u8 = Reply::WAY;
}

#[test]
fn a_decoder_takes_what_was_sent_and_nothing_else() {
    let corpus = corpus();
    let [requests, replies] = kinds(&corpus);
    assert!(requests.iter().eq(["Declined", "End", "Hello", "Move", "Ready"]), "{requests:?}");
    let all = ["Arrived", "Busy", "Failed", "Noted", "Setup", "Stale"];
    assert!(replies.iter().eq(all), "{replies:?}");
    let longest = corpus.iter().map(Vec::len).max();
    for frame in &corpus {
        assert_eq!(accepted(frame), std::slice::from_ref(frame), "a frame is one message, one way");
    }
    let sent: BTreeSet<_> = corpus.iter().cloned().collect();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let (mut fed, mut taken) = (0, 0);
    while fed < 20_000_000 {
        let mut bytes: Vec<u8> = Vec::new();
        if rng.random_range(0..4) == 0 {
            // Noise; zeros are frequent enough to end many a frame.
            let zeros = rng.random_range(1..64);
            let noise = |rng: &mut ChaCha8Rng| {
                if rng.random_range(0..zeros) == 0 { 0 } else { rng.random_range(0..=255u8) }
            };
            bytes.extend((0..rng.random_range(0..1000)).map(|_| noise(&mut rng)));
        }
        let mut untouched = Vec::new();
        for _ in 0..rng.random_range(1..4) {
            let mut frame = corpus[rng.random_range(0..corpus.len())].clone();
            let (at, other) = (rng.random_range(0..frame.len()), rng.random_range(0..frame.len()));
            match rng.random_range(0..8) {
                0 => frame[at] ^= 1 << rng.random_range(0..8),
                1 => frame[at] = rng.random_range(0..=255),
                2 => frame.truncate(at),
                3 => drop(frame.drain(..at)),
                4 => frame.insert(at, rng.random_range(0..=255)),
                5 => drop(frame.remove(at)),
                6 => frame.swap(at, other),
                _ => untouched.push(frame.clone()),
            }
            bytes.extend(frame);
        }
        fed += bytes.len();
        let heard = accepted(&bytes);
        taken += heard.len();
        for frame in &heard {
            assert!(sent.contains(frame), "seed {SEED}: {frame:?} was never sent, in {bytes:?}");
        }
        for frame in untouched {
            assert!(heard.contains(&frame), "seed {SEED}: {frame:?} was passed over in {bytes:?}");
        }
    }
    // A whole frame of no message is counted; half a frame, noise and one's own echo are not.
    let mut decoder = Decoder::default();
    let mut hear = |bytes: &[u8]| bytes.iter().filter_map(|b| decoder.feed::<Reply>(*b)).count();
    let hello = Frame::of(&Envelope::new(0, 1, Request::Hello { protocol: PROTOCOL }));
    let unknown = Frame::of(&Envelope::new(0, 1, Unknown(200)));
    assert_eq!(
        [hello.bytes(), &unknown.bytes()[..4], &[0], unknown.bytes()].map(&mut hear),
        [0; 4]
    );
    assert_eq!(decoder.unreadable(), 1);
    println!("{fed} bytes fed, {taken} whole frames found; the longest is {longest:?} bytes");
    assert!(taken > 1000 && longest <= Some(FRAME));
}
