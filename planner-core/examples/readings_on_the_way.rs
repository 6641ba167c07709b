//! Several readings on the way: where a reading costs little, take some along each motion. The drive reports where it is
//! as it goes, and the vehicle reads a label there. The planner keeps a label if it tells something. The buffer has room for
//! fewer samples than there are labels: what no longer matters makes room.
//!
//! `cargo run -p planner-core --example readings_on_the_way`

mod field;

use std::convert::Infallible;

use field::{Result, World};
use planner_core::nalgebra::Point2;
use planner_core::robot::{Drive, SensorFn};
use planner_core::{
    Agent, Event, Lookahead, Motion, Planner as _, Pose, Site, Unicycle, Vehicle, VersionSpace,
};

/// Readings along a motion, the one at its end included.
const READINGS: i32 = 5;

/// A drive that reports where it is at even distances.
struct Tracks<'a>(&'a World);

impl Drive for Tracks<'_> {
    type Error = Infallible;

    fn drive(&mut self, motion: &Motion) -> std::result::Result<Pose, Infallible> {
        self.0.go(motion.target);
        Ok(motion.target)
    }

    fn drive_reporting(
        &mut self,
        motion: &Motion,
        report: &mut dyn FnMut(Site),
    ) -> std::result::Result<Pose, Infallible> {
        let from = Point2::<f64>::from(self.0.pose().site);
        let way = Point2::from(motion.target.site) - from;
        for k in 1..READINGS {
            let place = from + way * f64::from(k) / f64::from(READINGS);
            if let Ok(pose) = Pose::at(place, motion.target.heading) {
                self.0.go(pose);
                report(pose.site);
            }
        }
        self.drive(motion)
    }
}

fn main() -> Result {
    let world = World::new()?;
    let space = VersionSpace::<16>::new(&field::given()?)?;
    let planner = Lookahead::new(field::area()?, Unicycle::paper(), space)?;
    let sensor = SensorFn(|| Ok::<_, Infallible>(world.label()));
    let vehicle = Vehicle { drive: Tracks(&world), sensor };
    let mut agent = Agent::new(planner, vehicle, field::start()?);
    let mut motions = 0;
    while motions < 12 {
        let Event::Step(_) = agent.step()? else { break };
        motions += 1;
    }
    let kept = agent.planner.belief().samples().len();
    println!("{motions} motions, {} readings, {kept} samples kept", READINGS * motions);
    field::report(agent.estimate(), 0.01)
}
