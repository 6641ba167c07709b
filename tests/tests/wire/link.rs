//! The link: missions over one that loses, cuts, spoils, doubles and delays frames, and a decoder fed with garbage.
//!
//! Chip and vehicle run here in one thread and in virtual time. So a thousand missions with all their waits take
//! seconds, and each gives the same result in every run.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt::Debug;

use host_sim::campaign::standard_field;
use host_sim::hil::faults::Faults;
use host_sim::hil::player::Player;
use host_sim::hil::setup;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::report::trace;
use planner_core::error::{GivenError, GridError, RoomError, ShapeError};
use planner_core::link::delivery::{Link, LinkError};
use planner_core::link::frame::{Decoder, Envelope, FRAME, Frame, Message};
use planner_core::link::message::{
    Capacity, ClockRate, DeclinedError, EndReason, LabelSource, MissionArea, Outline, PROTOCOL,
    Reply, Request, Settings, Setup,
};
use planner_core::link::station::{AllLabels, Flown, NoTerms, Tracks};
use planner_core::motion::any_vehicle::Shape;
use planner_core::motion::car;
use planner_core::{AnyVehicle, Area, KeepOut, Site, StopReason, Unicycle};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tests::chip::{self, Chip, FarEnd, Off, Socket, fly};
use tests::fronts::following;
use tests::missions::{SEED, mission, of_any_vehicle, reading, stopping};
use tests::wire::{WAIT, Way, Wire};

/// A wire with the vehicle at its other end.
struct Network {
    wire: Wire,
    player: Player,
    failure: Option<String>,
    frames_of_chip: u64,
}

impl Network {
    fn new(mission: &Mission, faults: Faults) -> Self {
        Self {
            wire: Wire::new(faults, mission.seed),
            player: Player::new(mission, LabelSource::Vehicle, 1).expect("a mission for a chip"),
            failure: None,
            frames_of_chip: 0,
        }
    }
}

impl FarEnd for Network {
    fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
        self.frames_of_chip += 1;
        self.wire.ask(frame);
        Ok(())
    }

    fn receive(&mut self) -> Option<u8> {
        let Self { wire, player, failure, .. } = self;
        wire.answer(|byte| {
            player.hear(byte).unwrap_or_else(|error| {
                *failure = Some(error.to_string());
                None
            })
        })
    }
}

fn chip(network: &RefCell<Network>) -> Chip<'_> {
    chip::chip(network, None)
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

/// Missions of fronts too: no label counts twice, and no vertex of the map is lost.
#[test]
fn a_front_is_followed_over_a_bad_link_as_over_a_good_one() {
    let faults: Faults =
        "drop=0.1,cut=0.02,corrupt=0.05,duplicate=0.1,delay=20ms".parse().expect("faults");
    let vertices: usize = (0..40)
        .into_par_iter()
        .map(|number| {
            let mission = following(9, number, 40);
            let mut mission = if number / 4 % 2 == 0 { mission } else { reading(mission) };
            // Some watch a stretch.
            mission.watch = number.is_multiple_of(5).then_some(12.3);
            let network = RefCell::new(Network::new(&mission, faults));
            let mut chip = chip(&network);
            let setup = chip.await_setup();
            let flown = fly(&mut chip, &setup);
            assert!(matches!(flown, Ok(Flown::Ended(_))), "mission {number}: {flown:?}");
            drop(chip);
            let Network { player, failure, .. } = network.into_inner();
            assert!(failure.is_none(), "mission {number}: {failure:?}");
            let there = player.finish().expect("the mission is over").recording.results;
            let here = Recording::of(&mission).expect("no label contradicts a front").results;
            assert_eq!(trace::lines(&there), trace::lines(&here), "mission {number}");
            here.steps.iter().filter(|it| it.front.is_some()).count()
        })
        .sum();
    println!("{vertices} vertices in 40 missions");
    assert!(vertices > 800);
}

/// A chip without the follower declines it, and the message names it.
#[test]
fn a_chip_without_a_follower_of_fronts_says_so() {
    let mission = following(9, 0, 10);
    let network = RefCell::new(Network::new(&mission, Faults::default()));
    let mut chip = chip(&network);
    let setup = chip.await_setup();
    let flown = chip.fly_with::<AllLabels<68, 36, 529>, Unicycle, Area>(&setup, &mut ());
    assert!(matches!(flown, Ok(Flown::Declined(DeclinedError::Algorithm))), "{flown:?}");
    drop(chip);
    let error = network.into_inner().player.finish().expect_err("it was declined").to_string();
    assert!(error.contains("algorithm: found track") && error.contains("declined"), "{error}");

    let network =
        RefCell::new(Network::new(&Mission { watch: Some(12.3), ..mission }, Faults::default()));
    let mut chip = self::chip(&network);
    let setup = chip.await_setup();
    let flown = chip.fly_with::<Tracks<16, 16, 3>, Unicycle, Area>(&setup, &mut ());
    assert!(matches!(flown, Ok(Flown::Declined(DeclinedError::Algorithm))), "{flown:?}");
    drop(chip);
    let error = network.into_inner().player.finish().expect_err("it was declined").to_string();
    assert!(error.contains("front.watch: found 12.3 m, declined"), "{error}");
}

/// What errs is the vehicle, so a chip is told what it would be told here.
#[test]
fn every_vehicle_flies_over_the_link_as_here_and_so_do_robots_that_err() {
    let ends: Vec<_> = (0..240)
        .into_par_iter()
        .map(|number| {
            let mission = of_any_vehicle(number, 10);
            let network = RefCell::new(Network::new(&mission, Faults::default()));
            let mut chip = chip(&network);
            let setup = chip.await_setup();
            let flown = fly(&mut chip, &setup);
            assert!(matches!(flown, Ok(Flown::Ended(_))), "mission {number}: {flown:?}");
            drop(chip);
            let there = network.into_inner().player.finish().expect("the mission is over");
            let there = trace::lines(&there.recording.results);
            let here = Recording::of(&mission).expect("labels that are certain are true");
            assert_eq!(there, trace::lines(&here.results), "mission {number}");
            let errs = number / 4 % 2 == 1 && !here.steps.is_empty();
            assert_eq!(there.contains("\"true_pose\""), errs, "mission {number}");
            here.results.end.reason
        })
        .collect();
    let by_steps = ends.iter().filter(|reason| **reason == "steps").count();
    println!("{by_steps} of {} missions ended by their steps", ends.len());
    assert!(by_steps > 200);
}

/// What a chip is asked to fly with and does not have: it says why, and asks for the next mission.
#[test]
fn a_chip_declines_what_is_no_vehicle_of_its_own() {
    let mission = of_any_vehicle(2, 10);
    let good = setup::setup(&mission, LabelSource::Vehicle).expect("a mission for a chip");
    let Shape::Car(shape) = good.vehicle else { panic!("{:?}", good.vehicle) };
    let car = |shape| Setup { vehicle: Shape::Car(shape), ..good.clone() };
    let no_car = car(car::Shape { radius_mm: 0, ..shape });
    let wide = car(car::Shape { radius_mm: 12_000, ..shape });
    let later = Setup { protocol: PROTOCOL + 1, ..good.clone() };
    let by_any = |setup: &Setup| {
        let terms = setup.terms::<AnyVehicle, _>(setup.config.area);
        terms.map(|terms| Shape::from(terms.dynamics))
    };
    assert_eq!(by_any(&good), Ok(good.vehicle));
    let by_unicycle = |setup: &Setup| setup.terms::<Unicycle, _>(setup.config.area).map(drop);
    assert_eq!(by_unicycle(&good), Err(DeclinedError::Vehicle(ShapeError::Kind)));
    assert_eq!(by_any(&no_car), Err(DeclinedError::Vehicle(ShapeError::Grid(GridError::Circle))));
    assert!(matches!(by_any(&wide), Err(DeclinedError::Vehicle(ShapeError::Room(_)))));
    assert_eq!(by_any(&later), Err(DeclinedError::Protocol(PROTOCOL)));

    let network = RefCell::new(Network::new(&mission, Faults::default()));
    let mut chip = chip(&network);
    let setup = chip.await_setup();
    let declined = by_unicycle(&setup).expect_err("it has no car");
    assert!(matches!(chip.decline(declined), Ok(Flown::Declined(_))));
    drop(chip);
    let error = network.into_inner().player.finish().expect_err("it was declined").to_string();
    assert!(error.contains("vehicle") && error.contains("of this kind"), "{error}");
}

/// A chip that knows rectangles alone says so; one that knows more is told all of the area, and outlines of no area are
/// declined.
#[test]
fn a_chip_plans_in_the_area_that_it_was_told_or_declines_it() {
    let mission = of_any_vehicle(0, 10);
    assert!(mission.config.area.hulls().count() > 0);
    let network = RefCell::new(Network::new(&mission, Faults::default()));
    let mut chip = chip(&network);
    let setup = chip.await_setup();
    let terms = chip.terms::<AnyVehicle, MissionArea>(&setup).expect("it has room");
    assert_eq!(terms.area, mission.config.area);
    let more = Setup { keep_outs: setup.keep_outs.map(|count| count - 1), ..setup.clone() };
    let fewer = chip.terms::<AnyVehicle, MissionArea>(&more).expect("an area too");
    assert_ne!(fewer.area, mission.config.area);
    let elsewhere = standard_field::area().inset(1).expect("nearly all of it");
    let config = Settings { area: elsewhere, ..setup.config };
    let wrong = chip.terms::<AnyVehicle, MissionArea>(&Setup { config, ..setup.clone() });
    assert_eq!(
        wrong.err(),
        Some(NoTerms::Declined(DeclinedError::Area)),
        "not that polygon's rectangle"
    );
    let none = chip.terms::<AnyVehicle, Area>(&setup).expect_err("it is more than a rectangle");
    assert_eq!(none, NoTerms::Declined(DeclinedError::Area));
    assert!(matches!(chip.give_up(none), Ok(Flown::Declined(DeclinedError::Area))));
    drop(chip);
    let error = network.into_inner().player.finish().expect_err("it was declined").to_string();
    assert!(error.contains("area") && error.contains("declined"), "{error}");
}

#[test]
fn outlines_of_no_polygon_are_refused() {
    let site = |x, z| Site::new(x, z).expect("near");
    let outline =
        |corners: &[Site]| Outline { corners: corners.iter().copied().collect(), radius: 3 };
    let triangle = outline(&[site(0, 0), site(9, 0), site(0, 9)]);
    let hull = KeepOut::try_from(triangle.clone()).expect("a triangle");
    assert_eq!(Outline::from(&hull), triangle);
    for bad in [&[][..], &[site(0, 0), site(9, 0), site(2, 2), site(0, 9)]] {
        assert!(KeepOut::try_from(outline(bad)).is_err(), "{bad:?}");
    }
}

#[test]
fn a_cut_link_ends_every_mission_within_the_bound_and_with_no_motion_after_it() {
    let bound = WAIT * u32::from(Link::<Socket<'_>>::ATTEMPTS);
    (0..1000u64).into_par_iter().for_each(|number| {
        let mission = mission(number);
        let network = RefCell::new(Network::new(&mission, Faults::default()));
        let mut chip = chip(&network);
        let setup = chip.await_setup();
        let ways = [None, Some(Way::ToChip), Some(Way::ToVehicle)];
        // A setup takes two frames, a mission of ten steps 24 more.
        let after = 2 + number / 3 % 20;
        network.borrow_mut().wire.cut = Some((after, ways[(number % 3) as usize]));
        let flown = fly(&mut chip, &setup);
        assert!(
            matches!(flown, Err(LinkError::Silent)),
            "mission {number}, cut after {after}: {flown:?}"
        );
        let Network { wire: Wire { now, .. }, player, .. } = &*network.borrow();
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

/// The chip has the goal from the link, and ends at the step at which the host does.
#[test]
fn a_mission_ends_on_the_chip_when_enough_is_known_as_it_does_here() {
    let endings: Vec<_> = (0..80u64)
        .into_par_iter()
        .map(|number| {
            let mission = stopping(number);
            let network = RefCell::new(Network::new(&mission, Faults::default()));
            let mut chip = chip(&network);
            let setup = chip.await_setup();
            let flown = fly(&mut chip, &setup);
            let Ok(Flown::Ended(end)) = flown else { panic!("mission {number}: {flown:?}") };
            drop(chip);
            let here = Recording::of(&mission).expect("labels that are certain are true");
            let there = network.into_inner().player.finish().expect("the mission is over");
            assert_eq!(
                trace::lines(&there.recording.results),
                trace::lines(&here.results),
                "mission {number}"
            );
            let is_known = end.reason == EndReason::Stopped(StopReason::Known);
            assert_eq!(is_known, here.results.end.reason == "known", "mission {number}");
            assert_eq!(is_known, here.steps.len() < mission.steps as usize, "mission {number}");
            (number % 4, is_known)
        })
        .collect();
    for kind in 0..4 {
        let known = endings.iter().filter(|it| **it == (kind, true)).count();
        println!("kind {kind}: {known} of 20 missions ended as the line was known");
        assert!(known >= 5, "kind {kind}: {known}");
    }
    assert!(endings.iter().any(|(_, is_known)| !is_known), "some end by their steps");
}

#[test]
fn a_chip_declines_what_it_has_no_room_for_and_says_how_much_it_has() {
    let mut long = mission(1);
    long.steps = 60;
    let network = RefCell::new(Network::new(&long, Faults::default()));
    let mut chip = chip(&network);
    let setup = chip.await_setup();
    let flown = fly(&mut chip, &setup);
    assert!(matches!(flown, Ok(Flown::Declined(DeclinedError::Capacity(_)))), "{flown:?}");
    drop(chip);
    let error = network.into_inner().player.finish().expect_err("it was declined").to_string();
    assert!(error.contains("at most 32") && error.contains("529 hypotheses"), "{error}");
}

/// Frames of every message, of missions with all that makes messages long.
fn corpus() -> Vec<Vec<u8>> {
    /// Hears what passes.
    struct Tap(Network, Vec<Vec<u8>>);
    impl FarEnd for Tap {
        fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
            self.1.push(frame.to_vec());
            self.0.send(frame)
        }

        fn receive(&mut self) -> Option<u8> {
            let arrived = self.0.receive()?;
            match self.1.last_mut() {
                Some(last) if last.len() < 2 || last.last() != Some(&0) => last.push(arrived),
                _ => self.1.push(vec![arrived]),
            }
            Some(arrived)
        }
    }
    let mut frames = Vec::new();
    let missions = (0..20).map(mission).chain((0..6).map(|number| of_any_vehicle(number, 6)));
    let missions = missions.chain((0..4).map(|number| following(8, number, 30)));
    for mission in missions.chain([mission(0), mission(3)].map(reading)) {
        let tap = RefCell::new(Tap(Network::new(&mission, Faults::default()), Vec::new()));
        let clock = ClockRate { per_second: 168_000_000, emulated: true };
        let mut chip = Chip { ticks: || 77, clock, ..chip::chip(&tap, None) };
        let setup = chip.await_setup();
        assert!(fly(&mut chip, &setup).is_ok());
        drop(chip);
        frames.extend(tap.into_inner().1);
    }
    // What no good mission says.
    let capacity = Capacity { samples: 36, hypotheses: 529 };
    for declined in [
        DeclinedError::Protocol(PROTOCOL),
        DeclinedError::Algorithm,
        DeclinedError::Capacity(capacity),
        DeclinedError::Given(GivenError::NotSeparable(3)),
        DeclinedError::Labels,
        DeclinedError::Vehicle(ShapeError::Room(RoomError { across_mm: u32::MAX })),
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
    assert!(
        requests
            .iter()
            .eq(["Declined", "End", "Front", "Hello", "Move", "Onward", "Outline", "Ready"]),
        "{requests:?}"
    );
    let all = ["Arrived", "Busy", "Failed", "Noted", "OnTheWay", "Outline", "Setup", "Stale"];
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
