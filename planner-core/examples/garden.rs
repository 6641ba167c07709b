//! A garden: an L-shaped lawn with two trees, a rover whose odometry drifts between fixes, and labels of which one in ten
//! is wrong. The L is a square with a keep-out in its far corner.
//!
//! `cargo run -p planner-core --example garden`

mod field;

use std::convert::Infallible;

use field::{Result, at};
use planner_core::belief::goal::Accuracy;
use planner_core::belief::tolerance::Tolerance;
use planner_core::geometry::lattice::UNITS_PER_METRE;
use planner_core::nalgebra::{Point2, Vector2};
use planner_core::{
    Agent, Body, Config, Crossing, Event, Forecast, Goal, Heading, Hull, Label, Lookahead, Motion,
    Noise, Planner as _, Pose, Prior, Reading, Region as _, Reliability, RoundedHull, Sample, Site,
    Terrain, Unicycle, cfc, lookahead,
};

/// Hulls of four corners at most, and three keep-outs.
type Lawn = Terrain<4, 3>;

fn lawn() -> Result<Lawn> {
    let square = |from: f64, to: f64| -> Result<_> {
        Ok(Hull::new(&[at(from, from)?, at(to, from)?, at(to, to)?, at(from, to)?])?)
    };
    let tree = |x, z, metres: f64| -> Result<_> {
        let radius = (metres * f64::from(UNITS_PER_METRE)).ceil() as u32;
        Ok(RoundedHull { hull: Hull::new(&[at(x, z)?])?, radius })
    };
    let corner = RoundedHull { hull: square(12.0, 20.0)?, radius: 0 };
    let keep_outs = [corner, tree(5.0, 5.8, 0.4)?, tree(14.0, 9.0, 0.5)?];
    Ok(Terrain::new(square(0.0, 20.0)?, &keep_outs)?)
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

pub(crate) fn main() -> Result {
    let given = [
        Sample { site: at(2.0, 1.0)?, label: Label::Negative },
        Sample { site: at(2.0, 8.0)?, label: Label::Positive },
        Sample { site: at(10.0, 16.0)?, label: Label::Positive },
        Sample { site: at(18.0, 5.0)?, label: Label::Negative },
    ];
    let tolerance = Tolerance::new(MOST_OFF).ok_or("no length")?;
    let reliability = Reliability::new(0.9).ok_or("no probability")?;
    let noise = Noise { reliability, tolerance, ..Noise::NONE };
    // Room for 40 samples and all 667 sequences of labels that 36 of them can have.
    let forecast = Forecast::<40, 667>::new(&given, Prior::Area, noise)?;
    let config = Config {
        area: lawn()?,
        varrho: lookahead::VARRHO,
        crossing: Crossing::default(),
        following: cfc::FOLLOWING,
        tolerance,
    };
    // Until all lines of the 90 % credible set differ by 6 degrees at most.
    let slopes = Heading::from_radians(6_f64.to_radians()).ok_or("no angle")?;
    let goal = Goal { accuracy: Accuracy::SlopeArc(slopes), level: 900_000 };
    let planner = Lookahead::new(config, Unicycle::paper(), forecast)?.until(Some(goal));
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
    field::report(agent.planner.estimates().centre, 0.5)
}
