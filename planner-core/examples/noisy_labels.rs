//! Labels that are sometimes wrong: the planner is told how often they are right, and tells how sure it is.
//!
//! `cargo run -p planner-core --example noisy_labels`

mod field;

use field::{Result, World};
use planner_core::belief::goal::Accuracy;
use planner_core::{
    Belief as _, Forecast, Goal, Heading, Lookahead, Noise, Plan, Planner as _, Posterior, Prior,
    Reliability, Unicycle,
};

pub(crate) fn main() -> Result {
    let world = World::new()?;
    let reliability = Reliability::new(0.85).ok_or("no probability")?; // twenty labels where the truth is known
    let noise = Noise { reliability, ..Noise::NONE };
    // Room for 40 samples and all 667 sequences of labels that 36 of them can have.
    let forecast = Forecast::<40, 667>::new(&field::given()?, Prior::Area, noise)?;
    // Until all lines of the 90 % credible set differ by 8 degrees at most.
    let slopes = Heading::from_radians(8_f64.to_radians()).ok_or("no angle")?;
    let goal = Goal { accuracy: Accuracy::SlopeArc(slopes), level: 900_000 };
    let mut planner =
        Lookahead::new(field::config()?, Unicycle::paper(), forecast)?.until(Some(goal));
    let mut labels = 0;
    let reason = loop {
        let motion = match planner.plan(world.pose()) {
            Plan::Move(motion) => motion,
            Plan::Stop(reason) => break reason,
        };
        world.go(motion.target);
        let reading = motion.wants_label.then(|| {
            labels += 1;
            let is_wrong = labels % 7 == 3; // one in seven
            if is_wrong { -world.label() } else { world.label() }
        });
        planner.observe(world.pose(), reading.map(Into::into))?;
    };
    let table = planner.belief();
    println!("{reason:?} after {labels} labels: {:.1} bits", table.information());
    println!("{} sequences of labels are possible", table.iter().len());
    field::report(Posterior::new(table).mean(), 2.0)
}
