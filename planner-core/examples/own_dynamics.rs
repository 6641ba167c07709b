//! Your own dynamics: a robot that pivots in notches of 5 degrees, up to 90 to either side, then drives straight on by
//! steps of 25 cm. A robot that does not pivot implements `Dynamics` instead.
//!
//! `cargo run -p planner-core --example own_dynamics`

mod field;

use field::{Result, World};
use planner_core::dynamics::{ActionGrid, Pivots, check};
use planner_core::{Angle, Lookahead, Plan, Planner as _, VersionSpace};

struct Notches(ActionGrid);

/// Notches to a side.
const MOST: u32 = 18;

impl Pivots for Notches {
    fn grid(&self) -> ActionGrid {
        self.0
    }

    /// A whole turn is 2^32.
    fn turn(&self, n: u32) -> Angle {
        Angle(n * ((1 << 32) / 72_u64) as u32)
    }
}

fn main() -> Result {
    // So many rays, from standing still to 16 steps of 250 mm.
    let dynamics = Notches(ActionGrid::new(2 * MOST + 1, 17, 250)?);
    check(&dynamics)?; // in a test of yours

    let world = World::new()?;
    let belief = VersionSpace::<32>::new(&field::given()?)?;
    let mut planner = Lookahead::new(field::area()?, dynamics, belief)?;
    for _ in 0..24 {
        let Plan::Move(motion) = planner.plan(world.pose()) else { break };
        let control = motion.control;
        println!("{:+4.0} degrees, {:.2} m", control.turn_rad.to_degrees(), control.distance_m);
        world.go(motion.target);
        let reading = motion.wants_label.then(|| world.label().into());
        planner.observe(world.pose(), reading)?;
    }
    field::report(planner.estimate(), 0.5)
}
