//! The random-mission harness: it draws every setting of a mission at random and checks what must hold of any mission.
//!
//! [`draw`] makes a mission of a seed and a number; [`fronts`] and [`fields`] make special ones. [`flight`] flies it and returns what it found wrong. [`plain`] has
//! the harness's own geometry in double precision, and [`reason`] confirms by brute force why a mission ended.

pub mod counted;
pub mod draw;
pub mod fields;
pub mod flight;
pub mod fronts;
pub mod plain;
pub mod reason;

use std::env;
use std::ops::Range;

use planner_core::AnyVehicle;

/// What people call a vehicle.
pub const fn kind(vehicle: &AnyVehicle) -> &'static str {
    match vehicle {
        AnyVehicle::Unicycle(_) => "unicycle",
        AnyVehicle::Boat(_) => "boat",
        AnyVehicle::Car(_) => "car",
    }
}

/// The numbers of missions to fly: `count` of them, or those that `FROM` and `COUNT` in the environment ask for.
///
/// # Panics
/// When these are no numbers.
pub fn asked_for(count: u64) -> Range<u64> {
    let number = |name: &str| env::var(name).ok().map(|it| it.parse::<u64>().expect("a number"));
    let from = number("FROM").unwrap_or(0);
    from..from + number("COUNT").unwrap_or(count)
}
