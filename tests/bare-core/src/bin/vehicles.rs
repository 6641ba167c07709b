#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! All algorithms, all vehicles and prices of labels, with 32 labels beside 4 given samples.

#[cfg(target_os = "none")]
#[bare_core::entry]
fn main() -> ! {
    use planner_core::link::message::MissionArea;
    use planner_core::link::station::AllLabels;
    use planner_core::{AnySight, AnyVehicle};

    bare_core::fly::<AllLabels<36, 36, 529, AnySight>, AnyVehicle, MissionArea>()
}

/// On a host there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {}
