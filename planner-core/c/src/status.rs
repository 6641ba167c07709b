//! What a call comes to.

use planner_core::StopReason;
use planner_core::error::{ObservationError, RestoreError};

/// What a call came to. The mission goes on, or it has ended, or the call is refused: `planner_has_ended` and
/// `planner_is_refused` tell.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It was done, and the mission goes on.
    Ok = 0,
    /// Ended: the line is known as well as was asked for.
    Known = 1,
    /// Ended: no motion leads to uncertain ground, as what is left of it is too thin or out of reach.
    Resolution = 2,
    /// Ended: there is no room for another sample. An observation that says so is not taken in.
    Full = 3,
    /// Ended: outside the area, or cornered.
    Stuck = 4,
    /// Ended: there is uncertain ground, but none of the ways that a plan tries leads there. From another pose one may.
    Undecided = 5,
    /// Ended: what is uncertain is so thin that no label can tell more, as positions err.
    Imprecise = 6,
    /// Ended: no straight, still line explains the labels, as the audit before the goal's promise read another label on
    /// ground that was certain.
    NoLine = 7,
    /// Ended: the robot has gone along all of the front, and the front settings say that it ends then.
    Closed = 8,
    /// Ended: all of the area most likely has one label, so there is no front.
    OneLabel = 9,
    /// Refused: the reading contradicts what is certain.
    Contradiction = 64,
    /// Refused: a pointer is null, or the memory too small or not aligned to 8 bytes.
    Memory = 65,
    /// Refused: a number of the mission or of the front settings is out of its range.
    Mission = 66,
    /// Refused: a position is further than 8,192 m from the origin, or no number.
    Position = 67,
    /// Refused: there is no such reading.
    Reading = 68,
    /// Refused: no line separates the given samples, or they are collinear, too many or of one label. Or one says
    /// something else than 0 or 1 for whether it is positive.
    Given = 69,
    /// Refused: the tolerance leaves nothing of the area, as no place is as far from its border.
    ToleranceTooLarge = 70,
    /// Refused: the area is no convex polygon, has too many corners, or comes beside a rectangle. Or the library is
    /// built without polygons.
    Area = 71,
    /// Refused: a keep-out is no convex polygon, has too many corners or no possible radius, or there are too many.
    KeepOut = 72,
    /// Refused: an observation's tolerance is above the mission's, or below 0, or no number.
    Tolerance = 73,
    /// Refused: an observation's `p` is no probability, or this mission takes no other `p` than its own.
    Reliability = 74,
    /// Refused: the snapshot is spoilt, or never was one.
    SnapshotSpoilt = 75,
    /// Refused: another version of the planner made the snapshot.
    SnapshotVersion = 76,
    /// Refused: a planner of this mission cannot have made the snapshot.
    SnapshotMission = 77,
    /// Refused: what is asked for is not known. The front is not found, or it is lost. Or the lines that are left lie
    /// too close together for single precision.
    Unknown = 78,
    /// Refused: a chart has no possible side or size, leaves the ground within 8,192 m of the origin, or comes beside a
    /// rectangle. Or the library is built without charts.
    Chart = 79,
}

/// Whether a status says that the mission has ended. It is a number, as an enumeration of C may hold any.
#[unsafe(export_name = "planner_has_ended")]
pub extern "C" fn has_ended(status: i32) -> bool {
    status > Status::Ok as i32 && status < Status::Contradiction as i32
}

/// Whether a status says that a call is refused. Such a call has changed nothing, and the mission can go on.
#[unsafe(export_name = "planner_is_refused")]
pub extern "C" fn is_refused(status: i32) -> bool {
    !has_ended(status) && status != Status::Ok as i32
}

impl From<Result<(), Self>> for Status {
    fn from(result: Result<(), Self>) -> Self {
        result.err().unwrap_or(Self::Ok)
    }
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

impl From<RestoreError> for Status {
    fn from(refused: RestoreError) -> Self {
        match refused {
            RestoreError::Version(_) => Self::SnapshotVersion,
            _ => Self::SnapshotMission,
        }
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
            StopReason::Closed => Self::Closed,
            StopReason::OneLabel => Self::OneLabel,
            _ => Self::Resolution,
        }
    }
}
