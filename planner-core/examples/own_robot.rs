//! Your own robot: a drive, a label sensor, and the loop that joins them to a planner.
//!
//! `cargo run -p planner-core --example own_robot`

mod field;

use std::convert::Infallible;

use field::{Result, World};
use planner_core::robot::{DriveFn, SensorFn};
use planner_core::{Agent, Event, Goal, Lookahead, Motion, Unicycle, Vehicle, VersionSpace};

fn main() -> Result {
    let world = World::new()?;
    // What commands your motors. Its error is yours: a stall, a lost position.
    let drive = DriveFn(|motion: &Motion| {
        let control = motion.control; // turn to the left, then drive straight on
        println!("turn {:+.3} rad, drive {:.2} m", control.turn_rad, control.distance_m);
        world.go(motion.target);
        Ok::<_, Infallible>(world.pose()) // where localisation says that you are
    });
    // What tells on which side you are.
    let sensor = SensorFn(|| Ok::<_, Infallible>(world.label()));

    let belief = VersionSpace::<32>::new(&field::given()?)?;
    let planner = Lookahead::new(field::area()?, Unicycle::default(), belief)?
        .until(Goal::slope_within_degrees(0.2)?);
    let mut agent = Agent::new(planner, Vehicle { drive, sensor }, field::start()?);
    while let Event::Step(step) = agent.step()? {
        println!("  read {:?}", step.reading);
    }
    field::report(agent.estimate(), 0.05)
}
