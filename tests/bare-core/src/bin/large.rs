#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Both algorithms with 64 labels beside 4 given samples.

#[cfg(target_os = "none")]
#[bare_core::entry]
fn main() -> ! {
    bare_core::any::<planner_core::Unicycle, planner_core::Area, 68, 2081>()
}

/// On a host there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {}
