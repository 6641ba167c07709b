//! A garden: an L-shaped lawn with two trees, a rover whose odometry drifts between fixes, and labels of which one in ten
//! is wrong. The L is a square with a keep-out in its far corner.
//!
//! `cargo run -p planner-core --example garden`

mod field;

use std::convert::Infallible;

use field::Result;
use planner_core::nalgebra::{Point2, Vector2};
use planner_core::robot::Body;
use planner_core::{
    Agent, Event, Goal, KeepOut, Label, Lookahead, Motion, Noise, NoisyBelief, PolygonArea, Pose,
    Reading, Sample, Site, Unicycle, Workspace as _, sequences_of,
};

/// Hulls of four corners at most, and three keep-outs.
type Lawn = PolygonArea<4, 3>;

fn lawn() -> Result<Lawn> {
    let corner = KeepOut::polygon(&[[12.0, 12.0], [20.0, 12.0], [20.0, 20.0], [12.0, 20.0]])?;
    let trees = [KeepOut::disc([5.0, 5.8], 0.4)?, KeepOut::disc([14.0, 9.0], 0.5)?];
    let square = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]];
    Ok(Lawn::metres(&square, &[corner, trees[0], trees[1]])?)
}

/// A rover that pivots, then drives. Its wheels err by 1 % of the way, its compass by up to a degree. At the first stop
/// after 2 m it takes a fix.
struct Rover {
    lawn: Lawn,
    truth: Point2<f64>,
    believed: Point2<f64>,
    since_fix: f64,
    motions: usize,
    labels: usize,
}

/// The most that its position is off, metres: 3 cm by the fix, and 1 % and a degree of 4 m. A motion has 2 m.
const MOST_OFF: f64 = 0.14;

impl Body for Rover {
    type Error = Infallible;

    fn perform(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
    ) -> std::result::Result<Option<Reading>, Infallible> {
        let way = Point2::from(motion.target.site) - self.believed;
        let aside = [0.017, 0.006, -0.011, -0.017, 0.003][self.motions % 5];
        let true_way = 1.01 * way + aside * Vector2::new(-way.y, way.x);
        for part in 0..=100 {
            let place = Site::try_from(self.truth + true_way * f64::from(part) / 100.0);
            assert!(
                place.is_ok_and(|it| self.lawn.contains(it)),
                "it touches a tree or the border"
            );
        }
        self.truth += true_way;
        self.believed += way;
        self.motions += 1;
        self.since_fix += way.norm();
        if self.since_fix >= 2.0 {
            self.believed = self.truth + Vector2::new(0.02, -0.02);
            self.since_fix = 0.0;
        }
        assert!((self.truth - self.believed).norm() < MOST_OFF);
        let site = Site::try_from(self.believed).unwrap_or(motion.target.site);
        *pose = Pose { site, heading: motion.target.heading };
        Ok(motion.wants_label.then(|| self.read().into()))
    }
}

impl Rover {
    fn read(&mut self) -> Label {
        self.labels += 1;
        let is_above = self.truth.y > 0.41 * self.truth.x + 3.5;
        let is_wrong = self.labels % 10 == 4;
        if is_above == is_wrong { Label::Negative } else { Label::Positive }
    }
}

fn main() -> Result {
    let given = [
        Sample::at([2.0, 1.0], Label::Negative)?,
        Sample::at([2.0, 8.0], Label::Positive)?,
        Sample::at([10.0, 16.0], Label::Positive)?,
        Sample::at([18.0, 5.0], Label::Negative)?,
    ];
    let noise = Noise::new(0.9)?.with_tolerance(MOST_OFF)?;
    let belief = NoisyBelief::<40, { sequences_of(36) }>::new(&given, noise)?;
    // With probability 0.9, any two of the lines left differ by 6 degrees at most.
    let goal = Goal::slope_within_degrees(6.0)?.with_confidence(0.9)?;
    let planner = Lookahead::new(lawn()?, Unicycle::paper(), belief)?.until(goal);
    let start = field::start()?;
    let [truth, believed] = [start.site.into(); 2];
    let rover = Rover { lawn: lawn()?, truth, believed, since_fix: 0.0, motions: 0, labels: 0 };
    let mut agent = Agent::new(planner, rover, start);
    let reason = loop {
        if let Event::Stopped(reason) = agent.step()? {
            break reason;
        }
    };
    let Rover { motions, labels, .. } = agent.body();
    println!("{reason:?} after {motions} motions and {labels} labels");
    println!("z = 0.4100 x + 3.5000 is the truth");
    field::report(agent.estimate(), 0.5)
}
