//! The core clock: 168 MHz from the crystal, or 16 MHz from the internal oscillator where there is
//! no crystal to count on; and the speed of the serial lines.

use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Config, Rcc, RccExt};
use stm32f4xx_hal::time::{Bps, Hertz};

use crate::reset::Reset;

/// The speed of both serial lines, the link's and the log's.
pub const BAUD: Bps = Bps(115_200);

const CRYSTAL: Hertz = Hertz::MHz(8);
const FULL_SPEED: Hertz = Hertz::MHz(168);
const INTERNAL: Hertz = Hertz::MHz(16);

/// Polls for a ready flag: some 25 ms at 16 MHz. A crystal starts within a few milliseconds.
const POLLS: u32 = 100_000;

/// Where the core clock comes from.
#[derive(Clone, Copy, PartialEq, Eq, defmt::Format)]
pub enum Clock {
    /// The crystal, through the PLL: 168 MHz.
    Crystal,
    /// The internal oscillator: 16 MHz.
    Internal,
    /// An emulator without a clock tree. QEMU's `SysTick` counts 168 MHz whatever is set.
    Emulated,
}

impl Clock {
    /// Sets the clock up.
    ///
    /// The HAL's own waits have no bound. Under emulation none is reached. On the chip they are reached only after the
    /// crystal was seen to run. The PLL can still hang, and then the watchdog resets the chip. After that reset the
    /// crystal is not used, so there is no loop of resets.
    pub fn start(rcc: pac::RCC, reset: Reset) -> (Self, Rcc) {
        let clock = Self::find(&rcc, reset);
        let config = match clock {
            Self::Crystal => Config::hse(CRYSTAL).sysclk(FULL_SPEED),
            Self::Internal | Self::Emulated => Config::hsi(),
        };
        let rcc = rcc.freeze(config);
        if clock == Self::Crystal {
            // From here on a crystal that fails is a non-maskable interrupt: see `stop`.
            rcc.cr().modify(|_, w| w.csson().on());
        }
        (clock, rcc)
    }

    fn find(rcc: &pac::RCC, reset: Reset) -> Self {
        // The chip starts on this oscillator, so it is ready wherever there is one.
        rcc.cr().modify(|_, w| w.hsion().on());
        if !comes_true(|| rcc.cr().read().hsirdy().is_ready()) {
            return Self::Emulated;
        }
        if reset == Reset::Watchdog {
            return Self::Internal;
        }
        rcc.cr().modify(|_, w| w.hseon().on());
        if comes_true(|| rcc.cr().read().hserdy().is_ready()) {
            return Self::Crystal;
        }
        rcc.cr().modify(|_, w| w.hseon().off());
        Self::Internal
    }

    /// The frequency that `SysTick` counts.
    pub const fn hz(self) -> u32 {
        match self {
            Self::Crystal | Self::Emulated => FULL_SPEED.raw(),
            Self::Internal => INTERNAL.raw(),
        }
    }
}

fn comes_true(ready: impl Fn() -> bool) -> bool {
    (0..POLLS).any(|_| ready())
}
