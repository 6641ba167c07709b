#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]
//! The planner on an STM32F405, over a serial link to the vehicle.
//!
//! Wiring only: what to do next is decided in `planner-core`.
//!
//! | module | does |
//! | --- | --- |
//! | `mission` | what `idle` runs: asks for a mission and flies it |
//! | `serial` | the link: USART1 |
//! | `time` | the beat of `SysTick`, and its ticks |
//!
//! | pin | is |
//! | --- | --- |
//! | PA9, PA10 | USART1, transmit and receive: the link, 115,200 baud, 8N1 |
//! | PA2 | USART2, transmit: the log, the same |
//! | PB0 | output: drive enable, high during a mission; wants a pull-down on the board |
//! | PB1 | input with pull-down: the label |
//!
//! `cargo firmware` builds it. The same ELF runs on the chip and in QEMU's `netduinoplus2`.

#[cfg(target_os = "none")]
mod mission;
#[cfg(target_os = "none")]
mod serial;
#[cfg(target_os = "none")]
mod time;

#[cfg(target_os = "none")]
#[rtic::app(device = stm32f4xx_hal::pac)]
mod app {
    use planner_core::link::delivery::Link;
    use planner_core::link::message::ClockRate;
    use planner_core::link::station::Station;
    use planner_core::{Label, PinSensor};
    use stm32f4xx_hal::gpio::GpioExt;

    use crate::mission::{Board, Deck};
    use crate::serial::{self, Arrivals, Receiver, Serial};
    use crate::time::{Mono, ticks};
    use board::clock::Clock;
    use board::log;
    use board::reset::Reset;
    use board::stop::Enable;
    use board::watchdog::Watchdog;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        board: Board,
        receiver: Receiver,
    }

    #[init(local = [arrivals: Arrivals = Arrivals::new()])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let chip = cx.device;
        // First of all, so that a hang in what follows ends too.
        let watchdog = Watchdog::start(chip.IWDG, &chip.DBGMCU);
        let reset = Reset::take(&chip.RCC);
        let (clock, mut rcc) = Clock::start(chip.RCC, reset);
        Mono::start(cx.core.SYST, clock.hz());

        let gpioa = chip.GPIOA.split(&mut rcc);
        let gpiob = chip.GPIOB.split(&mut rcc);
        log::open(chip.USART2, gpioa.pa2, &chip.DBGMCU, &mut rcc);
        let enable = Enable::new(gpiob.pb0);
        let sensor = PinSensor::new(gpiob.pb1.into_pull_down_input(), Label::Positive);
        let (tx, rx) = serial::open(chip.USART1, (gpioa.pa9, gpioa.pa10), &mut rcc);
        let (received, arrived) = cx.local.arrivals.split();
        let link = Link::new(Serial::new(tx, arrived, watchdog));

        defmt::info!("started: {}, clock: {}", reset, clock);
        let rate = ClockRate { per_second: clock.hz(), emulated: clock == Clock::Emulated };
        let station = Station { link, sensor: Some(sensor), ticks, clock: rate };
        let board = Board { station, deck: Deck { enable, steps: 0 } };
        (Shared {}, Local { board, receiver: Receiver::new(rx, received) })
    }

    #[idle(local = [board])]
    fn idle(cx: idle::Context) -> ! {
        cx.local.board.run()
    }

    #[task(binds = USART1, local = [receiver])]
    fn receive(cx: receive::Context) {
        cx.local.receiver.take_in();
    }
}

/// On a host there is nothing to run: `host-sim` flies the same planner there.
#[cfg(not(target_os = "none"))]
fn main() {}
