#![expect(unsafe_code, reason = "to enable an interrupt is unsafe")]
//! The link: UART0 at 115,200 baud, 8N1. An interrupt takes in arriving bytes and signals when one has left. The
//! planner sleeps while it waits for either. Every wait has a bound.

use core::future::Future;
use core::pin::pin;
use core::task::Poll;

use cortex_m::asm::wfi;
use cortex_m::peripheral::NVIC;
use embassy_futures::poll_once;
use embassy_nrf::Peri;
use embassy_nrf::gpio::{Input, Level, Output, OutputDrive, Pull};
use embassy_nrf::pac::UART0 as UART;
use embassy_nrf::pac::uart::vals::{Baudrate, Enable};
use embassy_nrf::pac::{Interrupt, interrupt};
use embassy_nrf::peripherals::{P0_24, P0_25};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, with_deadline, with_timeout};
use planner_core::link::delivery::Port;

use crate::stop;

/// What an answer may take, counted from the end of the question.
const WAIT: Duration = Duration::from_millis(100);

/// The longest frame takes 28 ms. A transmitter that takes longer is stuck.
const STUCK: Duration = Duration::from_millis(50);

/// Bytes that arrived and are not read yet: 22 ms of the line. One that finds it full spoils its frame, which is sent
/// again.
static ARRIVED: Pipe<CriticalSectionRawMutex, 256> = Pipe::new();

/// The last byte has left.
static SENT: Signal<CriticalSectionRawMutex, ()> = Signal::new();

#[interrupt]
fn UART0() {
    if UART.events_rxdrdy().read() != 0 {
        // First, as reading makes room for the next byte.
        UART.events_rxdrdy().write_value(0);
        let _ = ARRIVED.try_write(&[UART.rxd().read().rxd()]);
    }
    if UART.events_txdrdy().read() != 0 {
        UART.events_txdrdy().write_value(0);
        SENT.signal(());
    }
}

/// The link, for the planner.
pub(crate) struct Serial {
    _pins: (Output<'static>, Input<'static>),
    deadline: Instant,
}

impl Serial {
    /// Opens the UART on its pins.
    pub(crate) fn open(tx: Peri<'static, P0_24>, rx: Peri<'static, P0_25>) -> Self {
        UART.pseltxd().write_value(24);
        UART.pselrxd().write_value(25);
        UART.baudrate().write(|w| w.set_baudrate(Baudrate::Baud115200));
        UART.enable().write(|w| w.set_enable(Enable::Enabled));
        UART.intenset().write(|w| {
            w.set_rxdrdy(true);
            w.set_txdrdy(true);
        });
        UART.tasks_startrx().write_value(1);
        UART.tasks_starttx().write_value(1);
        // SAFETY: nothing is masked by this interrupt's being off.
        unsafe { NVIC::unmask(Interrupt::UART0) };
        let tx = Output::new(tx, Level::High, OutputDrive::Standard);
        Self { _pins: (tx, Input::new(rx, Pull::None)), deadline: Instant::MIN }
    }
}

async fn transmit(frame: &[u8]) {
    for &byte in frame {
        SENT.reset();
        UART.txd().write(|w| w.set_txd(byte));
        SENT.wait().await;
    }
}

impl Port for Serial {
    fn send(&mut self, frame: &[u8]) {
        stop::alive();
        // A frame that is not sent counts as lost: the request is sent again.
        let _ = block_on(with_timeout(STUCK, transmit(frame)));
        self.deadline = Instant::now() + WAIT;
    }

    fn receive(&mut self) -> Option<u8> {
        // This comes first, or a peer that never pauses would keep it going for ever.
        if Instant::now() >= self.deadline {
            return None;
        }
        let mut byte = [0];
        block_on(with_deadline(self.deadline, ARRIVED.read(&mut byte))).ok()?;
        Some(byte[0])
    }
}

/// Waits in thread mode, asleep between interrupts.
fn block_on<T>(future: impl Future<Output = T>) -> T {
    let mut future = pin!(future);
    loop {
        // An interrupt that comes after the look stays pending, and ends the sleep at once.
        let looked = critical_section::with(|_| {
            let looked = poll_once(future.as_mut());
            if looked.is_pending() {
                wfi();
            }
            looked
        });
        if let Poll::Ready(it) = looked {
            return it;
        }
    }
}
