//! Missions of every algorithm and vehicle, as a chip may be asked to fly them.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::names::FanName;
use host_sim::world::errors::Errors;
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::CarShape;
use planner_core::{Accuracy, Angle, AnyVehicle, Boat, Car, Goal, Tolerance, Unicycle};

use crate::{ensemble, terrain};

/// The seed of missions, faults and noise.
pub const SEED: u64 = 4;

/// Missions of every kind that a chip flies, by turns. Every third is flown by look-ahead, and every other of these has
/// labels that may be wrong. The rest are flown by Algorithms 1 and 2. In every fourth pair the fan is fine.
pub fn mission(number: u64) -> Mission {
    by_turns(SEED, number, 10)
}

/// As [`mission`], of another seed and with other steps.
pub fn by_turns(seed: u64, number: u64, steps: u32) -> Mission {
    let is_even = number.is_multiple_of(2);
    let algorithm = match (number % 3, is_even) {
        (2, _) => Algorithm::Lookahead,
        (_, true) => Algorithm::Cfc,
        (_, false) => Algorithm::Scc,
    };
    let mut mission = standard_field::standard(seed, number, algorithm, steps);
    mission.vehicle = if number % 8 < 6 { FanName::Paper } else { FanName::Fine }.into();
    if !is_even {
        mission.noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });
    }
    mission
}

/// A mission with several readings a motion. As many as the firmware has room for, where labels may be wrong.
pub fn reading(mission: Mission) -> Mission {
    Mission { readings: 3, ..mission }
}

/// Missions by look-ahead with a goal, which most of them reach within their steps. By turns it is about the slopes or
/// the uncertain ground, with true labels or with labels that may be wrong.
///
/// # Panics
/// Never: its angles are finite.
pub fn stopping(number: u64) -> Mission {
    let is_noisy = number % 4 >= 2;
    let mut mission = standard_field::standard(SEED, number, Algorithm::Lookahead, 28);
    // Long motions, so that the steps suffice for the audit as well.
    let far = Unicycle::new(1_000, 1.57, 61, 100);
    mission.vehicle = AnyVehicle::Unicycle(far.expect("a unicycle"));
    mission.noise = is_noisy.then_some(NoiseModel { p: 0.9, extent: Extent::OutsideBalls(0.5) });
    let (degrees, share) = if is_noisy { (10.0, 100_000) } else { (1.0, 5_000) };
    let accuracy = if number.is_multiple_of(2) {
        Accuracy::SlopeArc(Angle::from_degrees(degrees).expect("an angle"))
    } else {
        Accuracy::Misclassified(share)
    };
    mission.goal = Some(Goal { accuracy, level: 900_000 });
    mission
}

/// Missions of every vehicle by every algorithm: any 12 in a row have all pairs of these. In every second group of four
/// the robot errs, and has a tolerance for that. Two of five are in a polygon with keep-outs.
///
/// # Panics
/// Never: these are vehicles.
pub fn of_any_vehicle(number: u64, steps: u32) -> Mission {
    const TURN_STEP_URAD: u32 = 7_000;
    let (algorithm, is_noisy) = [
        (Algorithm::Cfc, false),
        (Algorithm::Scc, true),
        (Algorithm::Lookahead, false),
        (Algorithm::Lookahead, true),
    ][number as usize % 4];
    let mut mission = standard_field::standard(SEED + 3, number, algorithm, steps);
    let steps_of = |sharpest: f64| Unicycle::new(TURN_STEP_URAD, sharpest, 17, 150);
    let made = match number % 3 {
        0 => steps_of(1.2).map(AnyVehicle::Unicycle),
        1 => steps_of(0.349).and_then(Boat::new).map(AnyVehicle::Boat),
        _ => Car::new(CarShape {
            radius_mm: 1_500,
            shortest_mm: 400,
            turn_step_urad: TURN_STEP_URAD,
            speeds: 21,
            speed_step_mm: 100,
        })
        .map(AnyVehicle::Car),
    };
    mission.vehicle = made.expect("a vehicle");
    if is_noisy {
        mission.noise = Some(NoiseModel { p: 0.8, extent: Extent::OutsideBalls(0.5) });
    }
    if number % 5 < 2 {
        mission.config.area = terrain::around(&mission, &mut ensemble::rng(SEED + 4, number));
    }
    if number / 4 % 2 == 1 {
        mission.errors = Errors { motion: 0.05, turn: 0.02, position: 0.05, heading: 0.01 };
        mission.config.tolerance = Tolerance::new(0.15).expect("a length");
    }
    mission
}
