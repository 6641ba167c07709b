#![expect(
    unsafe_code,
    reason = "defmt's logger is an unsafe trait, and a fault takes the log over from what it broke off"
)]
//! The log: defmt frames to RTT, for a probe, and to USART2, for a wire or an emulator.
//!
//! Neither output waits for a reader. A frame that does not fit is dropped whole and counted, so the stream stays
//! decodable. No published logger does this. Only `defmt-brtt` has both outputs, but it spins in a critical section
//! when a probe has gone away, and it drops parts of frames. `defmt-serial` blocks.

use core::cell::UnsafeCell;
use core::mem;

use critical_section::RestoreState;
use embedded_hal_nb::serial::Write;
use heapless::{Deque, Vec};
use rtt_target::{ChannelMode, UpChannel, rtt_init};
use stm32f4xx_hal::gpio::PA2;
use stm32f4xx_hal::pac::{DBGMCU, USART2};
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Serial, Tx2};

use crate::clock::BAUD;

/// Bytes in a frame, at most.
const FRAME: usize = 256;

/// Between frames, one or more.
const SEPARATOR: u8 = 0;

/// Bytes that wait for the wire, at most: some 180 ms of it.
const WAITING: usize = 2_048;

/// Bytes handed to the wire at a time.
const PORTION: usize = 16;

static LOG: Shared = Shared(UnsafeCell::new(Log {
    encoder: defmt::Encoder::new(),
    frame: Vec::new(),
    too_long: false,
    waiting: Deque::new(),
    dropped: 0,
    rtt: None,
    wire: None,
    restore: RestoreState::invalid(),
}));

/// One at a time has it: see [`Log::with`].
struct Shared(UnsafeCell<Log>);

// SAFETY: `Log::with` alone reaches what is inside.
unsafe impl Sync for Shared {}

struct Log {
    encoder: defmt::Encoder,
    frame: Vec<u8, FRAME>,
    too_long: bool,
    waiting: Deque<u8, WAITING>,
    dropped: u32,
    rtt: Option<UpChannel>,
    wire: Option<Tx2>,
    restore: RestoreState,
}

impl Log {
    /// A panic or a fault while the log is in hand takes it over as it is: any byte or index that was
    /// about to change is a sound one.
    fn with<T>(f: impl FnOnce(&mut Self) -> T) -> T {
        // SAFETY: no `f` logs, and in a critical section only a panic or a fault can come between. They
        // never return, so then the other reference is not used again.
        critical_section::with(|_| f(unsafe { &mut *LOG.0.get() }))
    }

    fn encode(&mut self, part: impl FnOnce(&mut defmt::Encoder, &mut dyn FnMut(&[u8]))) {
        let Self { encoder, frame, too_long, .. } = self;
        part(encoder, &mut |bytes| *too_long |= frame.extend_from_slice(bytes).is_err());
    }

    /// Hands the frame out, whole or not at all.
    fn commit(&mut self) {
        if let (false, Some(rtt)) = (self.too_long, &mut self.rtt) {
            // A probe sets it to block, and may be gone by now.
            rtt.set_mode(ChannelMode::NoBlockSkip);
            rtt.write(&self.frame);
        }
        if !self.too_long && self.frame.len() <= WAITING - self.waiting.len() {
            for &byte in &self.frame {
                let _ = self.waiting.push_back(byte); // there is room
            }
        } else {
            self.dropped += 1;
        }
    }

    /// Sends a portion. Returns whether more is waiting, and if not, how many frames were dropped meanwhile.
    fn send(&mut self) -> (bool, u32) {
        let Some(wire) = &mut self.wire else { return (false, 0) };
        for _ in 0..PORTION {
            let Some(&byte) = self.waiting.front() else { break };
            if wire.write(byte).is_err() {
                break;
            }
            self.waiting.pop_front();
        }
        if self.waiting.is_empty() { (false, mem::take(&mut self.dropped)) } else { (true, 0) }
    }

    fn is_sending(&mut self) -> bool {
        self.wire.as_mut().is_some_and(|wire| wire.flush().is_err())
    }
}

/// Opens both ways out. What was logged before goes to the wire alone.
pub fn open(usart: USART2, pin: PA2, debug: &DBGMCU, rcc: &mut Rcc) {
    // A probe reads memory in sleep too.
    debug.cr().modify(|_, w| w.dbg_sleep().set_bit());
    let channels = rtt_init! { up: { 0: { size: 1024, name: "defmt" } } };
    let Ok(wire) = Serial::tx(usart, pin, BAUD, rcc) else {
        unreachable!("16 MHz carry more than 115,200 baud");
    };
    Log::with(|log| {
        log.rtt = Some(channels.up.0);
        log.wire = Some(wire);
    });
}

/// Sends what the wire takes without a wait; says whether more is waiting.
pub fn drain() -> bool {
    let (more, dropped) = Log::with(Log::send);
    if dropped != 0 {
        defmt::warn!("the log was full: {=u32} messages lost", dropped);
    }
    more || dropped != 0
}

/// Sends all that is waiting. Only the watchdog ends this if the transmitter is stuck.
pub fn flush() {
    while drain() {}
    while Log::with(Log::is_sending) {}
}

#[defmt::global_logger]
struct Logger;

// SAFETY: `acquire` enters a critical section that only `release` leaves, so frames do not mix.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        // SAFETY: defmt pairs this with `release`.
        let restore = unsafe { critical_section::acquire() };
        Log::with(|log| {
            // A panic or a fault may have cut off a frame while it was being built, which is dropped. Or it cut off a
            // frame on its way out, which the separator ends.
            log.frame.clear();
            log.too_long = false;
            log.restore = restore;
            log.encode(|encoder, put| {
                put(&[SEPARATOR]);
                encoder.start_frame(put);
            });
        });
    }

    unsafe fn write(bytes: &[u8]) {
        Log::with(|log| log.encode(|encoder, put| encoder.write(bytes, put)));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        let restore = Log::with(|log| {
            log.encode(|encoder, put| encoder.end_frame(put));
            log.commit();
            log.restore
        });
        // SAFETY: this is the state that `acquire` was given.
        unsafe { critical_section::release(restore) }
    }
}
