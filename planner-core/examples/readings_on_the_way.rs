//! Several readings on the way: where a reading costs little, take some along each motion. What is certain before
//! tells nothing and takes up room, so ask the belief first.
//!
//! `cargo run -p planner-core --example readings_on_the_way`

mod field;

use field::{Result, World};
use planner_core::belief::consistent_lines::Certainty;
use planner_core::geometry::lattice::Vector;
use planner_core::{Lookahead, Plan, Planner as _, Pose, Unicycle, VersionSpace};

/// Readings along a motion, the one at its end included.
const READINGS: i32 = 5;

pub(crate) fn main() -> Result {
    let world = World::new()?;
    let space = VersionSpace::<68>::new(&field::given()?)?;
    let mut planner = Lookahead::new(field::config()?, Unicycle::paper(), space)?;
    let mut motions = 0;
    while motions < 12 {
        let from = world.pose().site;
        let Plan::Move(motion) = planner.plan(world.pose()) else { break };
        motions += 1;
        let way = motion.target.site - from;
        for k in 1..=READINGS {
            let so_far = Vector::new(way.x() / READINGS * k, way.z() / READINGS * k);
            let site = from.step(so_far.ok_or("too long a motion")?)?;
            let is_end = k == READINGS;
            world.go(if is_end { motion.target } else { Pose { site, ..motion.target } });
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
    field::report(planner.estimates().centre, 0.05)
}
