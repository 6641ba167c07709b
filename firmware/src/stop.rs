#![expect(
    unsafe_code,
    reason = "a panic or a fault owns no pin, and exceptions are unsafe to name"
)]
//! The safe stop: the drive's enable pin, and what a panic or a fault does.
//!
//! Either pulls the pin low at once, logs one line, and restarts the chip. The restart is a system reset and not the
//! watchdog's, so that the next start can tell a stop from a hang.

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::interrupt;
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use stm32f4xx_hal::gpio::{Output, PB0, PinState};
use stm32f4xx_hal::pac::GPIOB;

use crate::log;

/// Drive enable: high only during a mission.
pub struct Enable(PB0<Output>);

impl Enable {
    /// Starts low.
    pub fn new(pin: PB0) -> Self {
        Self(pin.into_push_pull_output_in_state(PinState::Low))
    }

    /// The drive may move.
    pub fn on(&mut self) {
        self.0.set_high();
    }

    /// The drive stands.
    pub fn off(&mut self) {
        self.0.set_low();
    }
}

/// Set by the first panic or fault. One that happens while the chip stops is neither logged nor waited for.
static STOPPING: AtomicBool = AtomicBool::new(false);

fn stop(tell: impl FnOnce()) -> ! {
    interrupt::disable();
    // SAFETY: the write changes one pin only, by itself, and `Enable` never runs again.
    unsafe { &*GPIOB::ptr() }.bsrr().write(|w| w.br0().reset());
    if !STOPPING.swap(true, Ordering::Relaxed) {
        tell();
        log::flush();
    }
    SCB::sys_reset()
}

/// Logs the text if it is a constant. Formatting any other would cost flash for every panic in the program.
#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    stop(|| {
        let (file, line) = info.location().map_or(("", 0), |at| (at.file(), at.line()));
        let text = info.message().as_str().unwrap_or("(not a constant)");
        defmt::error!("panic at {=str}:{=u32}: {=str}", file, line, text);
    })
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    stop(|| defmt::error!("fault at {=u32:#010x}", frame.pc()))
}

/// Only the clock security system raises this. The core runs on from the internal oscillator, so the log goes out at a
/// wrong speed.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    stop(|| defmt::error!("the crystal failed"))
}

#[exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    stop(|| defmt::error!("unexpected interrupt {=i16}", number))
}
