//! An analogue sensor: a threshold with hysteresis on what a converter measures.
//!
//! `cargo run -p planner-core --example analogue_sensor`

mod field;

use std::convert::Infallible;

use field::{Result, World};
use planner_core::robot::DriveFn;
use planner_core::{
    Agent, Event, Label, Lookahead, Motion, ThresholdSensor, Unicycle, Vehicle, VersionSpace,
};

/// Counts of a 12-bit converter behind a photodiode: 800 a metre across the edge, and a ripple.
fn counts(world: &World, conversions: &mut u32) -> i32 {
    *conversions += 1;
    let ripple = [0, 14, -9, 11, -15][*conversions as usize % 5];
    (2_048.0 + 800.0 * world.height()).clamp(0.0, 4_095.0) as i32 + ripple
}

fn main() -> Result {
    let world = World::new()?;
    let mut conversions = 0;
    let measure = || Ok::<_, Infallible>(counts(&world, &mut conversions));
    // A band wider than the ripple. It hides 40 counts of 800 a metre to either side at most: 5 cm, and that the
    // planner is told.
    let sensor = ThresholdSensor::new(measure, 2_028..=2_068, Label::Positive);
    let space = VersionSpace::<32>::new(&field::given()?)?.with_tolerance(0.06)?;
    let planner = Lookahead::new(field::area()?, Unicycle::paper(), space)?;
    let drive = DriveFn(|motion: &Motion| {
        world.go(motion.target);
        Ok::<_, Infallible>(world.pose())
    });
    let vehicle = Vehicle { drive, sensor };
    let mut agent = Agent::new(planner, vehicle, field::start()?);
    while let Event::Step(step) = agent.step()? {
        println!("{:?} at {:?}", step.reading, step.pose.site);
    }
    field::report(agent.estimate(), 0.3)
}
