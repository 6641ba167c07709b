//! The link: USART1 at 115,200 baud, 8N1. An interrupt queues arriving bytes; sending is polled. Every wait has a
//! bound.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::{asm, interrupt};
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{Read, Write};
use heapless::spsc::{Consumer, Producer, Queue};
use planner_core::link::delivery::Port;
use rtic_monotonics::Timebase;
use stm32f4xx_hal::gpio::{PA9, PA10};
use stm32f4xx_hal::pac::USART1;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Rx1, RxListen, Serial as Usart, Tx1};

use crate::time::{Duration, Instant, Mono, ticks, ticks_per_second};
use board::clock::BAUD;
use board::log;
use board::watchdog::Watchdog;

/// What an answer may take, counted from the end of the question: 100 ms at least.
const WAIT: Duration = Duration::from_ticks(11);

/// A byte takes 87 us. A transmitter that takes none in 2 ms is stuck.
const STUCK_PER_SECOND: u32 = 500;

/// Bytes that came in and are not yet read: 511 at most, 44 ms of the line.
pub(crate) type Arrivals = Queue<u8, 512>;

/// Bytes lost to a full queue since the last report.
static OVERFLOWED: AtomicU32 = AtomicU32::new(0);

/// Bytes lost to overrun, framing or noise since the last report.
static GARBLED: AtomicU32 = AtomicU32::new(0);

/// Opens USART1 and enables its interrupt for every byte that arrives.
pub(crate) fn open(usart: USART1, pins: (PA9, PA10), rcc: &mut Rcc) -> (Tx1, Rx1) {
    let Ok(serial) = Usart::new(usart, pins, BAUD, rcc) else {
        unreachable!("16 MHz carry more than 115,200 baud");
    };
    let (tx, mut rx) = serial.split();
    rx.listen();
    (tx, rx)
}

/// The receiving end, for the interrupt.
pub(crate) struct Receiver {
    rx: Rx1,
    received: Producer<'static, u8>,
}

impl Receiver {
    pub(crate) const fn new(rx: Rx1, received: Producer<'static, u8>) -> Self {
        Self { rx, received }
    }

    /// Queues the byte that came in. The interrupt comes again while there is another.
    pub(crate) fn take_in(&mut self) {
        let lost = match self.rx.read() {
            Ok(byte) if self.received.enqueue(byte).is_err() => &OVERFLOWED,
            Ok(_) | Err(nb::Error::WouldBlock) => return,
            // Reading has cleared the flag.
            Err(nb::Error::Other(_)) => &GARBLED,
        };
        lost.fetch_add(1, Ordering::Relaxed);
    }
}

/// The link, for `idle`. While it waits it sends the log and feeds the watchdog.
pub(crate) struct Serial {
    tx: Tx1,
    arrived: Consumer<'static, u8>,
    watchdog: Watchdog,
    deadline: Instant,
}

impl Serial {
    pub(crate) fn new(tx: Tx1, arrived: Consumer<'static, u8>, watchdog: Watchdog) -> Self {
        Self { tx, arrived, watchdog, deadline: Mono::now() }
    }

    /// Sends a byte; `None` if the transmitter is stuck.
    fn transmit(&mut self, byte: u8) -> Option<()> {
        let start = ticks();
        while self.tx.write(byte).is_err() {
            if ticks().wrapping_sub(start) > ticks_per_second() / STUCK_PER_SECOND {
                return None;
            }
        }
        Some(())
    }

    /// Sleeps until an interrupt, unless something is there to do.
    fn sleep(&mut self) {
        if log::drain() {
            return;
        }
        // An interrupt that comes after the check stays pending, and ends the sleep at once.
        interrupt::free(|_| {
            if !self.arrived.ready() {
                asm::wfi();
            }
        });
    }
}

impl Port for Serial {
    fn send(&mut self, frame: &[u8]) {
        self.watchdog.feed();
        if frame.iter().try_for_each(|&byte| self.transmit(byte)).is_none() {
            defmt::warn!("the link's transmitter is stuck: a frame is lost");
        }
        self.deadline = Mono::now() + WAIT;
    }

    fn unreadable(&mut self) {
        defmt::warn!("a frame came whole and held no message");
    }

    fn receive(&mut self) -> Option<u8> {
        loop {
            self.watchdog.feed();
            // This comes first, or a peer that never pauses would keep it going for ever.
            if Mono::now() >= self.deadline {
                report("the link's queue was full", &OVERFLOWED);
                report("the link's line was garbled", &GARBLED);
                return None;
            }
            if let Some(byte) = self.arrived.dequeue() {
                return Some(byte);
            }
            self.sleep();
        }
    }
}

fn report(cause: &str, lost: &AtomicU32) {
    let count = lost.swap(0, Ordering::Relaxed);
    if count != 0 {
        defmt::warn!("{=str}: {=u32} bytes lost", cause, count);
    }
}
