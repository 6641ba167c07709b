//! The simulated world: a true line, a sensor that reads its labels, a vehicle that moves as told.

use std::cell::Cell;
use std::convert::Infallible;

use nalgebra::Point2;
use planner_core::dynamics::Pose;
use planner_core::hal::{Drive, LabelSensor};
use planner_core::lattice::Site;
use planner_core::line::Line;
use planner_core::planner::Motion;
use planner_core::sample::{Label, Reading};

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

/// A vehicle that reaches the target of every motion.
pub struct Vehicle<'w> {
    /// Where it is; shared with the sensor it carries.
    pub pose: &'w Cell<Pose>,
}

impl Drive for Vehicle<'_> {
    type Error = Infallible;

    fn drive(&mut self, motion: &Motion) -> Result<Pose, Infallible> {
        self.pose.set(motion.target);
        Ok(motion.target)
    }
}

/// A perfect label sensor, carried by the vehicle.
pub struct Probe<'w> {
    /// The true line.
    pub truth: Line,
    /// Where the vehicle is.
    pub pose: &'w Cell<Pose>,
}

impl LabelSensor for Probe<'_> {
    type Error = Infallible;

    fn read(&mut self) -> Result<Reading, Infallible> {
        Ok(reading(&self.truth, self.pose.get().site))
    }
}
