#![expect(unsafe_code, reason = "exceptions and an executor's interrupt are unsafe to name")]
//! The safe stop: the drive's enable pin, and what pulls it low.
//!
//! A task above the planner owns the pin. While the drive is enabled it expects signs of life from the planner's side.
//! A planner that hangs, a panic and a fault all pull the pin low and restart the chip.

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use embassy_executor::InterruptExecutor;
use embassy_nrf::gpio::Output;
use embassy_nrf::pac::{GPIO, Interrupt, interrupt};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, TimeoutError, with_timeout};

/// The pin, P0.02: drive enable.
const ENABLE: usize = 2;

/// How long the planner's side may be silent. Its longest silence is one plan.
const PATIENCE: Duration = Duration::from_secs(4);

/// What the planner's side says.
#[derive(PartialEq)]
enum Sign {
    /// A mission is flown.
    Flies,
    /// It is over.
    Over,
}

static SIGN: Signal<CriticalSectionRawMutex, Sign> = Signal::new();

/// Whether a mission is flown.
static FLYING: AtomicBool = AtomicBool::new(false);

/// A mission begins.
pub(crate) fn begin() {
    FLYING.store(true, Ordering::Relaxed);
    alive();
}

/// The planner's side runs.
pub(crate) fn alive() {
    if FLYING.load(Ordering::Relaxed) {
        SIGN.signal(Sign::Flies);
    }
}

/// No mission is flown any more.
pub(crate) fn end() {
    FLYING.store(false, Ordering::Relaxed);
    SIGN.signal(Sign::Over);
}

/// Drive enable: high only while a mission is flown.
#[embassy_executor::task]
async fn guard(mut enable: Output<'static>) {
    loop {
        while SIGN.wait().await != Sign::Flies {}
        enable.set_high();
        loop {
            match with_timeout(PATIENCE, SIGN.wait()).await {
                Ok(Sign::Flies) => {}
                Ok(Sign::Over) => break,
                Err(TimeoutError) => stop(),
            }
        }
        enable.set_low();
    }
}

/// The executor of what runs above the planner, in an interrupt that no peripheral uses.
static ABOVE: InterruptExecutor = InterruptExecutor::new();

#[interrupt]
fn SWI0() {
    // SAFETY: this is the executor's interrupt, which it enables itself as it starts.
    unsafe { ABOVE.on_interrupt() };
}

/// Starts the guard of the enable pin, which is low.
pub(crate) fn guard_drive(enable: Output<'static>) {
    let above = ABOVE.start(Interrupt::SWI0);
    match guard(enable) {
        Ok(guard) => above.spawn(guard),
        Err(_) => unreachable!("it is spawned once"),
    }
}

fn stop() -> ! {
    cortex_m::interrupt::disable();
    // By its register, as the code that stops the chip does not own the pin.
    GPIO.outclr().write(|w| w.set_pin(ENABLE, true));
    SCB::sys_reset()
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    stop()
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    stop()
}
