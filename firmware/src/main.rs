#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Algorithm 1 on a Cortex-M4F: runs one mission in a compiled-in world, reports it over defmt, and
//! idles.
//!
//! Wiring only: what to do next is decided in `planner-core`.
//!
//! | module | does |
//! | --- | --- |
//! | `board` | the logger, the panic handler, what follows the mission |
//! | `mission` | steps the agent and logs what comes of it |
//! | `world` | the mission's data, and a simulated sensor and drive |
//!
//! `cargo firmware` builds it. The log goes to RTT, which never waits for a reader; the feature
//! `semihosting` sends it to an emulator or a debugger instead, and ends with an exit status.

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod mission;
#[cfg(target_os = "none")]
mod world;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    let outcome = mission::run();
    if let Err(failure) = &outcome {
        defmt::error!("the mission failed: {}", failure);
    }
    board::end(outcome.is_ok())
}

/// On a host there is nothing to run: `host-sim` flies the same planner there.
#[cfg(not(target_os = "none"))]
fn main() {}
