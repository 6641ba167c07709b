//! Your own dynamics: which motions there are from a pose, grouped by their direction. The search skips motions by
//! what the trait promises, so check yours.
//!
//! This robot pivots in notches of 5 degrees, up to 90 to either side, then drives straight on by steps of 25 cm.
//!
//! `cargo run -p planner-core --example own_dynamics`

mod field;

use std::f64::consts::TAU;

use field::{Result, World};
use planner_core::motion::action::{Action, ActionGrid, Control};
use planner_core::motion::contract;
use planner_core::motion::dynamics::{Dynamics, Fan, Ray, Side};
use planner_core::{Heading, Lookahead, Plan, Planner as _, Pose, VersionSpace};

struct Notches(ActionGrid);

/// A notch; a turn is 2^32 of a heading's units.
const NOTCH: u32 = ((1 << 32) / 72_u64) as u32;
/// Notches to a side.
const MOST: u32 = 18;

impl Dynamics for Notches {
    fn grid(&self) -> ActionGrid {
        self.0
    }

    fn fan(&self) -> Fan {
        Fan { left: MOST + 1, right: MOST, spacing: Heading(NOTCH) }
    }

    fn heading(&self, pose: Pose, side: Side, n: u32) -> Heading {
        let turn = Heading(NOTCH * n);
        pose.heading.turned(if side == Side::Left { turn } else { turn.mirrored() })
    }

    fn ray(&self, pose: Pose, side: Side, n: u32) -> Ray {
        let heading = self.heading(pose, side, n);
        let step = heading.unit().scaled(self.0.step_length());
        // Indices count from the sharpest right turn to the sharpest left one.
        let index = if side == Side::Left { MOST + n } else { MOST - n };
        Ray { index, heading, step, effort: effort(n) }
    }

    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray> {
        let (side, n) = notches(self.0.split(action).0)?;
        Some(self.ray(pose, side, n))
    }

    fn turn_in_place(&self, pose: Pose, side: Side) -> Option<(Action, Pose)> {
        let ray = self.ray(pose, side, MOST);
        Some((self.0.action(ray.index, 0), Pose { heading: ray.heading, ..pose }))
    }

    /// What your drive is told: metres, and radians to the left.
    fn control(&self, action: Action) -> Control {
        let (index, speed) = self.0.split(action);
        let turn = f64::from(index as i32 - MOST as i32) * TAU / 72.0;
        Control { v: self.0.reach_m(speed), w: turn as f32 }
    }
}

/// The square of a turn, mrad^2.
fn effort(n: u32) -> u32 {
    let mrad = n * 87;
    mrad * mrad
}

fn notches(index: u32) -> Option<(Side, u32)> {
    let side = if index < MOST { Side::Right } else { Side::Left };
    (index <= 2 * MOST).then_some((side, index.abs_diff(MOST)))
}

pub(crate) fn main() -> Result {
    // So many rays, from standing still to 16 steps of 250 mm.
    let dynamics = Notches(ActionGrid::new(2 * MOST + 1, 17, 250)?);
    contract::check(&dynamics)?; // in a test of yours

    let world = World::new()?;
    let space = VersionSpace::<32>::new(&field::given()?)?;
    let mut planner = Lookahead::new(field::config()?, dynamics, space)?;
    for _ in 0..24 {
        let Plan::Move(motion) = planner.plan(world.pose()) else { break };
        println!("{:+4.0} degrees, {:.2} m", motion.control.w.to_degrees(), motion.control.v);
        world.go(motion.target);
        let reading = motion.wants_label.then(|| world.label().into());
        planner.observe(world.pose(), reading)?;
    }
    field::report(planner.estimates().centre, 0.5)
}
