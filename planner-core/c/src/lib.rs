#![cfg_attr(target_os = "none", no_std)]

//! `planner-core` behind a C interface: look-ahead for a unicycle in a rectangle, with labels that are true or
//! sometimes wrong.
//!
//! `include/planner.h` is made from these sources, `example.c` is a program that uses it. There is no allocation: a
//! planner lives in memory of the caller, which may be moved. Nothing is global, so there may be many.
//!
//! ```sh
//! cargo build -p planner-c --release --target thumbv7em-none-eabihf
//! # target/thumbv7em-none-eabihf/release/libplanner_c.a
//! ```

mod finder;
mod types;

pub use finder::{begin, bits, bytes, estimate, observe, plan};
pub use types::{Line, Mission, Motion, Pose, Reading, Sample, Status};

/// The C program's own end: the planner has no panics, and yet Rust asks.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        safe fn abort() -> !;
    }
    abort()
}
