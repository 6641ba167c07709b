//! When the line is known well enough.
//!
//! A goal is a promise about the lines that are left. The check is exact or conservative. If labels are true, the line
//! is one of these lines, so the promise holds. If labels may be wrong, the promise is about a credible set. It then
//! holds with at least the probability of that set.

use crate::geometry::approximate::{METRE, cross, single, sqrt};
use crate::geometry::arc::SlopeArc;
use crate::geometry::area::Area;
use crate::geometry::heading::Angle;
use crate::geometry::lattice::Vector;
use crate::geometry::line::Bound;
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;

/// The goal of a mission: how well the line must be known, and with which probability.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Goal {
    /// The accuracy with which the line must be known.
    pub accuracy: Accuracy,
    /// The least probability that the promise holds, in millionths. Unused if labels are true: then it is certain.
    pub level: u32,
}

/// The probability with which a promise holds unless another is asked for, in millionths.
const USUAL_LEVEL: u32 = 900_000;

impl Goal {
    /// Any two of the lines left make an angle of so many degrees at most.
    ///
    /// # Errors
    /// [`ValueError`] unless it is above 0 and below 90.
    pub fn slope_within_degrees(degrees: f64) -> Result<Self, ValueError> {
        Self::slope_within(Angle::from_degrees(degrees).map_err(|_| ACUTE)?)
    }

    /// Any two of the lines left make an angle of this at most.
    ///
    /// # Errors
    /// [`ValueError`] unless it is above 0 and below a quarter turn.
    pub fn slope_within(angle: Angle) -> Result<Self, ValueError> {
        let is_acute = 0 < angle.0 && angle.0 < 1 << 30;
        let accuracy = Accuracy::SlopeArc(angle);
        is_acute.then_some(Self { accuracy, level: USUAL_LEVEL }).ok_or(ACUTE)
    }

    /// The ground on which not all of the lines agree is at most this share of the area.
    ///
    /// # Errors
    /// [`ValueError`] unless it is at least 0.000001 and at most 1.
    pub fn misclassified_share(share: f64) -> Result<Self, ValueError> {
        let is_share = (1e-6..=1.0).contains(&share);
        let accuracy = Accuracy::Misclassified(libm::round(share * 1e6) as u32);
        is_share.then_some(Self { accuracy, level: USUAL_LEVEL }).ok_or(SHARE)
    }

    /// The same goal, to be met with this probability at least. It is 0.9 unless you say otherwise, and 1 where labels
    /// are true.
    ///
    /// # Errors
    /// [`ValueError`] unless it is above 0 and at most 0.9999.
    pub fn with_confidence(self, probability: f64) -> Result<Self, ValueError> {
        let is_one = 0.0 < probability && probability <= 0.9999;
        let level = libm::round(probability * 1e6) as u32;
        is_one.then_some(Self { level, ..self }).ok_or(CONFIDENCE)
    }

    /// The same goal, as a share of the rectangle around an area. [`Belief::meets`](crate::belief::Belief::meets) takes
    /// that rectangle, of which the same ground is a smaller share.
    #[must_use]
    pub fn in_bounds_of<G: Workspace>(self, area: &G) -> Self {
        let accuracy = match self.accuracy {
            Accuracy::Misclassified(millionths) => {
                Accuracy::Misclassified((millionths as f32 * area.share_of_bounds()) as u32)
            }
            accuracy @ Accuracy::SlopeArc(_) => accuracy,
        };
        Self { accuracy, ..self }
    }
}

const ACUTE: ValueError = ValueError("a goal's angle is above 0 and below 90 degrees");
const SHARE: ValueError = ValueError("a goal's share of the area is from 0.000001 to 1");
const CONFIDENCE: ValueError = ValueError("a confidence is above 0 and at most 0.9999");

/// How well a line is to be known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Accuracy {
    /// Any two of the lines make an angle of this at most, below a quarter turn.
    SlopeArc(Angle),
    /// The ground on which not all of the lines agree is at most this share of the area, in millionths.
    Misclassified(u32),
}

/// Points along the area at which the breadth of the uncertain ground is taken.
const STATIONS: u16 = 16;

/// The most that rounding takes from a promise, as a share of it.
const ROUNDING: f32 = 1e-4;

impl Accuracy {
    /// Whether the lines between these vertices, of one cell or of several, are as close to each other as the goal
    /// asks. Conservative: `true` is always correct.
    pub fn is_met(self, bounds: impl Iterator<Item = Bound> + Clone, area: Area) -> bool {
        let Some(arc) = SlopeArc::spanning(bounds.clone().map(|bound| bound.along)) else {
            return false;
        };
        match self {
            Self::SlopeArc(most) => is_narrower(arc, most),
            Self::Misclassified(millionths) => {
                let most = millionths as f32 * 1e-6 * (1.0 - ROUNDING);
                is_narrower(arc, Angle(1 << 29)) && uncertain_share(arc, bounds, area) <= most
            }
        }
    }
}

/// Whether an arc of slopes is narrower than a turn that is below a quarter.
fn is_narrower(arc: SlopeArc, turn: Angle) -> bool {
    let Vector { x: cos, z: sin } = turn.unit().scaled(1 << 29);
    let sin = sin.saturating_sub(2); // by as much as it may be rounded up
    let (cross, dot) = (cross(arc.from(), arc.to()), single(arc.from().dot(arc.to())));
    dot > 0.0 && cross * cos as f32 <= dot * sin as f32 * (1.0 - ROUNDING)
}

/// The share of an area on which lines of a narrow arc disagree, or somewhat more.
///
/// The frame is at the middle of the area, and its first axis runs along the arc's bisector. There the ground lies
/// between the highest of the lines and the lowest. Its breadth is a convex function, so trapezoids between some points
/// of the function are an upper bound. They reach as far as there is such ground inside the area.
fn uncertain_share(arc: SlopeArc, bounds: impl Iterator<Item = Bound> + Clone, area: Area) -> f32 {
    let along = arc.bisector();
    let (x, z) = (along.x as f32, along.z as f32);
    let length = sqrt(x * x + z * z);
    let (cos, sin) = (x / length, z / length);
    let (middle, half) = (area.middle(), area.half_sides().map(|side| side as f32 * METRE));
    let lines = bounds.map(|bound| {
        let run = single(along.dot(bound.along));
        let slope = cross(along, bound.along) / run;
        (slope, -single(bound.at(middle)) * (length * METRE) / run)
    });
    let between = |x: f32| {
        let heights = lines.clone().map(|(slope, offset)| slope * x + offset);
        heights.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), it| (a.min(it), b.max(it)))
    };
    let (mut from, mut to) = (f32::INFINITY, f32::NEG_INFINITY);
    let mut reaches = |x: f32| (from, to) = (from.min(x), to.max(x));
    // The corners on which the lines disagree, and where each of these enters the area and leaves it.
    for (right, up) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let (x, z) = (right * half[0], up * half[1]);
        let (x, z) = (x * cos + z * sin, z * cos - x * sin);
        let (low, high) = between(x);
        if low <= z && z <= high {
            reaches(x);
        }
    }
    for (slope, offset) in lines.clone() {
        // A point of the line is base + x way.
        let base = [-sin * offset, cos * offset];
        let way = [cos - sin * slope, sin + cos * slope];
        let (mut low, mut high) = (f32::NEG_INFINITY, f32::INFINITY);
        for ((base, way), half) in base.into_iter().zip(way).zip(half) {
            let (a, b) = ((-half - base) / way, (half - base) / way);
            low = low.max(a.min(b));
            high = high.min(a.max(b));
        }
        if low <= high {
            reaches(low);
            reaches(high);
        }
    }
    if from > to {
        return 0.0;
    }
    let step = (to - from) / f32::from(STATIONS);
    // What heights anywhere in the area are rounded by, at most.
    let rounding = 8.0 * f32::EPSILON * (half[0] + half[1]);
    let breadth = |station: u16| {
        let (low, high) = between(from + f32::from(station) * step);
        high - low + rounding
    };
    let inner: f32 = (1..STATIONS).map(breadth).sum();
    let ground = (inner + 0.5 * (breadth(0) + breadth(STATIONS))) * step;
    ground / (4.0 * half[0] * half[1])
}
