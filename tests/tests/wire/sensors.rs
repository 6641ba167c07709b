//! Readings that are missing, fail or contradict: the chip says what it took in, and the player what went wrong.

use std::cell::RefCell;
use std::collections::VecDeque;

use host_sim::hil::faults::Faults;
use host_sim::hil::setup;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use planner_core::link::delivery::{Heard, Link, Responder};
use planner_core::link::frame::{Decoder, Envelope, Frame};
use planner_core::link::message::{
    DeclinedError, EndReason, LabelSource, MissionArea, MissionEnd, Outline, PROTOCOL, Reply,
    Request, Setup,
};
use planner_core::link::station::{Flown, NoTerms};
use planner_core::{AnyVehicle, Label, Reading};
use tests::chip::{FarEnd, Network, Off, Reads, Socket, chip, fly, offered, power_up};
use tests::missions::{mission, of_any_vehicle, reading};

/// The motion whose label is missing, from 1.
const MISSING: usize = 3;

/// A vehicle that answers as a function says, and is busy where that has no answer yet.
pub(crate) struct Vehicle<F> {
    responder: Responder,
    setup: Setup,
    act: F,
    under_way: Option<Request>,
    arrived: VecDeque<u8>,
}

impl<F: FnMut(&Request) -> Option<Reply>> Vehicle<F> {
    pub(crate) fn new(mission: &Mission, act: F) -> RefCell<Self> {
        let setup = setup::setup(mission, LabelSource::Vehicle).expect("a mission for a chip");
        let (responder, arrived) = (Responder::new(1), VecDeque::new());
        RefCell::new(Self { responder, setup, act, under_way: None, arrived })
    }
}

impl<F: FnMut(&Request) -> Option<Reply>> FarEnd for Vehicle<F> {
    fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
        // What is late from another session is none of the chip's.
        let mut decoder = Decoder::default();
        let asked = frame.iter().find_map(|byte| decoder.feed::<Request>(*byte));
        let Envelope { session, number, message, .. } = asked.expect("a whole frame");
        if !matches!(message, Request::Hello { .. }) {
            let late = Frame::of(&Envelope::new(session + 9, number, Reply::Stale));
            self.arrived.extend(late.bytes());
        }
        for byte in frame {
            match self.responder.hear(*byte) {
                Some(Heard::Hello(hello)) => {
                    self.arrived.extend(self.responder.offer(hello, self.setup.clone()).bytes());
                }
                Some(Heard::New(request)) => {
                    assert!(self.under_way.replace(request).is_none(), "begun twice");
                }
                Some(Heard::Old(frame)) => self.arrived.extend(frame.bytes()),
                None => {}
            }
        }
        if let Some(reply) = self.under_way.as_ref().and_then(&mut self.act) {
            self.under_way = None;
            self.arrived.extend(self.responder.answer(reply).bytes());
        }
        Ok(())
    }

    fn receive(&mut self) -> Option<u8> {
        self.arrived.pop_front()
    }
}

/// A mission whose first motions all want a label, and what is read after each.
fn asking() -> (Mission, Vec<Option<Reading>>) {
    let of = |number| {
        let mission = mission(number);
        let flown = Recording::of(&mission).expect("labels are true");
        let readings: Vec<_> = flown.steps.iter().map(|step| step.reading).collect();
        (mission, readings)
    };
    let mut all = (0..100).map(of);
    let asks = |(_, readings): &(Mission, Vec<Option<Reading>>)| {
        readings.len() > MISSING && readings[..=MISSING].iter().all(Option::is_some)
    };
    all.find(asks).expect("one such")
}

/// The chip says that it has none, and never that of the motion before.
#[test]
fn a_chip_tells_of_no_reading_where_the_vehicle_sent_none() {
    let (mission, readings) = asking();
    let mut told = Vec::new();
    let vehicle = Vehicle::new(&mission, |request: &Request| {
        let last = match request {
            Request::Move(it) => it.last,
            Request::End(it) => it.last,
            _ => return Some(Reply::Noted),
        };
        told.push(last);
        let Request::Move(it) = request else { return Some(Reply::Noted) };
        let reading = readings[told.len() - 1].filter(|_| told.len() != MISSING);
        Some(Reply::Arrived { pose: it.motion.target, reading })
    });
    let flown = offered(&vehicle, fly);
    let Ok(Flown::Ended(MissionEnd { reason, last, .. })) = flown else { panic!("{flown:?}") };
    assert_eq!((reason, last), (EndReason::Sensor, None));
    drop(vehicle);
    assert_eq!(told, [&[None], &readings[..MISSING - 1], &[None]].concat());
}

/// A vehicle that takes its time begins once, and is waited for.
#[test]
fn a_vehicle_that_is_busy_is_waited_for() {
    let mut asked = 0;
    let slow = Vehicle::new(&mission(0), |_: &Request| {
        asked += 1;
        (asked == 1_000).then_some(Reply::Noted)
    });
    let mut link = Link::new(Socket(&slow));
    let hello = link.ask(Request::Hello { protocol: PROTOCOL });
    assert!(matches!(hello, Ok(Reply::Setup(_))), "{hello:?}");
    assert_eq!(link.ask(Request::Declined(DeclinedError::Algorithm)), Ok(Reply::Noted));
    drop(link);
    drop(slow);
    assert_eq!(asked, 1_000);
}

/// A border is a polygon, and not all within a distance of one.
#[test]
fn a_border_with_a_radius_is_no_area() {
    let mission = of_any_vehicle(0, 10);
    let whole = mission.config.area;
    let none = NoTerms::Declined(DeclinedError::Area);
    for (radius, area) in [(0, Ok(whole)), (1, Err(none))] {
        let vehicle = Vehicle::new(&mission, |request: &Request| {
            let outline = match request {
                Request::Outline(0) => {
                    Outline { corners: whole.corners().iter().copied().collect(), radius }
                }
                Request::Outline(number) => {
                    whole.hulls().nth(usize::from(*number) - 1).expect("a keep-out").into()
                }
                _ => return Some(Reply::Noted),
            };
            Some(Reply::Outline(outline))
        });
        let found = offered(&vehicle, |chip, setup| {
            chip.terms::<AnyVehicle, MissionArea>(setup, &mut ()).map(|terms| terms.area)
        });
        assert_eq!(found, area, "{radius}");
    }
}

/// The first motion is made to its end, and the step has the labels that were read on its way.
#[test]
fn a_player_hears_that_the_boards_own_sensor_failed() {
    let (ends, readings) = asking();
    // Labels are in doubt, so that no reading contradicts.
    let on_the_way = reading(mission(1));
    let first = (on_the_way.clone(), 1, 1, 1);
    for (mission, fails, steps, passed) in
        [(ends, MISSING, MISSING, 0), first, (on_the_way, 2, 1, 1)]
    {
        let network = Network::new(&mission, LabelSource::Chip, Faults::default());
        let mut read = 0;
        let mut sensor = Reads(|| {
            read += 1;
            let reading =
                if passed > 0 { Some(Label::Negative.into()) } else { readings[read - 1] };
            reading.filter(|_| read != fails).ok_or("no reading")
        });
        assert!(power_up(&network, Some(&mut sensor)).is_ok());
        let Network { player, failure, .. } = network.into_inner();
        assert_eq!(failure, None);
        let (played, failure) = player.finish_as_far_as_flown().expect("it has begun");
        let error = failure.expect("a failure").to_string();
        assert_eq!(error, format!("step {steps}: the board's sensor failed"));
        let flown = &played.recording.results.steps;
        assert_eq!((flown.len(), flown[0].passed().count()), (steps, passed));
        let labels: Vec<_> = played.recording.steps.iter().map(|step| step.reading).collect();
        assert_eq!(labels, [&readings[..steps - 1], &[None]].concat());
    }
}

/// A label that contradicts what is known, on the way: the chip and the player refuse the same one.
#[test]
fn a_label_on_the_way_that_contradicts_ends_the_mission_on_the_chip_and_here() {
    let refused = (0..20).filter_map(|number| {
        let mission = Mission { readings: 4, ..mission(6 * number) };
        assert!(!mission.is_noisy());
        let network = Network::new(&mission, LabelSource::Chip, Faults::default());
        // It reads the true labels, but each third wrong.
        let mut count = 0_u32;
        let mut sensor = Reads(|| {
            count += 1;
            let site = network.borrow().player.place();
            Ok(match mission.world.reading(site) {
                Reading::Side(label) if count.is_multiple_of(3) => Reading::Side(-label),
                reading => reading,
            })
        });
        let mut chip = chip(&network, Some(&mut sensor));
        let setup = chip.await_setup();
        let flown = fly(&mut chip, &setup);
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
