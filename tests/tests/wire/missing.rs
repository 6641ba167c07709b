//! A reading that is missing: the chip says that it has none, and never that of the motion before.

use std::cell::RefCell;
use std::collections::VecDeque;

use host_sim::hil::faults::Faults;
use host_sim::hil::player::Player;
use host_sim::hil::setup;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use planner_core::link::delivery::{Heard, Link, Responder};
use planner_core::link::message::{
    ClockRate, EndReason, LabelSource, MissionEnd, Reply, Request, Setup,
};
use planner_core::link::station::{CfcAlone, Flown, Station};
use planner_core::robot::LabelSensor;
use planner_core::{Area, Reading, Unicycle};
use tests::chip::{self, FarEnd, Off, Socket};
use tests::missions::mission;
use tests::wire::Wire;

/// The motion whose label is missing, from 1.
const MISSING: usize = 3;

/// A vehicle that goes where it is told and reads what it would here, but once nothing.
struct Vehicle {
    responder: Responder,
    setup: Setup,
    readings: Vec<Option<Reading>>,
    made: usize,
    arrived: VecDeque<u8>,
    /// What the chip said that it took in, after each motion and at the end.
    told: Vec<Option<Reading>>,
}

impl Vehicle {
    fn act(&mut self, request: Request) -> Reply {
        match request {
            Request::Move(it) => {
                self.told.push(it.last);
                self.made += 1;
                let reading = self.readings[self.made - 1].filter(|_| self.made != MISSING);
                Reply::Arrived { pose: it.motion.target, reading }
            }
            Request::End(it) => {
                self.told.push(it.last);
                Reply::Noted
            }
            _ => Reply::Noted,
        }
    }
}

impl FarEnd for Vehicle {
    fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
        for byte in frame {
            let answer = match self.responder.hear(*byte) {
                Some(Heard::Hello(hello)) => self.responder.offer(hello, self.setup.clone()),
                Some(Heard::New(request)) => {
                    let reply = self.act(request);
                    self.responder.answer(reply).clone()
                }
                Some(Heard::Old(frame)) => frame,
                None => continue,
            };
            self.arrived.extend(answer.bytes());
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

#[test]
fn a_chip_tells_of_no_reading_where_the_vehicle_sent_none() {
    let (mission, readings) = asking();
    let vehicle = RefCell::new(Vehicle {
        responder: Responder::new(1),
        setup: setup::setup(&mission, LabelSource::Vehicle).expect("a mission for a chip"),
        readings: readings.clone(),
        made: 0,
        arrived: VecDeque::new(),
        told: Vec::new(),
    });
    let mut chip = chip::chip(&vehicle, None);
    let setup = chip.await_setup();
    let flown = chip::fly(&mut chip, &setup);
    let Ok(Flown::Ended(MissionEnd { reason, last, .. })) = flown else { panic!("{flown:?}") };
    assert_eq!((reason, last), (EndReason::Sensor, None));
    drop(chip);
    let told = vehicle.into_inner().told;
    assert_eq!(told, [&[None], &readings[..MISSING - 1], &[None]].concat());
}

/// A sensor that fails at one of its reads.
struct Flaky {
    readings: Vec<Option<Reading>>,
    read: usize,
}

impl LabelSensor for Flaky {
    type Error = &'static str;

    fn read(&mut self) -> Result<Reading, &'static str> {
        self.read += 1;
        self.readings[self.read - 1].filter(|_| self.read != MISSING).ok_or("no reading")
    }
}

/// A wire with a player at its end.
struct Network {
    wire: Wire,
    player: Player,
}

impl FarEnd for Network {
    fn send(&mut self, frame: &[u8]) -> Result<(), Off> {
        self.wire.ask(frame);
        Ok(())
    }

    fn receive(&mut self) -> Option<u8> {
        let Self { wire, player } = self;
        wire.answer(|byte| player.hear(byte).expect("nothing is wrong but the sensor"))
    }
}

#[test]
fn a_player_hears_that_the_boards_own_sensor_failed() {
    let (mission, readings) = asking();
    let player = Player::new(&mission, LabelSource::Chip, 1).expect("a mission for a chip");
    let network = RefCell::new(Network { wire: Wire::new(Faults::default(), 1), player });
    let clock = ClockRate { per_second: 1, emulated: false };
    let link = Link::new(Socket(&network));
    let sensor = Some(Flaky { readings: readings.clone(), read: 0 });
    let mut board = Station { link, sensor, ticks: || 0, clock };
    let flown = board.mission::<CfcAlone<68>, Unicycle, Area>(&mut ());
    assert!(matches!(flown, Ok(Flown::Ended(_))), "{flown:?}");
    drop(board);
    let player = network.into_inner().player;
    let (played, failure) = player.finish_as_far_as_flown().expect("it has begun");
    assert_eq!(failure.expect("a failure").to_string(), "step 3: the board's sensor failed");
    let labels: Vec<_> = played.recording.steps.iter().map(|step| step.reading).collect();
    assert_eq!(labels, [&readings[..MISSING - 1], &[None]].concat());
}
