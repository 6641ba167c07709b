#![cfg_attr(target_os = "none", no_std)]
#![forbid(unsafe_code)]
//! The planner on a bare core: the chip's side of the link over semihosting, without peripherals.
//!
//! | binary | flies | holds |
//! | --- | --- | --- |
//! | `alone` | Algorithm 1, the centre alone as estimate | 16 samples |
//! | `small` | Algorithm 1, look-ahead for true labels, goals by slope | 16 samples |
//! | `medium` | as `small` | 64 labels beside 4 given |
//! | `standard` | all algorithms | 32 labels beside 4 given, all 529 hypotheses |
//! | `large` | all algorithms | 64 labels beside 4 given, all 2,081 hypotheses |
//! | `vehicles` | all algorithms, all vehicles | as `standard` |
//! | `lakes` | all algorithms, the follower of fronts, all vehicles, on charts of 128 x 128 cells | as `standard` |
//! | `track` | the follower of fronts | a curve, any number of labels |
//! | `panicking` | nothing | a panic: that of an index |
//!
//! All but `vehicles` and `lakes` have the unicycle alone. It is built for Arm, and for RISC-V (`riscv32imac`) as QEMU's `virt`.
//! An emulator, or QEMU, plays the world at its standard streams; at the end of the input it exits.
//! Ticks are instructions: on Arm by the host's count in the tests' emulator, on RISC-V by the core's own.

#[cfg(target_os = "none")]
mod port;

#[cfg(all(target_os = "none", target_arch = "arm"))]
pub use cortex_m_rt::entry;
#[cfg(target_os = "none")]
pub use on_target::{fly, panicking};
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
pub use riscv_rt::entry;

/// A program that flies missions with some planners, of vehicles of one type in areas of one type. On a host there is
/// nothing to run.
#[macro_export]
macro_rules! flies {
    ($planners:ty, $vehicle:ty, $area:ty) => {
        #[cfg(target_os = "none")]
        #[$crate::entry]
        fn main() -> ! {
            #[allow(unused_imports, reason = "each program names some of these")]
            use planner_core::{
                AnySight, AnyVehicle, Area, SlopeWithin, Unicycle,
                link::message::MissionArea,
                link::station::{AllLabels, CfcAlone, Guards, Tracks, TrueLabels},
            };

            #[cfg(feature = "charts")]
            #[allow(unused_imports, reason = "one program names it")]
            use planner_core::link::station::Charts;

            $crate::fly::<$planners, $vehicle, $area>()
        }

        #[cfg(not(target_os = "none"))]
        fn main() {}
    };
}

#[cfg(target_os = "none")]
mod on_target {
    use core::convert::Infallible;

    use planner_core::link::delivery::Link;
    use planner_core::link::message::ClockRate;
    use planner_core::link::station::{FromOutlines, KnownDynamics, Planners, Station};

    use crate::port::{Semihosting, Streams, ticks};

    fn open() -> Streams {
        Streams::open().unwrap_or_else(|| semihosting::process::exit(1))
    }

    fn station(streams: &Streams) -> Station<Semihosting<'_>, Infallible> {
        // A tick is an instruction: on the scale of `host-sim hil --emulator`, one of 64 ns.
        let clock = ClockRate { per_second: 15_625_000, emulated: true };
        Station { link: Link::new(Semihosting::new(streams)), sensor: None, ticks, clock }
    }

    /// Flies missions with some planners, of vehicles of one type in areas of one type.
    pub fn fly<A: Planners, D: KnownDynamics, G: FromOutlines>() -> ! {
        let streams = open();
        let mut station = station(&streams);
        loop {
            // How it ended is the host's to judge.
            let _ = station.mission::<A, D, G>(&mut ());
        }
    }

    /// Panics, unless the host's clock stands below four.
    pub fn panicking() -> ! {
        semihosting::process::exit([0, 1, 2, 3][ticks() as usize])
    }

    /// Without a word: the exit status says enough, and formatting would cost more than the planner.
    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        semihosting::process::exit(101)
    }
}
