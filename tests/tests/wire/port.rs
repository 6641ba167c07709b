//! `hil` at a serial port: a pseudo-terminal stands for the cable, a thread for the board.
#![cfg(unix)]

use std::convert::Infallible;
use std::io::{Read, Write};
use std::time::{Duration, Instant};
use std::{panic, thread};

use host_sim::campaign::standard_field;
use host_sim::hil::faults::Faults;
use host_sim::hil::flight::{self, Chip, Timings};
use host_sim::hil::player::Player;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::recording::Recording;
use host_sim::mission::trace;
use planner_core::link::delivery::{Link, Port};
use planner_core::link::message::{ClockRate, EndReason, LabelSource, MissionEnd};
use planner_core::link::station::{CfcAlone, Flown, Station};
use planner_core::{Area, Unicycle};
use serialport::{SerialPort as _, TTYPort};

const WAIT: Duration = Duration::from_millis(100);

/// The board's end.
struct Terminal {
    tty: TTYPort,
    until: Instant,
}

impl Port for Terminal {
    fn send(&mut self, frame: &[u8]) {
        // Until `hil` has opened its end nobody hears it, as with a real cable.
        let _ = self.tty.write_all(frame);
        self.until = Instant::now() + WAIT;
    }

    fn receive(&mut self) -> Option<u8> {
        while Instant::now() < self.until {
            let mut byte = [0];
            match self.tty.read(&mut byte) {
                Ok(1) => return Some(byte[0]),
                _ => thread::sleep(Duration::from_micros(100)),
            }
        }
        None
    }
}

#[test]
fn a_board_at_a_serial_port_flies_as_this_machine_does() {
    let (mut tty, end) = TTYPort::pair().expect("a pseudo-terminal");
    let device = end.name().expect("a device");
    tty.set_timeout(Duration::from_millis(5)).expect("a timeout");
    drop(end); // `hil` opens it
    let board = thread::spawn(move || {
        let link = Link::new(Terminal { tty, until: Instant::now() });
        let clock = ClockRate { per_second: 1_000_000, emulated: false };
        let mut board = Station::<_, Infallible> { link, sensor: None, ticks: || 0, clock };
        board.mission::<CfcAlone<68>, Unicycle, Area>(&mut ())
    });
    let mission = standard_field::standard(4, 1, Algorithm::Cfc, 10);
    let mut player = Player::new(&mission, LabelSource::Vehicle, 1).expect("a mission for a chip");
    let faults: Faults = "drop=0.2,duplicate=0.1,delay=3ms".parse().expect("faults");
    let chip = Chip::Board { device, baud: 115_200 };
    let turnarounds = flight::fly(&mut player, &chip, faults, 1).expect("the board answers");
    let played = player.finish().expect("the mission is over");
    let flown = board.join().unwrap_or_else(|cause| panic::resume_unwind(cause));
    assert!(
        matches!(flown, Ok(Flown::Ended(MissionEnd { reason: EndReason::Steps, .. }))),
        "{flown:?}"
    );
    let timings = Timings::new(&played, &turnarounds);
    assert_eq!(timings.csv().expect("rows").lines().count(), 1 + 10);
    let here = Recording::of(&mission).expect("labels are true");
    assert_eq!(trace::lines(&played.recording.results), trace::lines(&here.results));
}
