#![no_std]
#![no_main]
#![deny(unsafe_code)]
//! The planner on a BBC micro:bit (nRF51822, Cortex-M0, 16 KB of RAM), over a serial link to the vehicle.
//!
//! A plan occupies the core for tens of milliseconds, so it runs in thread mode. Tasks that must not wait for it run
//! above: embassy's interrupt executor runs the task that guards the drive, and interrupts take bytes in. The planner
//! itself sleeps in an `async` wait when it has asked for something.
//!
//! | module | does |
//! | --- | --- |
//! | `mission` | asks for a mission and flies it |
//! | `serial` | the link: UART0 |
//! | `stop` | the drive's enable pin; a planner that hangs, panics and faults pull it low and restart |
//! | `time` | embassy's time on TIMER0, whose ticks are the planner's clock |
//!
//! | pin | is |
//! | --- | --- |
//! | P0.24, P0.25 | UART0, transmit and receive: the link, 115,200 baud, 8N1, by way of USB |
//! | P0.02, ring 1 | output: drive enable, high during a mission; wants a pull-down on the board |
//! | P0.03, ring 0 | input with pull-down: the label |
//!
//! The same ELF runs on the board and in QEMU's `microbit`.

mod mission;
mod serial;
mod stop;
mod time;

use cortex_m_rt::entry;
use embassy_nrf::config::{Config, HfclkSource};
use embassy_nrf::gpio::{Input, Level, Output, OutputDrive, Pull};
use planner_core::link::delivery::Link;
use planner_core::link::station::Station;
use planner_core::{Label, PinSensor};

use crate::serial::Serial;

#[entry]
fn main() -> ! {
    let mut config = Config::default();
    // The internal oscillator is too far off for a serial line.
    config.hfclk_source = HfclkSource::ExternalXtal;
    let chip = embassy_nrf::init(config);
    time::start();
    stop::guard_drive(Output::new(chip.P0_02, Level::Low, OutputDrive::Standard));
    let sensor = PinSensor::new(Input::new(chip.P0_03, Pull::Down), Label::Positive);
    let link = Link::new(Serial::open(chip.P0_24, chip.P0_25));
    let sensor = Some(sensor);
    mission::run(Station { link, sensor, ticks: time::ticks, clock: time::clock() })
}
