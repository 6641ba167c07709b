#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Algorithm 1 and look-ahead with 64 labels beside 4 given samples, for labels that are true.

#[cfg(target_os = "none")]
#[bare_core::entry]
fn main() -> ! {
    use planner_core::link::station::TrueLabels;
    use planner_core::{Area, SlopeWithin, Unicycle};

    bare_core::fly::<TrueLabels<68, SlopeWithin>, Unicycle, Area>()
}

/// On a host there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {}
