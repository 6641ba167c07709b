//! Vehicles of every kind, with 21 speeds.

use std::f64::consts::FRAC_PI_2;

use planner_core::CarShape;
use planner_core::{Boat, Car, Unicycle};

/// A unicycle with so many microradians between its directions, and motions of up to `reach_mm`.
///
/// # Panics
/// When there is no such vehicle.
pub fn unicycle(turn_step_urad: u32, reach_mm: u32) -> Unicycle {
    Unicycle::new(turn_step_urad, FRAC_PI_2, 21, reach_mm / 20).expect("a unicycle")
}

/// A boat that turns by `sharpest` radians a motion.
///
/// # Panics
/// As [`unicycle`].
pub fn boat(turn_step_urad: u32, sharpest: f64, reach_mm: u32) -> Boat {
    Unicycle::new(turn_step_urad, sharpest, 21, reach_mm / 20).and_then(Boat::new).expect("a boat")
}

/// A car with a turning circle of this radius.
///
/// # Panics
/// As [`unicycle`].
pub fn car(turn_step_urad: u32, radius_mm: u32, reach_mm: u32) -> Car {
    let (speeds, speed_step_mm) = (21, reach_mm / 20);
    let shape = CarShape { radius_mm, shortest_mm: 500, turn_step_urad, speeds, speed_step_mm };
    Car::new(shape).expect("a car")
}
