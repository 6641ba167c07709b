//! A chip within the test's own thread: what it flies, what its port leads to, and its power, which may fail.

use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};

use host_sim::hil::faults::Faults;
use host_sim::hil::player::Player;
use host_sim::mission::definition::Mission;
use planner_core::link::delivery::{Link, LinkError, Port};
use planner_core::link::message::{self, ClockRate, LabelSource};
use planner_core::link::station::{AllLabels, Charts, Flown, Guards, Station, Tracks, Watch};
use planner_core::robot::LabelSensor;
use planner_core::{AnySight, AnyVehicle, Reading};

use crate::wire::Wire;

/// A chip's power failed.
#[derive(Clone, Copy, Debug)]
pub struct Off;

/// What a chip's port leads to: a wire with a vehicle at its end.
pub trait FarEnd {
    /// The chip sends a frame.
    ///
    /// # Errors
    /// When its power fails meanwhile.
    fn send(&mut self, frame: &[u8]) -> Result<(), Off>;

    /// The next byte that the chip hears; `None` once it has waited in vain.
    fn receive(&mut self) -> Option<u8>;
}

/// A chip's port.
pub struct Socket<'a>(pub &'a RefCell<dyn FarEnd + 'a>);

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

/// A chip's label sensor. It may say why it has no reading.
pub type Sensor<'a> = &'a mut (dyn LabelSensor<Error = &'static str> + 'a);

/// A label sensor that is a function.
pub struct Reads<F>(pub F);

impl<F: FnMut() -> Result<Reading, &'static str>> LabelSensor for Reads<F> {
    type Error = &'static str;

    fn read(&mut self) -> Result<Reading, &'static str> {
        self.0()
    }
}

/// A chip. It is one type wherever its port leads, so that its planners are compiled once.
pub type Chip<'a> = Station<Socket<'a>, Sensor<'a>>;

/// A chip, with a label sensor or none.
pub fn chip<'a>(end: &'a RefCell<dyn FarEnd + 'a>, sensor: Option<Sensor<'a>>) -> Chip<'a> {
    let clock = ClockRate { per_second: 1, emulated: false };
    Station { link: Link::new(Socket(end)), sensor, ticks: || 0, clock }
}

/// A chip from its start: it flies missions until one ends as it should.
///
/// # Errors
/// When its power fails before.
pub fn power_up<'a>(
    end: &'a RefCell<dyn FarEnd + 'a>,
    sensor: Option<Sensor<'a>>,
) -> Result<(), Off> {
    let ended = panic::catch_unwind(AssertUnwindSafe(|| {
        let mut chip = chip(end, sensor);
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

/// A chip takes in labels that are read on the way.
#[derive(Clone, Copy, Debug)]
pub struct Hears;

impl Watch for Hears {
    const READINGS: bool = true;
}

/// What the firmware does with a setup.
///
/// # Errors
/// As [`Station::fly`].
pub fn fly(chip: &mut Chip<'_>, setup: &message::Setup) -> Result<Flown, LinkError> {
    type OfLines = AllLabels<68, 36, 529, AnySight>;
    type Planners = Tracks<Guards<OfLines>>;
    chip.fly_with::<Planners, AnyVehicle, Charts<2048>>(setup, &mut Hears)
}

/// A wire with a player at its end.
pub struct Network {
    /// The wire.
    pub wire: Wire,
    /// The player.
    pub player: Player,
    /// What the player complained of.
    pub failure: Option<String>,
    /// Frames that the chip has sent.
    pub frames_of_chip: u64,
}

impl Network {
    /// A network that offers a mission; the mission's seed gives the faults their order.
    ///
    /// # Panics
    /// When no chip can fly it.
    pub fn new(mission: &Mission, labels: LabelSource, faults: Faults) -> RefCell<Self> {
        let player = Player::new(mission, labels, 1).expect("a mission for a chip");
        let wire = Wire::new(faults, mission.seed);
        RefCell::new(Self { wire, player, failure: None, frames_of_chip: 0 })
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

/// What a chip without a sensor makes of the mission that it is offered.
pub fn offered<T>(
    end: &RefCell<dyn FarEnd + '_>,
    fly: impl FnOnce(&mut Chip<'_>, &message::Setup) -> T,
) -> T {
    let mut chip = chip(end, None);
    let setup = chip.await_setup();
    fly(&mut chip, &setup)
}
