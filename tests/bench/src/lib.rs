#![cfg_attr(target_os = "none", no_std)]
#![forbid(unsafe_code)]
//! The planner on a bare core: the chip's side of the link over semihosting, without peripherals.
//!
//! | binary | flies | holds |
//! | --- | --- | --- |
//! | `small` | Algorithm 1 | 16 samples |
//! | `standard` | both algorithms | 32 labels beside 4 given, all 529 hypotheses |
//! | `large` | both algorithms | 64 labels beside 4 given, all 2,081 hypotheses |
//!
//! An emulator, or QEMU, plays the world at its standard streams; at the end of the input it exits.
//! Ticks are the host's: instructions in the tests' emulator.

#[cfg(target_os = "none")]
mod port;

#[cfg(target_os = "none")]
pub use on_target::{any, cfc};

#[cfg(target_os = "none")]
mod on_target {
    use core::convert::Infallible;

    use planner_core::link::Link;
    use planner_core::remote::Station;
    use planner_core::wire::{Algorithm, ClockRate, Declined};

    use crate::port::{Semihosting, ticks};

    fn station() -> Station<Semihosting, Infallible> {
        let Some(port) = Semihosting::open() else { semihosting::process::exit(1) };
        // A tick is an instruction: on the scale of `host-sim hil --emulator`, one of 64 ns.
        let clock = ClockRate { per_second: 15_625_000, emulated: true };
        Station { link: Link::new(port), sensor: None, ticks, clock }
    }

    /// Flies missions of Algorithm 1 with room for `N` samples.
    pub fn cfc<const N: usize>() -> ! {
        let mut station = station();
        loop {
            let setup = station.await_setup();
            let planner = match setup.algorithm {
                Algorithm::Cfc => setup.cfc::<N>(),
                Algorithm::Scc { .. } => Err(Declined::Algorithm),
            };
            // How it ended is the host's to judge.
            let _ = station.fly(&setup, planner, |_| {});
        }
    }

    /// Flies missions of both algorithms with room for `N` samples and `H` hypotheses.
    pub fn any<const N: usize, const H: usize>() -> ! {
        let mut station = station();
        loop {
            let setup = station.await_setup();
            let _ = match setup.algorithm {
                Algorithm::Cfc => station.fly(&setup, setup.cfc::<N>(), |_| {}),
                Algorithm::Scc { noise, policy, prior } => {
                    let planner = setup.scc::<N, H>(noise, policy, prior);
                    station.fly(&setup, planner, |_| {})
                }
            };
        }
    }

    /// Without a word: the exit status says enough, and formatting would cost more than the planner.
    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        semihosting::process::exit(101)
    }
}
