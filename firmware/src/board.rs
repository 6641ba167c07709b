//! The board: where the log goes, what a panic does, and what follows the mission.

use cortex_m as _; // the critical sections of the logger
#[cfg(not(feature = "semihosting"))]
use defmt_rtt as _;
#[cfg(feature = "semihosting")]
use defmt_semihosting as _;
use panic_probe as _; // logs the panic, then faults

/// Idles for good.
#[cfg(not(feature = "semihosting"))]
pub(crate) fn end(_success: bool) -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}

/// Ends the emulator with exit status 0 or 1.
#[cfg(feature = "semihosting")]
pub(crate) fn end(success: bool) -> ! {
    semihosting::process::exit(i32::from(!success))
}
