//! The link: missions over one that loses, cuts, spoils, doubles and delays frames, and a decoder fed with garbage.
//!
//! Chip and vehicle run here in one thread and in virtual time. So a thousand missions with all their waits take
//! seconds, and each gives the same result in every run.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt::Debug;

use host_sim::campaign::standard_field;
use host_sim::hil::faults::Faults;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::mission::trace;
use host_sim::world::errors::Errors;
use planner_core::CarShape;
use planner_core::VehicleShape;
use planner_core::error::{GivenError, GridError, RoomError, ShapeError};
use planner_core::link::delivery::{Link, LinkError};
use planner_core::link::frame::{Decoder, Envelope, FRAME, Frame, Message};
use planner_core::link::message::{
    Capacity, ClockRate, DeclinedError, EndReason, LabelSource, MissionArea, Outline, PROTOCOL,
    Reply, Request, Settings, Setup,
};
use planner_core::link::station::{AllLabels, Flown, NoTerms, Tracks};
use planner_core::{AnySight, AnyVehicle, Area, KeepOut, Site, StopReason, Unicycle};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tests::cases;
use tests::chip::{self, Chip, FarEnd, Network, Off, Socket, fly, offered};
use tests::fronts::following;
use tests::missions::{SEED, mission, of_any_vehicle, reading, stopping};
use tests::wire::{self, WAIT, Way};

/// What became of some missions.
#[derive(Clone, Copy, Default)]
pub(crate) struct Tally {
    /// Frames beyond those of a good link.
    again: u64,
    /// Labels that were read on the way.
    passed: usize,
    /// Steps after which a front was known.
    fronts: usize,
    /// Missions that ended as the line was known.
    known: usize,
}

/// Flies a mission over a link with faults. Its trace is that of the same mission here: no label counts twice.
pub(crate) fn flies_as_here(mission: &Mission, faults: Faults) -> Tally {
    let network = Network::new(mission, LabelSource::Vehicle, faults);
    let flown = offered(&network, fly);
    let Ok(Flown::Ended(end)) = flown else { panic!("{flown:?}: {mission:?}") };
    let Network { player, failure, frames_of_chip, .. } = network.into_inner();
    assert_eq!(failure, None, "{mission:?}");
    let here = Recording::of(mission).expect("labels that are certain are true");
    assert_eq!(player.motions(), here.steps.len(), "motions made: {mission:?}");
    let there = player.finish().expect("the mission is over").recording.results;
    let trace = trace::lines(&there);
    assert_eq!(trace, trace::lines(&here.results), "{mission:?}");
    // What errs is the vehicle, so a chip is told what it would be told here.
    let errs = mission.errors != Errors::default() && !there.steps.is_empty();
    assert_eq!(trace.contains("\"true_pose\""), errs, "{mission:?}");
    let is_known = end.reason == EndReason::Stopped(StopReason::Known);
    assert_eq!(is_known, here.results.end.reason == "known", "{mission:?}");
    let passed = there.steps.iter().map(|step| step.passed().count()).sum();
    let frames = 3 + (there.steps.len() + passed) as u64;
    Tally {
        again: frames_of_chip.saturating_sub(frames),
        passed,
        fronts: there.steps.iter().filter(|it| it.front.is_some()).count(),
        known: usize::from(is_known),
    }
}

/// Missions of every planner and vehicle, of robots that err, in polygons with keep-outs, with goals, along fronts; of true
/// labels and of labels that may be wrong, at the ends of motions and on the way.
#[test]
fn missions_over_a_bad_link_end_as_here() {
    let fly = |count: u64, mission: &(dyn Fn(u64) -> Mission + Sync)| {
        let tallies = (0..count).into_par_iter().map(|number| {
            // Nothing is said twice on a good link.
            let faults = if number % 4 == 3 { Faults::default() } else { wire::bad() };
            flies_as_here(&mission(number), faults)
        });
        tallies.reduce(Tally::default, |a, b| Tally {
            again: a.again + b.again,
            passed: a.passed + b.passed,
            fronts: a.fronts + b.fronts,
            known: a.known + b.known,
        })
    };
    let many = cases(120, 1_000);
    assert!(fly(many, &mission).again > many, "the link was not bad");
    let any = cases(60, 240);
    fly(any, &|number| of_any_vehicle(number, 10));
    for kind in 0..4 {
        let count = cases(5, 20);
        let known = fly(count, &|number| stopping(4 * number + kind)).known as u64;
        assert!(4 * known >= count && known <= count, "kind {kind}: {known} of {count}");
    }
    let mut passed = fly(many / 2, &|number| reading(mission(number))).passed;
    passed += fly(any, &|number| reading(of_any_vehicle(number, 10))).passed;
    // The chip has no room for all labels of a long mission in noise.
    passed += fly(10, &|number| reading(stopping(number + number / 2 * 2))).passed;
    assert!(passed as u64 > 8 * many, "{passed}");
    let along_fronts = fly(cases(20, 40), &|number| {
        let mission = following(9, number, 40);
        let mut mission = if number / 4 % 2 == 0 { mission } else { reading(mission) };
        // Some watch a stretch.
        mission.watch = number.is_multiple_of(5).then_some(12.3);
        mission
    });
    assert!(along_fronts.fronts as u64 > cases(400, 800), "{}", along_fronts.fronts);
}

#[test]
fn a_cut_link_ends_every_mission_within_the_bound_and_with_no_motion_after_it() {
    let bound = WAIT * u32::from(Link::<Socket<'_>>::ATTEMPTS);
    (0..cases(120, 1_000)).into_par_iter().for_each(|number| {
        let network = Network::new(&mission(number), LabelSource::Vehicle, Faults::default());
        let way = [None, Some(Way::ToChip), Some(Way::ToVehicle)][(number % 3) as usize];
        // A setup takes two frames, a mission of ten steps 24 more.
        let after = 2 + number / 3 % 20;
        let flown = offered(&network, |chip, setup| {
            network.borrow_mut().wire.cut = Some((after, way));
            fly(chip, setup)
        });
        assert!(matches!(flown, Err(LinkError::Silent)), "mission {number}: {flown:?}");
        let Network { wire, player, .. } = network.into_inner();
        // Until the cut no virtual time passes.
        assert_eq!(wire.now, bound, "mission {number}");
        // Requests are the odd frames; Hello and Ready come before the first motion.
        let heard = if way == Some(Way::ToChip) { after / 2 + 1 } else { after.div_ceil(2) };
        assert_eq!(player.motions() as u64, heard.saturating_sub(2), "mission {number}");
    });
}

/// Knows no fronts, no vehicles but unicycles, no areas but rectangles, and no labels on the way.
fn fly_little(chip: &mut Chip<'_>, setup: &Setup) -> Result<Flown, LinkError> {
    chip.fly_with::<AllLabels<68, 36, 529, AnySight>, Unicycle, Area>(setup, &mut ())
}

/// Follows fronts, but watches no stretch of one.
fn fly_fronts(chip: &mut Chip<'_>, setup: &Setup) -> Result<Flown, LinkError> {
    chip.fly_with::<Tracks, Unicycle, Area>(setup, &mut ())
}

type Fly = fn(&mut Chip<'_>, &Setup) -> Result<Flown, LinkError>;

/// What a chip is asked to fly and cannot: it says why, and so does the player.
#[test]
#[expect(clippy::useless_vec, reason = "missions are too large for an array on the stack")]
fn a_chip_declines_what_it_does_not_have() {
    let capacity = DeclinedError::Capacity(Capacity { samples: 36, hypotheses: 529 });
    let kind = DeclinedError::Vehicle(ShapeError::Kind);
    let mission = mission(0);
    let long = Mission { steps: 60, ..tests::missions::mission(1) };
    let watching = Mission { watch: Some(12.3), ..following(9, 0, 10) };
    let dense = Mission { readings: 5, ..tests::missions::mission(1) };
    for (mission, fly, declined, said) in vec![
        (
            following(9, 0, 10),
            fly_little as Fly,
            Some(DeclinedError::Algorithm),
            "algorithm: found track",
        ),
        (
            watching,
            fly_fronts,
            Some(DeclinedError::Algorithm),
            "front.watch: found 12.3 m, declined",
        ),
        (of_any_vehicle(2, 10), fly_little, Some(kind), "of this kind"),
        (of_any_vehicle(0, 10), fly_little, Some(DeclinedError::Area), "area"),
        (long, fly, Some(capacity), "at most 32"),
        (
            dense,
            fly,
            Some(capacity),
            "readings: found 5 in each of 10 steps, expected at most 32 in all: the board",
        ),
        // It has flown before the player finds out.
        (
            reading(mission),
            fly_little,
            None,
            "readings: found 3, expected 1: the board takes in the label at a motion's end",
        ),
    ] {
        let network = Network::new(&mission, LabelSource::Vehicle, Faults::default());
        let flown = offered(&network, fly);
        let Network { player, failure, .. } = network.into_inner();
        assert_eq!(failure, None, "{said}");
        let error = player.finish().expect_err(said).to_string();
        assert!(error.contains(said), "{said}: {error}");
        match (flown, declined) {
            (Ok(Flown::Declined(got)), Some(declined)) => {
                assert_eq!(got, declined, "{said}");
            }
            (Ok(Flown::Ended(_)), None) => {}
            (other, _) => panic!("{said}: {other:?}"),
        }
    }
}

/// A chip that lacks room for samples alone, or for hypotheses alone, declines too.
#[test]
fn a_chip_declines_what_it_has_no_room_for() {
    let room = Capacity { samples: 36, hypotheses: 529 };
    for (samples, hypotheses, fits) in [(36, 529, true), (37, 1, false), (5, 530, false)] {
        let network = Network::new(&mission(1), LabelSource::Vehicle, Faults::default());
        let flown = offered(&network, |chip, setup| {
            let capacity = Capacity { samples, hypotheses };
            fly(chip, &Setup { capacity, ..setup.clone() })
        });
        match flown {
            Ok(Flown::Ended(_)) => assert!(fits, "{samples} {hypotheses}"),
            Ok(Flown::Declined(declined)) => {
                assert_eq!((declined, fits), (DeclinedError::Capacity(room), false));
            }
            Err(lost) => panic!("{lost:?}"),
        }
    }
}

/// The terms by which a chip flies are those that it was told, all of its area included. What is no vehicle, no area or no
/// protocol of this version has none.
#[test]
fn a_setup_has_the_terms_that_were_told_or_none() {
    let mission = of_any_vehicle(0, 10);
    assert!(mission.config.area.hulls().count() > 0);
    let network = Network::new(&mission, LabelSource::Vehicle, Faults::default());
    offered(&network, |chip, setup| {
        let mut area = |setup: &Setup| {
            chip.terms::<AnyVehicle, MissionArea>(setup, &mut ()).map(|terms| terms.area)
        };
        assert_eq!(area(setup), Ok(mission.config.area));
        let fewer = Setup { keep_outs: setup.keep_outs.map(|count| count - 1), ..setup.clone() };
        assert!(area(&fewer).is_ok_and(|it| it != mission.config.area));
        // Not that polygon's rectangle.
        let elsewhere = standard_field::area().inset(1).expect("nearly all of it");
        let config = Settings { area: elsewhere, ..setup.config };
        let wrong = area(&Setup { config, ..setup.clone() });
        assert_eq!(wrong, Err(NoTerms::Declined(DeclinedError::Area)));
        assert!(matches!(
            chip.give_up(NoTerms::Declined(DeclinedError::Area)),
            Ok(Flown::Declined(_))
        ));
    });

    let car = of_any_vehicle(2, 10);
    let good =
        host_sim::hil::setup::setup(&car, LabelSource::Vehicle).expect("a mission for a chip");
    let VehicleShape::Car(shape) = good.vehicle else { panic!("{:?}", good.vehicle) };
    let of_radius = |radius_mm| Setup {
        vehicle: VehicleShape::Car(CarShape { radius_mm, ..shape }),
        ..good.clone()
    };
    let by_any = |setup: &Setup| {
        let terms = setup.terms::<AnyVehicle, _>(setup.config.area);
        terms.map(|terms| VehicleShape::from(terms.dynamics))
    };
    assert_eq!(by_any(&good), Ok(good.vehicle));
    let no_circle = DeclinedError::Vehicle(ShapeError::Grid(GridError::Circle));
    assert_eq!(by_any(&of_radius(0)), Err(no_circle));
    let wide = by_any(&of_radius(12_000));
    assert!(matches!(wide, Err(DeclinedError::Vehicle(ShapeError::Room(_)))), "{wide:?}");
    let later = Setup { protocol: PROTOCOL + 1, ..good.clone() };
    assert_eq!(by_any(&later), Err(DeclinedError::Protocol(PROTOCOL)));

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

/// Frames of every message, of missions with all that makes messages long.
fn corpus() -> Vec<Vec<u8>> {
    /// Hears what passes.
    struct Tap<'a>(&'a RefCell<Network>, Vec<Vec<u8>>);
    impl FarEnd for Tap<'_> {
        fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
            self.1.push(frame.to_vec());
            self.0.borrow_mut().send(frame)
        }

        fn receive(&mut self) -> Option<u8> {
            let arrived = self.0.borrow_mut().receive()?;
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
        let network = Network::new(&mission, LabelSource::Vehicle, Faults::default());
        let tap = RefCell::new(Tap(&network, Vec::new()));
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
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(SEED));
    let (mut fed, mut taken) = (0, 0);
    while fed < cases(1_000_000, 20_000_000) as usize {
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
    assert!(taken > 500 && longest <= Some(FRAME));
}
