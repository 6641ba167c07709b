//! The simulated world: a true line, a sensor that reads its labels, a vehicle that moves as told.

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use nalgebra::Point2;
use planner_core::belief::candidates::Candidates;
use planner_core::belief::sample::{Label, Reading, Sample};
use planner_core::belief::weight::Reliability;
use planner_core::geometry::lattice::Site;
use planner_core::geometry::line::Line;
use planner_core::motion::dynamics::Pose;
use planner_core::planner::Motion;
use planner_core::planner::scc::Noise;
use planner_core::robot::hal::{Drive, LabelSensor};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// What a perfect sensor reads at a position.
pub fn reading(truth: &Line, site: Site) -> Reading {
    let distance = truth.distance(Point2::from(site));
    if distance > 0.0 {
        Label::Positive.into()
    } else if distance < 0.0 {
        Label::Negative.into()
    } else {
        Reading::Boundary
    }
}

/// Whether a line is among the candidates: it has the labels that their cell gives its samples.
pub fn agrees(line: &Line, candidates: Candidates<'_>) -> bool {
    candidates.support().all(|s| reading(line, s.site) == Reading::Side(s.label))
}

/// How the simulated world flips labels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseModel {
    /// Where labels can be wrong, they are true with this probability.
    pub p: f64,
    /// Where that is.
    pub extent: Extent,
}

/// Where labels can be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Outside balls of this radius around the oracle's points, metres.
    OutsideBalls(f64),
    /// Within this distance of the true line, metres (Section II-B's `c_bar`): what a planner cannot
    /// know.
    Band(f64),
}

/// Where the vehicle is: shared by the vehicle and the sensor it carries.
pub type Whereabouts = Rc<Cell<Pose>>;

/// A label sensor that cannot fail.
pub type Sensor = Box<dyn LabelSensor<Error = Infallible>>;

/// A sensor whose labels are sometimes flipped: a wrapper around any other.
pub struct Flipped<S> {
    /// The sensor.
    pub sensor: S,
    /// How labels are flipped.
    pub model: NoiseModel,
    /// The true line.
    pub truth: Line,
    /// What a planner knows of the noise, for the trusted balls.
    pub noise: Noise,
    /// The oracle's samples.
    pub given: Vec<Sample>,
    /// Where the vehicle is.
    pub pose: Whereabouts,
    /// The source of chance.
    pub rng: ChaCha8Rng,
}

impl<S: LabelSensor> LabelSensor for Flipped<S> {
    type Error = S::Error;

    fn read(&mut self) -> Result<Reading, S::Error> {
        let reading = self.sensor.read()?;
        let site = self.pose.get().site;
        let exposed = match self.model.extent {
            Extent::OutsideBalls(_) => self.noise.at(site, &self.given) != Reliability::CERTAIN,
            Extent::Band(half) => self.truth.distance(Point2::from(site)).abs() <= half,
        };
        // Drawn whether it is used or not, so that a path's noise does not depend on its places.
        let flips = self.rng.random_range(0.0..1.0) >= self.model.p;
        Ok(match reading {
            Reading::Side(label) if exposed && flips => Reading::Side(-label),
            reading => reading,
        })
    }
}

/// A vehicle that reaches the target of every motion.
pub struct Vehicle {
    /// Where it is.
    pub pose: Whereabouts,
}

impl Drive for Vehicle {
    type Error = Infallible;

    fn drive(&mut self, motion: &Motion) -> Result<Pose, Infallible> {
        self.pose.set(motion.target);
        Ok(motion.target)
    }
}

/// A perfect label sensor, carried by the vehicle.
pub struct Probe {
    /// The true line.
    pub truth: Line,
    /// Where the vehicle is.
    pub pose: Whereabouts,
}

impl LabelSensor for Probe {
    type Error = Infallible;

    fn read(&mut self) -> Result<Reading, Infallible> {
        Ok(reading(&self.truth, self.pose.get().site))
    }
}
