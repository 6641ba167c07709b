//! The program of the README: a line, a drive and a sensor.
//!
//! `cargo run -p planner-core --example first`

use std::{cell::Cell, convert::Infallible, error::Error};

use planner_core::nalgebra::Point2;
use planner_core::robot::{DriveFn, SensorFn};
use planner_core::{Agent, Area, Event, Goal, Heading, Label, Lookahead};
use planner_core::{Motion, Pose, Sample, Unicycle, Vehicle, VersionSpace};

fn main() -> Result<(), Box<dyn Error>> {
    let start = Pose::at([2.0, 1.0], Heading::default())?;
    let robot = Cell::new(start); // stands for your robot
    let drive = DriveFn(|motion: &Motion| {
        robot.set(motion.target); // command your motors here
        Ok::<_, Infallible>(robot.get()) // where the motion ended
    });
    let sensor = SensorFn(|| {
        let at = Point2::<f64>::from(robot.get().site); // read your sensor here
        let is_above = at.y > 0.41 * at.x + 3.5;
        Ok::<_, Infallible>(if is_above { Label::Positive } else { Label::Negative })
    });
    let given = [
        Sample::at([2.0, 1.0], Label::Negative)?,
        Sample::at([2.0, 8.0], Label::Positive)?,
        Sample::at([18.0, 16.0], Label::Positive)?,
        Sample::at([18.0, 5.0], Label::Negative)?,
    ];
    let belief = VersionSpace::<32>::new(&given)?.with_tolerance(0.01)?; // positions err by 1 cm at most
    let area = Area::metres([0.0, 0.0], [20.0, 20.0])?;
    let goal = Goal::slope_within_degrees(0.5)?;
    let planner = Lookahead::new(area, Unicycle::default(), belief)?.until(goal);
    let mut agent = Agent::new(planner, Vehicle { drive, sensor }, start);
    while let Event::Step(step) = agent.step()? {
        println!("{:?}", step.reading);
    }
    println!("{}", agent.estimate().ok_or("no estimate")?); // about z = 0.41 x + 3.5
    Ok(())
}
