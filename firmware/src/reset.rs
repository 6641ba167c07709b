//! Why the chip started.

use stm32f4xx_hal::pac::RCC;

/// The reason that the flags in RCC's CSR show.
#[derive(Clone, Copy, PartialEq, Eq, defmt::Format)]
pub enum Reset {
    /// The independent watchdog: the firmware hung.
    Watchdog,
    /// The firmware restarted the chip after a panic or a fault: see `stop`.
    Stop,
    /// Power came on or fell too low.
    Power,
    /// The reset pin, or a debugger by it.
    Pin,
    /// No flag, as in an emulator, or one that this firmware never causes.
    Other,
}

impl Reset {
    /// Reads the flags and clears them for the next time.
    pub fn take(rcc: &RCC) -> Self {
        let flags = rcc.csr().read();
        rcc.csr().modify(|_, w| w.rmvf().set_bit());
        // Every reset pulls the pin, and power's sets the brown-out flag too: the rarer goes first.
        if flags.wdgrstf().bit_is_set() {
            Self::Watchdog
        } else if flags.porrstf().bit_is_set() || flags.borrstf().bit_is_set() {
            Self::Power
        } else if flags.sftrstf().bit_is_set() {
            Self::Stop
        } else if flags.padrstf().bit_is_set() {
            Self::Pin
        } else {
            Self::Other
        }
    }
}
