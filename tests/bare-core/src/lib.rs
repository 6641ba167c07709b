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
//! | `panicking` | nothing | a panic: that of an index |
//!
//! All but `vehicles` have the unicycle alone. It is built for Arm, and for RISC-V (`riscv32imac`) as QEMU's `virt`.
//! An emulator, or QEMU, plays the world at its standard streams; at the end of the input it exits.
//! Ticks are instructions: on Arm by the host's count in the tests' emulator, on RISC-V by the core's own.

#[cfg(target_os = "none")]
mod port;

#[cfg(all(target_os = "none", target_arch = "arm"))]
pub use cortex_m_rt::entry;
#[cfg(target_os = "none")]
pub use on_target::{any, cfc, panicking, true_labels};
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
pub use riscv_rt::entry;

#[cfg(target_os = "none")]
mod on_target {
    use core::convert::Infallible;

    use planner_core::error::ObservationError;
    use planner_core::link::delivery::Link;
    use planner_core::link::message::{Algorithm, ClockRate, DeclinedError};
    use planner_core::link::station::{FromOutlines, Known, Station};
    use planner_core::{
        Accuracy, Area, Belief as _, Estimates, Plan, Planner, Pose, Reading, SlopeWithin,
        Tolerance, Unicycle,
    };

    use crate::port::{Semihosting, Streams, ticks};

    fn open() -> Streams {
        Streams::open().unwrap_or_else(|| semihosting::process::exit(1))
    }

    fn station(streams: &Streams) -> Station<Semihosting<'_>, Infallible> {
        // A tick is an instruction: on the scale of `host-sim hil --emulator`, one of 64 ns.
        let clock = ClockRate { per_second: 15_625_000, emulated: true };
        Station { link: Link::new(Semihosting::new(streams)), sensor: None, ticks, clock }
    }

    /// Flies missions of Algorithm 1 with room for `N` samples.
    pub fn cfc<const N: usize>() -> ! {
        let streams = open();
        let mut station = station(&streams);
        loop {
            let setup = station.await_setup();
            // How it ended is the host's to judge.
            let _ = match (station.terms::<Unicycle, Area>(&setup), setup.algorithm) {
                (Err(none), _) => station.give_up(none),
                (Ok(terms), Algorithm::Cfc) => {
                    let mut planner = setup.cfc::<_, _, N>(terms);
                    let centre_alone = planner.as_mut().map(|it| it.wrapped(CentreAlone));
                    station.fly(&setup, &mut centre_alone.map_err(|why| *why), |_| {})
                }
                _ => station.decline(DeclinedError::Algorithm),
            };
        }
    }

    /// A planner that estimates the centre alone, as [`Planner::estimate`] does.
    struct CentreAlone<'a, L>(&'a mut L);

    impl<L: Planner<Belief: Sized>> Planner for CentreAlone<'_, L> {
        type Belief = L::Belief;

        fn plan(&mut self, pose: Pose) -> Plan {
            self.0.plan(pose)
        }

        fn observe_within(
            &mut self,
            pose: Pose,
            reading: Option<Reading>,
            tolerance: Tolerance,
        ) -> Result<(), ObservationError> {
            self.0.observe_within(pose, reading, tolerance)
        }

        fn belief(&self) -> &L::Belief {
            self.0.belief()
        }

        fn estimates(&self) -> Estimates {
            let centre = self.belief().centre();
            Estimates { bisector: None, centre, maximum_margin: None }
        }
    }

    /// Flies missions with true labels, of Algorithm 1 and of look-ahead, with room for `N` samples.
    pub fn true_labels<const N: usize>() -> ! {
        let streams = open();
        let mut station = station(&streams);
        loop {
            let setup = station.await_setup();
            let _ = match (station.terms::<Unicycle, Area>(&setup), setup.algorithm) {
                (Err(none), _) => station.give_up(none),
                (Ok(terms), Algorithm::Lookahead { evaluations, goal, noise: None }) => {
                    let mut planner =
                        setup.lookahead::<_, _, SlopeWithin, N>(terms, evaluations, goal);
                    station.fly(&setup, &mut planner, |_| {})
                }
                (Ok(terms), Algorithm::Cfc) => {
                    station.fly(&setup, &mut setup.cfc::<_, _, N>(terms), |_| {})
                }
                _ => station.decline(DeclinedError::Algorithm),
            };
        }
    }

    /// Flies missions of all algorithms with vehicles of one type in areas of one type, and room for `N` samples and `H` hypotheses.
    pub fn any<D: Known, G: FromOutlines, const N: usize, const H: usize>() -> ! {
        let streams = open();
        let mut station = station(&streams);
        loop {
            let setup = station.await_setup();
            let terms = match station.terms::<D, G>(&setup) {
                Ok(terms) => terms,
                Err(none) => {
                    let _ = station.give_up(none);
                    continue;
                }
            };
            let _ = match setup.algorithm {
                Algorithm::Cfc => station.fly(&setup, &mut setup.cfc::<_, _, N>(terms), |_| {}),
                Algorithm::Lookahead { evaluations, goal, noise: None } => {
                    let mut planner =
                        setup.lookahead::<_, _, Accuracy, N>(terms, evaluations, goal);
                    station.fly(&setup, &mut planner, |_| {})
                }
                Algorithm::Lookahead { evaluations, goal, noise: Some((noise, prior)) } => {
                    let mut planner =
                        setup.lookahead_in_noise::<_, _, N, H>(terms, evaluations, goal);
                    station.fly(&setup, &mut setup.prepare(&mut planner, prior, noise), |_| {})
                }
                Algorithm::Scc { noise, policy, prior } => {
                    let mut planner = setup.scc::<_, _, N, H>(terms, policy);
                    station.fly(&setup, &mut setup.prepare(&mut planner, prior, noise), |_| {})
                }
            };
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
