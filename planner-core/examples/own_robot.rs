//! Your own robot: a drive and a label sensor, and the loop that joins them to a planner.
//!
//! `cargo run -p planner-core --example own_robot`

mod field;

use std::convert::Infallible;

use field::{Result, World};
use planner_core::{
    Agent, Belief as _, Drive, Event, Goal, LabelSensor, Lookahead, Motion, Planner as _, Pose,
    Reading, Unicycle, Vehicle, VersionSpace, belief::goal::Accuracy, geometry::heading::Heading,
};

/// What commands your motors and knows where they brought you.
struct Tracks<'a>(&'a World);

impl Drive for Tracks<'_> {
    type Error = Infallible; // yours: a stall, a lost position

    fn drive(&mut self, motion: &Motion) -> std::result::Result<Pose, Infallible> {
        let turn_rad = motion.control.w; // first turn so far to the left,
        let metres = motion.control.v; // then drive so far
        println!("turn {turn_rad:+.3} rad, drive {metres:.2} m");
        self.0.go(motion.target);
        Ok(self.0.pose()) // where localisation says that you are
    }
}

/// What tells on which side you are.
struct Probe<'a>(&'a World);

impl LabelSensor for Probe<'_> {
    type Error = Infallible;

    fn read(&mut self) -> std::result::Result<Reading, Infallible> {
        Ok(self.0.label().into())
    }
}

pub(crate) fn main() -> Result {
    let world = World::new()?;
    let space = VersionSpace::<32>::new(&field::given()?)?;
    let slopes = Heading::from_radians(0.2_f64.to_radians()).ok_or("no angle")?;
    let goal = Goal { accuracy: Accuracy::SlopeArc(slopes), level: 0 };
    let planner = Lookahead::new(field::config()?, Unicycle::paper(), space)?.until(Some(goal));
    let vehicle = Vehicle { drive: Tracks(&world), sensor: Probe(&world) };
    let mut agent = Agent::new(planner, vehicle, field::start()?);
    loop {
        match agent.step()? {
            Event::Step(step) => println!("  read {:?}", step.reading),
            Event::Stopped(reason) => break println!("stopped: {reason:?}"),
        }
    }
    let belief = agent.planner.belief();
    println!("{} samples told {:.1} bits", belief.samples().len(), belief.information());
    field::report(agent.planner.estimates().centre, 0.05)
}
