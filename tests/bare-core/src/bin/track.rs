#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! The follower of fronts.

#[cfg(target_os = "none")]
#[bare_core::entry]
fn main() -> ! {
    use planner_core::link::station::Tracks;
    use planner_core::{Area, Unicycle};

    bare_core::fly::<Tracks, Unicycle, Area>()
}

/// On a host there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {}
