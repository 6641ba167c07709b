//! Draws a garden: the lawn with its trees, the true line, the labelled places that are given, and the start.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Point2, Vector2};
use planner_core::geometry::lattice::UNITS_PER_METRE;
use planner_core::motion::car::{self};
use planner_core::{
    AnyVehicle, Car, Heading, Hull, KeepOut, Label, Line, PolygonArea, Pose, Sample, Site,
    Tolerance, Unicycle, VersionSpace,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::rover::{Drift, Fixes};
use crate::anything::plain::{Ground, Point};

/// The lawn as the planner has it: a square with three keep-outs.
pub type Lawn = PolygonArea<4, 3>;

/// The side of the square, metres.
pub const SIDE: f64 = 20.0;

/// The keep-out that makes the lawn an L: from here to the far corner of the square.
const CORNER: f64 = 12.0;

/// How far the given places are from the line at least, metres.
const FAR: f64 = 1.0;

/// Where a mission starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Anywhere that is further than the tolerance from trees, corner and border.
    Anywhere,
    /// Nearer to a tree, the corner or the border than the tolerance, but not within the error of a fix.
    Near,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vehicle {
    /// It turns on the spot.
    Unicycle,
    /// It drives along arcs, with a turning circle of 1 m.
    Car,
}

/// What all missions of a table have in common.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// What moves.
    pub vehicle: Vehicle,
    /// The longest motion, metres.
    pub reach: f64,
    /// How the odometry drifts.
    pub drift: Drift,
    /// When a fix is taken.
    pub fixes: Fixes,
    /// How often a label is right.
    pub p: f64,
    /// Where a mission starts.
    pub start: Start,
    /// How much the planner's keep-outs and border exceed the trees, the corner and the border, metres.
    pub padding: f64,
    /// The belief's tolerance: three standard deviations of position errors an axis, metres.
    pub blur: f64,
    /// The price of driving in look-ahead.
    pub varrho: f64,
}

impl Setting {
    /// The garden of the acceptance test.
    pub const GARDEN: Self = Self {
        vehicle: Vehicle::Unicycle,
        reach: 3.0,
        drift: Drift::ROVER,
        fixes: Fixes::UnderWay,
        p: 0.97,
        start: Start::Anywhere,
        padding: 0.0,
        blur: 0.1,
        varrho: 0.000_5,
    };

    /// The largest error of a position, metres. It is the planner's clearance.
    pub fn largest_error(&self) -> f64 {
        let overrun = match self.fixes {
            Fixes::UnderWay => 0.0,
            Fixes::AtStops => self.longest(),
        };
        self.drift.most_after(self.drift.every + overrun)
    }

    /// The longest way of a motion: an arc of a quarter turn is longer than its chord.
    fn longest(&self) -> f64 {
        match self.vehicle {
            Vehicle::Unicycle => self.reach,
            Vehicle::Car => self.reach * FRAC_PI_2 / std::f64::consts::SQRT_2,
        }
    }

    /// The vehicle, with this angle between its rays.
    ///
    /// # Panics
    /// When there is no such vehicle.
    pub fn dynamics(&self, turn_step_urad: u32) -> AnyVehicle {
        let (speeds, speed_step_mm) = (31, (1e3 * self.reach / 30.0) as u32);
        match self.vehicle {
            Vehicle::Unicycle => {
                let grid = Unicycle::new(turn_step_urad, FRAC_PI_2, speeds, speed_step_mm);
                AnyVehicle::Unicycle(grid.expect("a grid"))
            }
            Vehicle::Car => {
                let shape = car::Shape {
                    radius_mm: 1_000,
                    shortest_mm: 300,
                    turn_step_urad,
                    speeds,
                    speed_step_mm,
                };
                AnyVehicle::Car(Car::new(shape).expect("a car"))
            }
        }
    }
}

/// A mission in a garden.
#[derive(Clone, Debug)]
pub struct Garden {
    /// Its number, from which all that is random follows.
    pub number: u64,
    /// What it has in common with others.
    pub setting: Setting,
    /// The area as the planner has it.
    pub lawn: Lawn,
    /// Where the rover truly may be.
    pub ground: Ground,
    /// The true line.
    pub line: Line,
    /// Two places of either label.
    pub given: [Sample; 4],
    /// Where it starts.
    pub start: Pose,
}

impl Garden {
    /// The mission with this number.
    pub fn draw(setting: Setting, number: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(210_000 + number);
        loop {
            if let Some(garden) = attempt(setting, number, &mut rng) {
                return garden;
            }
        }
    }

    /// The largest error of a position.
    ///
    /// # Panics
    /// When it is more than a kilometre.
    pub fn tolerance(&self) -> Tolerance {
        Tolerance::new(self.setting.largest_error()).expect("a tolerance")
    }
}

fn site([x, z]: Point) -> Site {
    Site::try_from(Point2::new(x, z)).expect("near")
}

fn anywhere(rng: &mut ChaCha8Rng) -> Point {
    [rng.random_range(0.0..SIDE), rng.random_range(0.0..SIDE)]
}

fn attempt(setting: Setting, number: u64, rng: &mut ChaCha8Rng) -> Option<Garden> {
    let trees = [(); 2].map(|()| (anywhere(rng), rng.random_range(0.3..0.5)));
    let square = |from: f64, to: f64| vec![[from, from], [to, from], [to, to], [from, to]];
    let ground = Ground {
        border: square(0.0, SIDE),
        keep_outs: [(square(CORNER, SIDE), 0.0)]
            .into_iter()
            .chain(trees.map(|(middle, radius)| (vec![middle], radius)))
            .collect(),
    };
    let line = {
        let point = Point2::from(anywhere(rng));
        let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
        Line::through(point, Vector2::new(cos, sin))?
    };
    let error = setting.largest_error();
    let clear = |rng: &mut ChaCha8Rng| {
        (0..200).map(|_| anywhere(rng)).find(|p| ground.margin(*p) > error + setting.padding + 0.01)
    };
    let mut given = Vec::new();
    for label in [Label::Negative, Label::Positive, Label::Positive, Label::Negative] {
        let place = (0..100)
            .filter_map(|_| clear(rng))
            .find(|p| f64::from(label.sign()) * line.distance(Point2::from(*p)) > FAR)?;
        given.push(Sample { site: site(place), label });
    }
    let given = <[Sample; 4]>::try_from(given).ok()?;
    VersionSpace::<4>::new(&given).ok()?;
    let start = match setting.start {
        Start::Anywhere => clear(rng)?,
        Start::Near => {
            let near = setting.drift.fix + 0.01..error;
            (0..5_000).map(|_| anywhere(rng)).find(|p| near.contains(&ground.margin(*p)))?
        }
    };
    let start = Pose { site: site(start), heading: Heading(rng.random()) };
    Some(Garden {
        number,
        setting,
        lawn: lawn(&ground, setting.padding)?,
        ground,
        line,
        given,
        start,
    })
}

/// The ground as an area for the planner. All keep-outs are wider by some metres, and the border is as much inside.
fn lawn(ground: &Ground, padding: f64) -> Option<Lawn> {
    let hull =
        |corners: &[Point]| Hull::new(&corners.iter().copied().map(site).collect::<Vec<_>>()).ok();
    let moved = |[x, z]: Point| [x, z].map(|v| v.clamp(padding, SIDE - padding));
    let border: Vec<Point> = ground.border.iter().copied().map(moved).collect();
    let keep_out = |(corners, radius): &(Vec<Point>, f64)| {
        let radius = ((radius + padding) * f64::from(UNITS_PER_METRE)).ceil() as u32;
        Some(KeepOut { hull: hull(corners)?, radius })
    };
    let keep_outs: Option<Vec<_>> = ground.keep_outs.iter().map(keep_out).collect();
    PolygonArea::new(hull(&border)?, &keep_outs?).ok()
}
