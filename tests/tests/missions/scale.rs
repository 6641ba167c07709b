//! Look-ahead at any scale: what the labels of a unicycle tell, by the area's size and the reach.

use std::f64::consts::FRAC_PI_2;

use host_sim::campaign::standard_field::stretched;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use planner_core::dynamics::ActionGrid;
use planner_core::{AnyVehicle, Unicycle};
use tests::cases;
use tests::ensemble::{self, expect, mean};

/// Motions of a mission.
const STEPS: u32 = 20;

#[test]
fn more_reach_never_hurts() {
    for side in [5.0, 20.0, 800.0, 4_000.0] {
        for percent in [2.0_f64, 5.0, 10.0, 15.0, 20.0, 50.0, 100.0] {
            let reach_mm = (10.0 * side * percent).min(f64::from(ActionGrid::LONGEST_MM) - 1e3);
            let unicycle = Unicycle::new(1, FRAC_PI_2, 101, (reach_mm / 100.0) as u32);
            let vehicle = AnyVehicle::Unicycle(unicycle.expect("a grid"));
            let bits = ensemble::fly(cases(24, 120), |number| {
                let mission = stretched([side; 2], 41, number, Algorithm::Lookahead, STEPS);
                let mission = Mission { vehicle, ..mission };
                let mut motions = 0;
                let flown = mission.fly(|_, _| motions += 1).expect("labels are true");
                assert_eq!(motions, STEPS, "{side} m, {percent} %: {:?}", flown.ending);
                flown.belief.information() / f64::from(STEPS)
            });
            let least = match percent {
                2.0 => 0.69,
                5.0 => 0.87,
                _ => 0.965,
            };
            expect(format!("bits, {side} m, {percent} %"), mean(bits), least..);
        }
    }
}
