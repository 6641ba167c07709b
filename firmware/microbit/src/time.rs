#![expect(unsafe_code, reason = "to enable an interrupt is unsafe")]
//! Time: embassy's, on TIMER0 at 16 MHz. The HAL's own driver wants the real-time counter, which QEMU lacks.

use core::cell::{Cell, RefCell};
use core::task::Waker;

use cortex_m::peripheral::NVIC;
use critical_section::{CriticalSection, Mutex};
use embassy_nrf::pac::timer::vals::Bitmode;
use embassy_nrf::pac::{CLOCK, Interrupt, TIMER0 as TIMER, interrupt};
use embassy_time_driver::{Driver, TICK_HZ, time_driver_impl};
use embassy_time_queue_utils::Queue;
use planner_core::link::message::ClockRate;

/// The timer's registers for the alarm and for reading.
const ALARM: usize = 0;
const NOW: usize = 1;

/// The furthest alarm, half of the timer's range. So the time is read before the timer wraps.
const FURTHEST: u64 = 1 << 31;

/// An alarm nearer than this might pass while it is set.
const NEAREST: u64 = 64;

struct Time {
    /// The time when it was last read. The timer counts its lowest 32 bits.
    read: Mutex<Cell<u64>>,
    waiting: Mutex<RefCell<Queue>>,
}

time_driver_impl!(static TIME: Time = Time {
    read: Mutex::new(Cell::new(0)),
    waiting: Mutex::new(RefCell::new(Queue::new())),
});

impl Driver for Time {
    fn now(&self) -> u64 {
        critical_section::with(|cs| {
            TIMER.tasks_capture(NOW).write_value(1);
            let last = self.read.borrow(cs);
            let passed = TIMER.cc(NOW).read().wrapping_sub(last.get() as u32);
            last.set(last.get() + u64::from(passed));
            last.get()
        })
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|cs| {
            if self.waiting.borrow_ref_mut(cs).schedule_wake(at, waker) {
                self.wake(cs);
            }
        });
    }
}

impl Time {
    /// Wakes the tasks that are due, and sets the alarm for the next.
    fn wake(&self, cs: CriticalSection<'_>) {
        let now = self.now();
        let next = self.waiting.borrow_ref_mut(cs).next_expiration(now);
        let ahead = next.saturating_sub(now).clamp(NEAREST, FURTHEST);
        TIMER.cc(ALARM).write_value((now + ahead) as u32);
    }
}

#[interrupt]
fn TIMER0() {
    TIMER.events_compare(ALARM).write_value(0);
    critical_section::with(|cs| TIME.wake(cs));
}

/// Starts the timer.
pub(crate) fn start() {
    TIMER.bitmode().write(|w| w.set_bitmode(Bitmode::_32bit));
    TIMER.prescaler().write(|w| w.set_prescaler(0));
    TIMER.intenset().write(|w| w.set_compare(ALARM, true));
    TIMER.tasks_start().write_value(1);
    critical_section::with(|cs| TIME.wake(cs));
    // SAFETY: nothing is masked by this interrupt's being off.
    unsafe { NVIC::unmask(Interrupt::TIMER0) };
}

/// The planner's clock.
pub(crate) fn ticks() -> u32 {
    TIME.now() as u32
}

/// The rate of these ticks. Under QEMU the clock's status register reads 1, without the bit that says that it runs.
pub(crate) fn clock() -> ClockRate {
    ClockRate { per_second: TICK_HZ as u32, emulated: !CLOCK.hfclkstat().read().state() }
}
