//! What the examples share: four labelled points in a field of 20 m x 20 m, and a simulated world in place of the
//! real one. The line to be found is z = 0.41 x + 3.5.

#![allow(dead_code, reason = "each example needs some of it")]

use std::cell::Cell;
use std::error::Error;

use planner_core::belief::tolerance::Tolerance;
use planner_core::nalgebra::Point2;
use planner_core::{
    Area, Config, Crossing, Heading, Label, Line, LocalLine, Pose, Sample, Site, lookahead,
};

/// Whatever goes wrong ends an example.
pub(crate) type Result<T = ()> = std::result::Result<T, Box<dyn Error>>;

/// A place by metres.
pub(crate) fn at(x: f64, z: f64) -> Result<Site> {
    Ok(Site::try_from(Point2::new(x, z))?)
}

/// What is known before.
pub(crate) fn given() -> Result<[Sample; 4]> {
    Ok([
        Sample { site: at(2.0, 1.0)?, label: Label::Negative },
        Sample { site: at(2.0, 8.0)?, label: Label::Positive },
        Sample { site: at(18.0, 16.0)?, label: Label::Positive },
        Sample { site: at(18.0, 5.0)?, label: Label::Negative },
    ])
}

/// Where the robot is in the beginning, facing along x.
pub(crate) fn start() -> Result<Pose> {
    Ok(Pose { site: at(2.0, 1.0)?, heading: Heading(0) })
}

/// What the mission fixes beforehand.
pub(crate) fn config() -> Result<Config> {
    Ok(Config {
        area: Area::new(at(0.0, 0.0)?, at(20.0, 20.0)?).ok_or("no area")?,
        varrho: lookahead::VARRHO,
        crossing: Crossing::default(),
        following: planner_core::cfc::FOLLOWING,
        tolerance: Tolerance::NONE,
    })
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
pub(crate) fn report(estimate: Option<LocalLine>, within: f64) -> Result {
    let line = Line::from(estimate.ok_or("no estimate")?);
    let (slope, intercept) = line.slope().zip(line.intercept()).ok_or("vertical")?;
    println!("z = {slope:.4} x + {intercept:.4}");
    let off = |x: f64| (slope - 0.41) * x + intercept - 3.5;
    let most = off(0.0).abs().max(off(20.0).abs());
    if most > within { Err(format!("{most} m off").into()) } else { Ok(()) }
}
