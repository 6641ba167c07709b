//! Labels that are sometimes wrong: the planner is told how often they are right, and says how sure it is.
//!
//! `cargo run -p planner-core --example noisy_labels`

mod field;

use field::{Result, World};
use planner_core::{
    Belief as _, Goal, Lookahead, Noise, NoisyBelief, Plan, Planner as _, Unicycle, sequences_of,
};

fn main() -> Result {
    let world = World::new()?;
    let noise = Noise::new(0.85)?; // measured: twenty labels where the truth is known
    let belief = NoisyBelief::<40, { sequences_of(36) }>::new(&field::given()?, noise)?;
    // With probability 0.9, any two of the lines left differ by 8 degrees at most.
    let goal = Goal::slope_within_degrees(8.0)?.with_confidence(0.9)?;
    let mut planner = Lookahead::new(field::area()?, Unicycle::paper(), belief)?.until(goal);
    let mut labels = 0;
    while let Plan::Move(motion) = planner.plan(world.pose()) {
        world.go(motion.target);
        labels += u32::from(motion.wants_label);
        let label = if labels % 7 == 3 { -world.label() } else { world.label() }; // one in seven is wrong
        planner.observe(world.pose(), motion.wants_label.then(|| label.into()))?;
    }
    println!("{labels} labels told {:.1} bits", planner.belief().information());
    field::report(planner.estimate(), 2.0)
}
