//! What the examples share: four labelled points in a field of 20 m x 20 m, and a simulated world in place of the
//! real one. The line to be found is z = 0.41 x + 3.5.

#![allow(dead_code, reason = "each example needs some of it")]

use std::cell::Cell;
use std::error::Error;

use planner_core::nalgebra::Point2;
use planner_core::{Area, Heading, Label, Line, Pose, Sample};

/// Whatever goes wrong ends an example.
pub(crate) type Result<T = ()> = std::result::Result<T, Box<dyn Error>>;

/// What is known before.
pub(crate) fn given() -> Result<[Sample; 4]> {
    Ok([
        Sample::at([2.0, 1.0], Label::Negative)?,
        Sample::at([2.0, 8.0], Label::Positive)?,
        Sample::at([18.0, 16.0], Label::Positive)?,
        Sample::at([18.0, 5.0], Label::Negative)?,
    ])
}

/// Where the robot is in the beginning, facing along x.
pub(crate) fn start() -> Result<Pose> {
    Ok(Pose::at([2.0, 1.0], Heading::default())?)
}

/// Where it may go.
pub(crate) fn area() -> Result<Area> {
    Ok(Area::metres([0.0, 0.0], [20.0, 20.0])?)
}

/// The world, and the robot in it.
pub(crate) struct World(Cell<Pose>);

impl World {
    /// With the robot at its start.
    pub(crate) fn new() -> Result<Self> {
        Ok(Self(Cell::new(start()?)))
    }

    /// Where the robot is.
    pub(crate) fn pose(&self) -> Pose {
        self.0.get()
    }

    /// The robot goes where it is sent.
    pub(crate) fn go(&self, pose: Pose) {
        self.0.set(pose);
    }

    /// How far above the line it stands, metres.
    pub(crate) fn height(&self) -> f64 {
        let at = Point2::<f64>::from(self.pose().site);
        (at.y - 0.41 * at.x - 3.5) / f64::hypot(0.41, 1.0)
    }

    /// On which side it stands.
    pub(crate) fn label(&self) -> Label {
        if self.height() > 0.0 { Label::Positive } else { Label::Negative }
    }
}

/// Prints an estimate of the line and fails unless it is within some metres of the truth across the field.
pub(crate) fn report(estimate: Option<Line>, within: f64) -> Result {
    let line = estimate.ok_or("no estimate")?;
    println!("{line}");
    let (slope, intercept) = line.slope().zip(line.intercept()).ok_or("vertical")?;
    let off = |x: f64| (slope - 0.41) * x + intercept - 3.5;
    let most = off(0.0).abs().max(off(20.0).abs());
    if most > within { Err(format!("{most} m off").into()) } else { Ok(()) }
}
