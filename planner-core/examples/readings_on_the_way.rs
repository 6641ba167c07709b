//! Several readings on the way: where a reading costs little, take some along each motion. What is certain before
//! tells nothing and takes up room, so ask the belief first.
//!
//! `cargo run -p planner-core --example readings_on_the_way`

mod field;

use field::{Result, World};
use planner_core::nalgebra::Point2;
use planner_core::{Certainty, Lookahead, Plan, Planner as _, Pose, Unicycle, VersionSpace};

/// Readings along a motion, the one at its end included.
const READINGS: i32 = 5;

fn main() -> Result {
    let world = World::new()?;
    let space = VersionSpace::<68>::new(&field::given()?)?;
    let mut planner = Lookahead::new(field::area()?, Unicycle::paper(), space)?;
    let mut motions = 0;
    while motions < 12 {
        let from = Point2::<f64>::from(world.pose().site);
        let Plan::Move(motion) = planner.plan(world.pose()) else { break };
        motions += 1;
        let way = Point2::from(motion.target.site) - from;
        for k in 1..=READINGS {
            let is_end = k == READINGS;
            let place = from + way * f64::from(k) / f64::from(READINGS);
            world.go(if is_end { motion.target } else { Pose::at(place, motion.target.heading)? });
            // The planner counts on the label at the end; the others are a gift.
            let asks = planner.belief().certainty(world.pose().site) == Certainty::Uncertain;
            let reading = (asks || is_end && motion.wants_label).then(|| world.label().into());
            if reading.is_some() || is_end {
                planner.observe(world.pose(), reading)?;
            }
        }
    }
    let labels = planner.belief().samples().len() - 4;
    println!("{motions} motions, {labels} labels");
    field::report(planner.estimate(), 0.05)
}
