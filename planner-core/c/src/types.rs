//! What goes over the interface: plain numbers, in metres and radians.

use core::ffi::CStr;

use planner_core::error::{GridError, ObservationError};
use planner_core::nalgebra::Point2;
use planner_core::{
    Angle, Goal, Heading, Hull, Label, Noise, Site, SlopeWithin, StopReason, Tolerance, Unicycle,
};

use crate::area::{Area, Ground};
use crate::verdict::Refusal;

/// What a call came to.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It was done.
    Ok,
    /// Stopped: the line is known as well as was asked for.
    Known,
    /// Stopped: no motion leads to uncertain ground, as what is left of it is too thin or out of reach.
    Resolution,
    /// Stopped: there is no room for another sample.
    Full,
    /// Stopped: outside the area, or cornered.
    Stuck,
    /// Refused: the reading contradicts what is certain.
    Contradiction,
    /// Refused: a pointer is null, or the memory too small or not aligned to 8 bytes.
    Memory,
    /// Refused: a number of the mission is out of its range.
    Mission,
    /// Refused: a position is further than 8,192 m from the origin, or no number.
    Position,
    /// Refused: there is no such reading.
    Reading,
    /// Refused: no line separates the given samples, or they are collinear, too many or of one label. Or one says
    /// something else than 0 or 1 for whether it is positive.
    Given,
    /// Stopped: there is uncertain ground, but none of the ways that a plan tries leads there. From another pose one may.
    Undecided,
    /// Refused: the tolerance leaves nothing of the area, as no place is as far from its border.
    ToleranceTooLarge,
    /// Stopped: what is uncertain is so thin that no label can tell more, as positions err.
    Imprecise,
    /// Refused: the area is no convex polygon, has too many corners, or comes beside a rectangle.
    Area,
    /// Refused: a keep-out is no convex polygon, has too many corners or no possible radius, or there are too many.
    KeepOut,
    /// Refused: an observation's tolerance is above the mission's, or below 0, or no number.
    Tolerance,
    /// Refused: an observation's `p` is no probability, or this mission takes no other `p` than its own.
    Reliability,
    /// Refused: the snapshot is spoilt, or never was one.
    SnapshotSpoilt,
    /// Refused: another version of the planner made the snapshot.
    SnapshotVersion,
    /// Refused: a planner of this mission cannot have made the snapshot.
    SnapshotMission,
    /// Stopped: no straight, still line explains the labels, as the audit before the goal's promise read another label on
    /// ground that was certain.
    NoLine,
}

impl From<ObservationError> for Status {
    fn from(refused: ObservationError) -> Self {
        match refused {
            ObservationError::Full(_) => Self::Full,
            ObservationError::Tolerance(_) => Self::Tolerance,
            ObservationError::Reliability => Self::Reliability,
            _ => Self::Contradiction,
        }
    }
}

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

/// What is fixed beforehand.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Mission<'a> {
    /// The area's lower left corner, metres.
    pub min_x: f64,
    /// The same.
    pub min_z: f64,
    /// The area's upper right corner, metres.
    pub max_x: f64,
    /// The same.
    pub max_z: f64,
    /// How far a position may be off, metres; 0 if it is exact.
    pub tolerance: f64,
    /// How often a label is right: 1 if always, else above 1/2.
    pub p: f64,
    /// Stop when the slopes of all lines left, or with p below 1 of 90 % of them, differ by no more, radians; 0 to
    /// go on.
    pub slopes: f64,
    /// The sharpest turn to either side, radians.
    pub sharpest: f64,
    /// From one turn to the next, millionths of a radian.
    pub turn_step_urad: u32,
    /// From one distance to the next, millimetres.
    pub step_mm: u32,
    /// How many such steps the longest motion has.
    pub steps: u16,
    /// With p below 1: the probability that `slopes` holds when the planner stops, at most 0.9999; 0 for 0.9. With p of
    /// 1 it must be 0.
    pub level: f64,
    /// A polygon and keep-outs; null for the rectangle with nothing in it. It is read while a call runs, and not after.
    pub area: Option<&'a Area>,
}

/// The level of a promise, unless the mission says another, and the highest; millionths.
const USUAL_LEVEL: u32 = 900_000;
const HIGHEST_LEVEL: f64 = 0.9999;

impl Mission<'_> {
    pub(crate) fn ground(&self) -> Result<Ground, Refusal> {
        match self.area {
            None => Ok(Ground::from(self.rectangle()?)),
            Some(area) if area.corner_count == 0 => {
                area.with_keep_outs(Hull::of(self.rectangle()?))
            }
            Some(area) => {
                let sides = [self.min_x, self.min_z, self.max_x, self.max_z];
                if sides.into_iter().any(|side| side != 0.0) {
                    return Err(Refusal::of(Status::Area, c"area"));
                }
                area.with_keep_outs(area.polygon()?)
            }
        }
    }

    fn rectangle(&self) -> Result<planner_core::Area, Refusal> {
        let corner = |(x, x_name), (z, z_name)| {
            let beyond = |name| move |status| Refusal::of(status, name);
            Point { x, z: 0.0 }.read().map_err(beyond(x_name))?;
            Point { x, z }.read().map_err(beyond(z_name))
        };
        let min = corner((self.min_x, c"min_x"), (self.min_z, c"min_z"))?;
        let max = corner((self.max_x, c"max_x"), (self.max_z, c"max_z"))?;
        let what = if min.x() < max.x() { c"max_z" } else { c"max_x" };
        planner_core::Area::new(min, max).map_err(|_| Refusal::of(Status::Mission, what))
    }

    pub(crate) fn tolerance(&self) -> Result<Tolerance, Refusal> {
        Tolerance::new(self.tolerance).map_err(|_| Refusal::of(Status::Mission, c"tolerance"))
    }

    pub(crate) fn unicycle(&self) -> Result<Unicycle, Refusal> {
        let refused = |what: &'static CStr| Refusal::of(Status::Mission, what);
        // Without a step it would turn on the spot alone.
        let speeds = self.steps.checked_add(1).filter(|it| *it > 1).ok_or(refused(c"steps"))?;
        let made = Unicycle::new(self.turn_step_urad, self.sharpest, speeds, self.step_mm);
        made.map_err(|bad| {
            // With a turn and a step that are possible for certain: what is still refused is something else.
            let is_turn = Unicycle::new(self.turn_step_urad, 1.0, 2, 1).is_err();
            let is_step = Unicycle::new(1_000_000, 1.0, 2, self.step_mm).is_err();
            refused(match bad {
                GridError::Turn if is_turn => c"turn_step_urad",
                GridError::Turn => c"sharpest",
                _ if is_step => c"step_mm",
                _ => c"steps",
            })
        })
    }

    pub(crate) fn goal(&self) -> Result<Option<Goal<SlopeWithin>>, Refusal> {
        let level = self.level()?;
        if self.slopes == 0.0 {
            return Ok(None);
        }
        let goal = Angle::from_radians(self.slopes).and_then(Goal::slope_within);
        let goal = goal.map_err(|_| Refusal::of(Status::Mission, c"slopes"))?;
        Ok(Some(Goal { level, ..goal }))
    }

    /// In millionths. Promises about true labels have none.
    fn level(&self) -> Result<u32, Refusal> {
        if self.level == 0.0 {
            return Ok(USUAL_LEVEL);
        }
        let is_possible = self.p < 1.0 && self.level > 0.0 && self.level <= HIGHEST_LEVEL;
        let millionths = (self.level * 1e6 + 0.5) as u32;
        is_possible.then_some(millionths).ok_or(Refusal::of(Status::Mission, c"level"))
    }

    /// What is known of the noise, if there is any.
    pub(crate) fn noise(&self) -> Result<Option<Noise>, Refusal> {
        let is_useful = self.p > 0.5 && self.p <= 1.0;
        let noise = is_useful.then(|| Noise::new(self.p).ok()).flatten();
        let noise = noise.ok_or(Refusal::of(Status::Mission, c"p"))?;
        let tolerance = self.tolerance()?;
        Ok((self.p < 1.0).then_some(Noise { tolerance, ..noise }))
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

impl From<StopReason> for Status {
    fn from(reason: StopReason) -> Self {
        match reason {
            StopReason::Known => Self::Known,
            StopReason::SamplesFull => Self::Full,
            StopReason::Tolerance => Self::Imprecise,
            StopReason::NoLine => Self::NoLine,
            StopReason::OutsideArea | StopReason::Cornered => Self::Stuck,
            StopReason::Undecided => Self::Undecided,
            _ => Self::Resolution,
        }
    }
}
