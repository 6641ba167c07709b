//! A rover whose odometry drifts until a fix: where it truly is, where it believes it is, and what it senses.

use std::convert::Infallible;
use std::f64::consts::TAU;

use nalgebra::Point2;
use planner_core::robot::Body;
use planner_core::{Heading, Label, Motion, Pose, Reading, Site};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::lawn::{Garden, Vehicle};
use crate::anything::plain::{Point, metres};

/// The distance between points at which the true path is checked, metres.
const STEP: f64 = 0.02;

/// The rover stops when it believes to be this near to its target, metres.
const ARRIVED: f64 = 0.01;

/// How odometry drifts. All errors have a largest one, so that the largest error of a position is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// How far the wheels' idea of a metre may be off, as a share. It changes with every fix.
    pub scale: f64,
    /// How far the compass may be off, radians. It wanders.
    pub compass: f64,
    /// How far a fix may be off, metres.
    pub fix: f64,
    /// A fix is taken after this many metres.
    pub every: f64,
}

impl Drift {
    /// 1 % of the way, a compass that is off by one degree at most, and a fix to 3 cm each 8 m.
    pub const ROVER: Self = Self { scale: 0.01, compass: 0.01745, fix: 0.03, every: 8.0 };

    /// The largest error of a position, `way` metres after a fix.
    ///
    /// A metre that is believed is truly `(1 + s)` metres, turned by `c`. The difference of the two is `s + 2 sin(c /
    /// 2)` at most. The last term is for steps that overrun the place of the fix.
    pub fn most_after(&self, way: f64) -> f64 {
        self.fix + (self.scale + 2.0 * (0.5 * self.compass).sin()) * (way + STEP) + 1e-3
    }
}

/// When a fix is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fixes {
    /// As soon as [`Drift::every`] metres are driven. The rover then steers from where it is to the motion's target.
    UnderWay,
    /// At the end of the motion in which they are driven. The pose that the planner gets is then not the target.
    AtStops,
}

/// The rover of a garden.
#[derive(Clone, Debug)]
pub struct Rover<'a> {
    garden: &'a Garden,
    rng: ChaCha8Rng,
    sensor: ChaCha8Rng,
    truth: Point,
    believed: Point,
    heading: f64,
    scale: f64,
    compass: f64,
    since_fix: f64,
    /// Metres driven.
    pub driven: f64,
    /// The least distance of the true path from a tree, the corner or the border, and where; negative after a bump.
    pub nearest: (f64, Point),
    /// The largest error of a position so far.
    pub most_off: f64,
    /// The sum of the squares of position errors at labels, and how many there were.
    squares: f64,
    reads: f64,
}

impl<'a> Rover<'a> {
    /// The rover at its start, where a fix was taken.
    pub fn new(garden: &'a Garden) -> Self {
        let rng = |stream| {
            let mut rng = ChaCha8Rng::seed_from_u64(garden.number);
            rng.set_stream(stream);
            rng
        };
        let believed = metres(garden.start.site);
        let mut rover = Self {
            garden,
            rng: rng(1),
            sensor: rng(2),
            truth: believed,
            believed,
            heading: garden.start.heading.radians(),
            scale: 0.0,
            compass: 0.0,
            since_fix: 0.0,
            driven: 0.0,
            nearest: (f64::INFINITY, believed),
            most_off: 0.0,
            squares: 0.0,
            reads: 0.0,
        };
        // The error of a fix is as likely either way. Here it moves the truth, so that the start is where it was said
        // to be.
        rover.take_fix();
        let off = [0, 1].map(|i| rover.believed[i] - rover.truth[i]);
        (rover.truth, rover.believed) = ([0, 1].map(|i| believed[i] + off[i]), believed);
        rover
    }

    fn take_fix(&mut self) {
        let drift = self.garden.setting.drift;
        let (sin, cos) = libm::sincos(self.rng.random_range(0.0..TAU));
        let off = drift.fix * self.rng.random_range(0.0..1.0_f64).sqrt();
        self.believed = [self.truth[0] + off * cos, self.truth[1] + off * sin];
        self.scale = drift.scale * self.rng.random_range(-1.0..1.0);
        self.since_fix = 0.0;
    }

    /// Drives a little straight on, by its own beliefs.
    fn advance(&mut self, way: f64) {
        let drift = self.garden.setting.drift;
        let wander = drift.compass * 0.1 * self.rng.random_range(-1.0..1.0);
        self.compass = (self.compass + wander).clamp(-drift.compass, drift.compass);
        let moved = |[x, z]: Point, way: f64, heading: f64| {
            let (sin, cos) = libm::sincos(heading);
            [x + way * cos, z + way * sin]
        };
        self.believed = moved(self.believed, way, self.heading);
        self.truth = moved(self.truth, way * (1.0 + self.scale), self.heading + self.compass);
        (self.since_fix, self.driven) = (self.since_fix + way, self.driven + way);
        let margin = self.garden.ground.margin(self.truth);
        if margin < self.nearest.0 {
            self.nearest = (margin, self.truth);
        }
        self.most_off = self.most_off.max(distance(self.truth, self.believed));
    }

    /// Steers to a place, until it believes to be there. A fix under way changes where it comes from.
    pub fn steer_to(&mut self, target: Point) {
        let setting = self.garden.setting;
        loop {
            let way = distance(self.believed, target);
            if way < ARRIVED {
                return;
            }
            self.heading = libm::atan2(target[1] - self.believed[1], target[0] - self.believed[0]);
            self.advance(way.min(STEP));
            if setting.fixes == Fixes::UnderWay && self.since_fix >= setting.drift.every {
                self.take_fix();
            }
        }
    }

    /// Drives along an arc, whatever a fix says meanwhile.
    fn drive_arc(&mut self, length: f64, turn: f64) {
        let steps = (length / STEP).ceil().max(1.0);
        let half = 0.5 * turn / steps;
        // The polygon's edges are the arc's chords.
        let chord = length / steps * if half == 0.0 { 1.0 } else { libm::sin(half) / half };
        for _ in 0..steps as u32 {
            self.heading += half;
            self.advance(chord);
            self.heading += half;
        }
    }

    /// A fix at a stop, if enough metres are driven.
    pub fn stop(&mut self) {
        let setting = self.garden.setting;
        if self.since_fix >= setting.drift.every {
            self.take_fix();
        }
    }

    /// What its sensor says where it truly is: sometimes the other side.
    pub fn read(&mut self) -> Label {
        self.squares += distance(self.truth, self.believed).powi(2);
        self.reads += 1.0;
        let distance = self.garden.line.distance(Point2::from(self.truth));
        let label = if distance > 0.0 { Label::Positive } else { Label::Negative };
        if self.sensor.random_range(0.0..1.0) < self.garden.setting.p { label } else { -label }
    }

    /// The standard deviation of positions at which labels were read, an axis.
    pub fn deviation(&self) -> f64 {
        (self.squares / (2.0 * self.reads)).sqrt()
    }
}

fn distance(a: Point, b: Point) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

impl Body for Rover<'_> {
    type Error = Infallible;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, Infallible> {
        match self.garden.setting.vehicle {
            Vehicle::Unicycle => {
                self.steer_to(metres(motion.target.site));
                self.heading = motion.target.heading.radians();
            }
            Vehicle::Car => {
                self.drive_arc(motion.control.distance_m.into(), motion.control.turn_rad.into());
            }
        }
        self.stop();
        let site = Site::try_from(Point2::from(self.believed)).expect("near");
        *pose = Pose { site, heading: Heading::from_radians(self.heading).expect("finite") };
        Ok(motion.wants_label.then(|| self.read().into()))
    }
}
