#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Algorithm 1 alone, with 16 samples.

#[cfg(target_os = "none")]
#[bare_core::entry]
fn main() -> ! {
    use planner_core::link::station::CfcAlone;
    use planner_core::{Area, Unicycle};

    bare_core::fly::<CfcAlone<16>, Unicycle, Area>()
}

/// On a host there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {}
