#![cfg_attr(target_os = "none", no_std)]

//! `planner-core` behind a C interface: look-ahead for a unicycle in a rectangle or a convex polygon with keep-outs, with
//! labels that are true or sometimes wrong; and the follower and the guard of fronts.
//!
//! `include/planner.h` is made from these sources, `example.c` and `bloom.c` use it. There is no allocation: a
//! planner lives in memory of the caller, which may be moved. Nothing is global, so there may be many.
//!
//! `held` has the calls that planners of lines (`finder`) and of fronts (`follower`) share. A call checks a mission as a
//! whole before it writes to memory, and writes its answer last. So a refusal changes nothing. All planners take one type of
//! area, so each is compiled once. Functions match on the planner's kind, and there is no table of methods. So a program that
//! is linked with `--gc-sections` contains only what it calls.
//!
//! ```sh
//! cargo build -p planner-c --profile chip --target thumbv7em-none-eabihf
//! # target/thumbv7em-none-eabihf/chip/libplanner_c.a
//! ```

mod area;
mod finder;
mod follower;
mod held;
mod mission;
mod parts;
mod sizes;
mod snapshot;
mod status;
mod types;
mod verdict;

pub use area::{Area, CHART_CELLS, CORNERS, Chart, KEEP_OUTS, KeepOut};
pub use finder::{
    Finder, begin, bits, bytes, chance, check, estimate, observe, observe_believed,
    observe_on_the_way, observe_within, plan, restore, save,
};
pub use follower::{
    Follower, FrontCrossing, FrontPlace, FrontSettings, follow, follower_bytes, follower_chance,
    follower_check, follower_observe, follower_observe_on_the_way, follower_observe_within,
    follower_plan, follower_restore, follower_save, front, front_beside,
};
pub use mission::Mission;
pub use sizes::{ALIGNMENT, BYTES, DOUBTFUL_BYTES, FOLLOWER_BYTES};
pub use snapshot::{FOLLOWER_SNAPSHOT_BYTES, SNAPSHOT_BYTES, Snapshot};
pub use status::{Status, has_ended, is_refused};
pub use types::{Line, Motion, Point, Pose, Reading, Sample};
pub use verdict::Verdict;

/// Ends the C program. The planner does not panic, but Rust requires a handler.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        safe fn abort() -> !;
    }
    abort()
}
