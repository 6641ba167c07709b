//! Labels on the way over the link: the trace is that of `run`, whatever the link does to frames.

use std::cell::RefCell;
use std::convert::Infallible;

use host_sim::hil::faults::Faults;
use host_sim::hil::player::Player;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::report::trace;
use planner_core::link::delivery::{Link, LinkError};
use planner_core::link::message::{ClockRate, DeclinedError, LabelSource, MissionArea};
use planner_core::link::station::{AllLabels, Flown, Station};
use planner_core::robot::LabelSensor;
use planner_core::{AnySight, AnyVehicle, Label, Reading};
use rayon::prelude::*;
use tests::chip::{self, FarEnd, Hears, Off, Socket};
use tests::missions::{mission, of_any_vehicle, reading, stopping};
use tests::wire::Wire;

/// A wire with a player at its end.
struct Network {
    wire: Wire,
    player: Player,
    failure: Option<String>,
}

impl Network {
    fn new(mission: &Mission, labels: LabelSource, faults: Faults) -> Self {
        let player = Player::new(mission, labels, 1).expect("a mission for a chip");
        Self { wire: Wire::new(faults, mission.seed), player, failure: None }
    }
}

impl FarEnd for Network {
    fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
        self.wire.ask(frame);
        Ok(())
    }

    fn receive(&mut self) -> Option<u8> {
        let Self { wire, player, failure } = self;
        wire.answer(|byte| {
            player.hear(byte).unwrap_or_else(|error| {
                *failure = Some(error.to_string());
                None
            })
        })
    }
}

/// Flies a mission over a link with faults. Checks that its trace is that of a mission without a link, and returns how
/// many labels were read on the way.
fn flies_as_here(mission: &Mission, faults: Faults) -> usize {
    let network = RefCell::new(Network::new(mission, LabelSource::Vehicle, faults));
    let mut chip = chip::chip(&network, None);
    let setup = chip.await_setup();
    let flown = chip::fly(&mut chip, &setup);
    assert!(matches!(flown, Ok(Flown::Ended(_))), "{flown:?}: {mission:?}");
    drop(chip);
    let Network { player, failure, .. } = network.into_inner();
    assert_eq!(failure, None, "{mission:?}");
    let there = player.finish().expect("the mission is over").recording.results;
    let here = Recording::of(mission).expect("labels that are certain are true");
    assert_eq!(trace::lines(&there), trace::lines(&here.results), "{mission:?}");
    there.steps.iter().map(|step| step.passed().count()).sum()
}

/// True labels and labels that may be wrong, every planner and vehicle, robots that err, goals with their audits.
#[test]
fn missions_with_labels_on_the_way_fly_over_the_link_as_here() {
    let all = (0..60).map(mission).chain((0..120).map(|number| of_any_vehicle(number, 10)));
    // The chip has no room for all labels of a long mission in noise.
    let goals = (0..40).filter(|number| number % 4 < 2).map(stopping);
    let missions: Vec<_> = all.chain(goals).map(reading).collect();
    let flies = |mission: &Mission| flies_as_here(mission, Faults::default());
    let passed: usize = missions.par_iter().map(flies).sum();
    println!("{} missions, {passed} labels on the way", missions.len());
    assert!(passed > 2000, "{passed}");
}

#[test]
fn over_a_bad_link_too() {
    let faults: Faults =
        "drop=0.1,cut=0.02,corrupt=0.05,duplicate=0.1,delay=20ms".parse().expect("faults");
    let missions = (0..200).map(mission).chain((0..48).map(|number| of_any_vehicle(number, 10)));
    let missions: Vec<_> = missions.map(reading).collect();
    let passed: usize = missions.par_iter().map(|mission| flies_as_here(mission, faults)).sum();
    println!("{} missions, {passed} labels on the way", missions.len());
    assert!(passed > 2000, "{passed}");
}

/// Flies a mission with the chip's own sensor, over a link without faults.
fn by_sensor<S: LabelSensor>(
    mission: &Mission,
    sensor: impl FnOnce(&RefCell<Network>) -> S,
) -> (Result<Flown, LinkError>, Player) {
    let network = Network::new(mission, LabelSource::Chip, Faults::default());
    let network = RefCell::new(network);
    let (link, sensor) = (Link::new(Socket(&network)), Some(sensor(&network)));
    let clock = ClockRate { per_second: 1, emulated: false };
    let mut board = Station { link, sensor, ticks: || 0, clock };
    let flown =
        board.mission::<AllLabels<68, 36, 529, AnySight>, AnyVehicle, MissionArea>(&mut Hears);
    drop(board);
    let network = network.into_inner();
    assert_eq!(network.failure, None, "{mission:?}");
    (flown, network.player)
}

/// A sensor that fails at one of its reads, from 1, and reads -1 otherwise.
struct Flaky(usize, usize);

impl LabelSensor for Flaky {
    type Error = &'static str;

    fn read(&mut self) -> Result<Reading, &'static str> {
        self.1 += 1;
        if self.0 == self.1 { Err("no reading") } else { Ok(Label::Negative.into()) }
    }
}

/// The first motion is made to its end, and the step has the label that was read.
#[test]
fn a_sensor_of_the_chips_that_fails_on_the_way_ends_the_mission_when_the_motion_has_ended() {
    // Labels are in doubt, so that no reading contradicts.
    let mission = reading(mission(1));
    assert!(mission.is_noisy());
    let (flown, player) = by_sensor(&mission, |_| Flaky(2, 0));
    assert!(matches!(flown, Ok(Flown::Ended(_))), "{flown:?}");
    let (played, failure) = player.finish_as_far_as_flown().expect("it has begun");
    assert_eq!(failure.expect("a failure").to_string(), "step 1: the board's sensor failed");
    let steps = &played.recording.results.steps;
    assert_eq!((steps.len(), steps[0].passed().count(), steps[0].label), (1, 1, None));
}

/// A label that contradicts what is known, on the way: the chip and the player refuse the same one.
#[test]
fn a_label_on_the_way_that_contradicts_ends_the_mission_on_the_chip_and_here() {
    /// Reads the true labels, but each third wrong.
    struct Wrong<'a>(&'a RefCell<Network>, &'a Mission, u32);
    impl LabelSensor for Wrong<'_> {
        type Error = Infallible;

        fn read(&mut self) -> Result<Reading, Infallible> {
            self.2 += 1;
            let site = self.0.borrow().player.place();
            Ok(match self.1.world.reading(site) {
                Reading::Side(label) if self.2.is_multiple_of(3) => Reading::Side(-label),
                reading => reading,
            })
        }
    }
    let refused = (0..20).filter_map(|number| {
        let mission = Mission { readings: 4, ..mission(6 * number) };
        assert!(!mission.is_noisy());
        let network = Network::new(&mission, LabelSource::Chip, Faults::default());
        let network = RefCell::new(network);
        let sensor = &mut Wrong(&network, &mission, 0);
        let mut chip = chip::chip(&network, Some(sensor));
        let setup = chip.await_setup();
        let flown = chip::fly(&mut chip, &setup);
        assert!(matches!(flown, Ok(Flown::Ended(_))), "{flown:?}");
        drop(chip);
        let player = network.into_inner().player;
        let (_, failure) = player.finish_as_far_as_flown().expect("it has begun");
        let failure = failure?.to_string();
        assert!(failure.starts_with("step ") && failure.contains("contradicts"), "{failure}");
        Some(failure)
    });
    assert!(refused.count() > 5);
}

#[test]
fn a_chip_that_takes_in_no_labels_on_the_way_says_so() {
    let mission = reading(mission(0));
    let network = RefCell::new(Network::new(&mission, LabelSource::Vehicle, Faults::default()));
    let mut chip = chip::chip(&network, None);
    let flown = chip.mission::<AllLabels<68, 36, 529, AnySight>, AnyVehicle, MissionArea>(&mut ());
    assert!(matches!(flown, Ok(Flown::Ended(_))), "{flown:?}");
    drop(chip);
    let Network { player, failure, .. } = network.into_inner();
    assert_eq!(failure, None);
    let error = player.finish().expect_err("it cannot be flown so").to_string();
    let expected = "readings: found 3, expected 1: the board takes in the label at a motion's end";
    assert!(error.starts_with(expected), "{error}");
}

/// Each label on the way may need room where it may be wrong, so the setup asks for as much.
#[test]
fn a_chip_declines_more_labels_than_it_has_room_for() {
    let mission = Mission { readings: 5, ..mission(1) };
    let network = RefCell::new(Network::new(&mission, LabelSource::Vehicle, Faults::default()));
    let mut chip = chip::chip(&network, None);
    let setup = chip.await_setup();
    let flown = chip::fly(&mut chip, &setup);
    assert!(matches!(flown, Ok(Flown::Declined(DeclinedError::Capacity(_)))), "{flown:?}");
    drop(chip);
    let error = network.into_inner().player.finish().expect_err("it was declined").to_string();
    let expected = "readings: found 5 in each of 10 steps, expected at most 32 in all: the board";
    assert!(error.starts_with(expected), "{error}");
}
