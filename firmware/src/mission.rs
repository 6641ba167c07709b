//! What `idle` runs: asks for a mission, flies it, logs it, and asks for the next.

use planner_core::link::delivery::LinkError;
use planner_core::link::message::{MissionEnd, Setup};
use planner_core::link::station::{AllLabels, Charts, Flown, Guards, Station, Tracks, Watch};
use planner_core::watch::Alarm;
use planner_core::{AnySight, AnyVehicle, LocalLine, PinSensor, Reading, Step};
use stm32f4xx_hal::gpio::{Input, PB1};

use crate::serial::Serial;
use board::stop::Enable;

/// Samples that a mission with true labels can hold: 64 labels beside four given ones.
const TRUE_SAMPLES: usize = 68;

/// Samples that a mission with doubtful labels can hold: 32 labels beside four given ones.
const DOUBTFUL_SAMPLES: usize = 36;

/// All hypotheses that 32 labels can leave.
const HYPOTHESES: usize = 529;

/// Words of cells that a chart can have: those of 256 rows and columns.
const CELL_WORDS: usize = 2_048;

/// The parts of the board that a mission uses.
pub(crate) struct Board {
    pub(crate) station: Station<Serial, PinSensor<PB1<Input>>>,
    pub(crate) deck: Deck,
}

impl Board {
    /// Flies missions of any vehicle in any area.
    pub(crate) fn run(&mut self) -> ! {
        type OfLines = AllLabels<TRUE_SAMPLES, DOUBTFUL_SAMPLES, HYPOTHESES, AnySight>;
        type Planners = Tracks<Guards<OfLines>>;
        loop {
            // How it ended is in the log.
            let _ =
                self.station.mission::<Planners, AnyVehicle, Charts<CELL_WORDS>>(&mut self.deck);
        }
    }
}

/// What goes on beside planning: the drive is enabled during a mission, and each step is logged.
pub(crate) struct Deck {
    pub(crate) enable: Enable,
    /// Steps of this mission so far.
    pub(crate) steps: u16,
}

impl Watch for Deck {
    const ALARMS: bool = true;
    const READINGS: bool = true;

    fn set_up(&mut self, setup: &Setup) {
        self.steps = 0;
        defmt::info!("mission: {}, {=u16} steps at most", setup.algorithm, setup.steps);
    }

    fn begins(&mut self) {
        self.enable.on();
    }

    fn stepped(&mut self, step: &Step) {
        self.steps += 1;
        log_step(self.steps, step);
        if let Some(alarm) = &step.alarm {
            log_alarm(self.steps, alarm);
        }
    }

    fn over(&mut self, flown: &Result<Flown, LinkError>) {
        self.enable.off();
        log_end(self.steps, flown);
    }
}

fn log_end(steps: u16, flown: &Result<Flown, LinkError>) {
    match flown {
        Ok(Flown::Ended(MissionEnd { reason, estimates, .. })) => {
            defmt::info!("ended after {=u16} steps: {}", steps, reason);
            log_line("centre", estimates.centre);
            log_line("maximum margin", estimates.maximum_margin);
            log_line("bisector", estimates.bisector);
        }
        Ok(Flown::Declined(declined)) => defmt::warn!("declined: {}", declined),
        Err(lost) => defmt::error!("stopped after {=u16} steps: {}", steps, lost),
    }
}

fn log_step(number: u16, Step { motion, pose, reading, .. }: &Step) {
    defmt::info!(
        "step {=u16}: {} {}, action {=u32}, to x {=i32}, z {=i32}, heading {=u32:#010x}, label {}",
        number,
        motion.stage,
        motion.recovery,
        motion.action.0,
        pose.site.x(),
        pose.site.z(),
        pose.heading.0,
        reading.map(Reading::sign),
    );
}

fn log_alarm(number: u16, Alarm { evidence, suspect }: &Alarm) {
    defmt::warn!(
        "step {=u16}: evidence {=f32} against a straight, still line: {}",
        number,
        evidence,
        suspect
    );
}

/// A line in axes of its own: about a site and along a direction, both on the lattice, by slope and intercept
/// in metres.
fn log_line(name: &str, line: Option<LocalLine>) {
    match line {
        None => defmt::info!("{=str}: none", name),
        Some(line) => defmt::info!(
            "{=str}: about x {=i32}, z {=i32}, along x {=i32}, z {=i32}: slope {=f32}, intercept {=f32}",
            name,
            line.about().x(),
            line.about().z(),
            line.along().x(),
            line.along().z(),
            line.slope(),
            line.intercept(),
        ),
    }
}
