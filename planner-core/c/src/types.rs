//! What goes over the interface: plain numbers, in metres and radians.

use planner_core::nalgebra::Point2;
use planner_core::{Heading, Label, Site};

use crate::status::Status;

/// What was read. It comes as a number, as an enumeration of C may hold any.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// The side of -1.
    Negative = -1,
    /// The line itself.
    Boundary = 0,
    /// The side of +1.
    Positive = 1,
    /// No label was asked for.
    None = 2,
}

impl Reading {
    pub(crate) fn read(number: i32) -> Result<Option<planner_core::Reading>, Status> {
        [
            (Self::Negative, Some(Label::Negative.into())),
            (Self::Boundary, Some(planner_core::Reading::Boundary)),
            (Self::Positive, Some(Label::Positive.into())),
            (Self::None, None),
        ]
        .into_iter()
        .find_map(|(reading, read)| (reading as i32 == number).then_some(read))
        .ok_or(Status::Reading)
    }
}

/// A place.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub z: f64,
}

impl Point {
    /// On the lattice.
    pub(crate) fn read(self) -> Result<Site, Status> {
        Site::try_from(Point2::new(self.x, self.z)).map_err(|_| Status::Position)
    }
}

/// Where the robot is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub z: f64,
    /// Counter-clockwise from the x axis, radians.
    pub heading: f64,
}

impl Pose {
    /// On the lattice.
    pub(crate) fn read(self) -> Result<planner_core::Pose, Status> {
        let site = Point { x: self.x, z: self.z }.read()?;
        let heading = Heading::from_radians(self.heading).map_err(|_| Status::Position)?;
        Ok(planner_core::Pose { site, heading })
    }
}

impl From<planner_core::Pose> for Pose {
    fn from(pose: planner_core::Pose) -> Self {
        let at = Point2::<f64>::from(pose.site);
        Self { x: at.x, z: at.y, heading: pose.heading.radians() }
    }
}

/// A sample that is known before the mission.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub z: f64,
    /// 1 if it lies on the side of +1, 0 if on that of -1; `true` and `false` are these.
    pub is_positive: u8,
}

impl Sample {
    pub(crate) fn read(self) -> Result<planner_core::Sample, Status> {
        let label = match self.is_positive {
            0 => Label::Negative,
            1 => Label::Positive,
            _ => return Err(Status::Given),
        };
        Ok(planner_core::Sample { site: Point { x: self.x, z: self.z }.read()?, label })
    }
}

/// A motion to make: first turn, then drive.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// How far to turn to the left, radians.
    pub turn: f64,
    /// How far to drive, metres.
    pub drive: f64,
    /// Where it leads.
    pub target: Pose,
    /// Whether a label is to be read at its end.
    pub wants_label: bool,
}

impl From<planner_core::Motion> for Motion {
    fn from(motion: planner_core::Motion) -> Self {
        Self {
            turn: motion.control.turn_rad.into(),
            drive: motion.control.distance_m.into(),
            target: motion.target.into(),
            wants_label: motion.wants_label,
        }
    }
}

/// A line `a x + b z + c = 0` with a unit normal, positive on the side of +1.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Of x.
    pub a: f64,
    /// Of z.
    pub b: f64,
    /// Metres.
    pub c: f64,
}

impl From<planner_core::Line> for Line {
    fn from(line: planner_core::Line) -> Self {
        let [a, b, c] = line.coefficients();
        Self { a, b, c }
    }
}
