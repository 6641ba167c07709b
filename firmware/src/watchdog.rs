//! The independent watchdog: restarts the chip when the firmware hangs.

use stm32f4xx_hal::pac::{DBGMCU, IWDG};
use stm32f4xx_hal::prelude::_fugit_ExtU32 as _;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

/// The watchdog's oscillator is 17 to 47 kHz where 32 is meant, so this is 4.1 to 11.3 s.
const PERIOD_MS: u32 = 6_000;

/// The longest time between two feeds is one plan: 20 million instructions, as the test
/// `no_plan_of_any_mission_passes_the_bound` says. Three cycles an instruction are more than any
/// plan takes. Without its crystal the chip runs at 16 MHz.
const _: () = assert!(20_000_000 / 16_000 * 3 < PERIOD_MS * 32 / 47);

/// The watchdog, started. Nothing but a debugger that halts the core stops it.
pub struct Watchdog(IndependentWatchdog);

impl Watchdog {
    /// Starts it; a debugger that halts the core halts it too.
    pub fn start(iwdg: IWDG, debug: &DBGMCU) -> Self {
        let mut watchdog = IndependentWatchdog::new(iwdg);
        watchdog.stop_on_debug(debug, true);
        watchdog.start(PERIOD_MS.millis());
        Self(watchdog)
    }

    /// Puts the reset off by the whole period.
    pub fn feed(&mut self) {
        self.0.feed();
    }
}
