//! Time: RTIC's monotonic on `SysTick`, and the ticks within its beats. A beat is one period of `SysTick`, 10 ms.

use rtic_monotonics::systick::SYST;
use rtic_monotonics::{Timebase, systick_monotonic};

/// The same number as in the next line, whose macro takes a literal alone.
const BEATS_PER_SECOND: u32 = 100;
systick_monotonic!(Mono, 100);

/// A time on the beat.
pub(crate) type Instant = <Mono as Timebase>::Instant;

/// A span on the beat.
pub(crate) type Duration = <Mono as Timebase>::Duration;

defmt::timestamp!("{=u32:ms}", Mono::now().as_ticks().wrapping_mul(1_000 / BEATS_PER_SECOND));

/// Ticks of `SysTick`, at the core clock, since it was started; wraps after 25 s at 168 MHz.
///
/// To be called with interrupts enabled, or at least once in a beat.
pub(crate) fn ticks() -> u32 {
    loop {
        let beats = Mono::now().as_ticks();
        // Down to 0, where the beat falls, then from the reload value again.
        let left = SYST::get_current();
        // 0 may be read before the beat is counted, and a beat may fall between the readings.
        if left != 0 && Mono::now().as_ticks() == beats {
            return beats.wrapping_add(1).wrapping_mul(ticks_per_beat()).wrapping_sub(left);
        }
    }
}

/// Ticks in a second.
pub(crate) fn ticks_per_second() -> u32 {
    ticks_per_beat() * BEATS_PER_SECOND
}

fn ticks_per_beat() -> u32 {
    SYST::get_reload() + 1
}
