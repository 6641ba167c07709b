//! When the line is known well enough.
//!
//! A goal is a promise about the lines that are left. The check is exact or conservative. If labels are true, the line
//! is one of these lines, so the promise holds. If labels may be wrong, the promise is about a credible set. It then
//! holds with at least the probability of that set.

use crate::geometry::approximate::{LEVER, METRE, cross, single, sqrt};
use crate::geometry::arc::SlopeArc;
use crate::geometry::area::Area;
use crate::geometry::heading::Angle;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::line::Bound;
use crate::geometry::span::Span;
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;

/// The goal of a mission: how well the line must be known, and with which probability.
///
/// `C` is what is asked of the lines. A program has the code of the criteria alone that its types name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Goal<C = Accuracy> {
    /// The accuracy with which the line must be known.
    pub accuracy: C,
    /// The least probability that the promise holds, in millionths. Unused if labels are true: then it is certain.
    pub level: u32,
}

/// The probability with which a promise holds unless another is asked for, in millionths.
const USUAL_LEVEL: u32 = 900_000;

impl Goal<SlopeWithin> {
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
        let accuracy = SlopeWithin(angle);
        is_acute.then_some(Self { accuracy, level: USUAL_LEVEL }).ok_or(ACUTE)
    }
}

impl Goal<ShareWithin> {
    /// The ground on which not all of the lines agree is at most this share of the area.
    ///
    /// # Errors
    /// [`ValueError`] unless it is at least 0.000001 and at most 1.
    pub fn misclassified_share(share: f64) -> Result<Self, ValueError> {
        let is_share = (1e-6..=1.0).contains(&share);
        let accuracy = ShareWithin(libm::round(share * 1e6) as u32);
        is_share.then_some(Self { accuracy, level: USUAL_LEVEL }).ok_or(SHARE)
    }
}

impl<C: Criterion> Goal<C> {
    /// A goal of either criterion, if it asks for this one.
    pub fn of(Goal { accuracy, level }: Goal) -> Option<Self> {
        C::of(accuracy).map(|accuracy| Self { accuracy, level })
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

    /// The same goal, met without an [audit](crate::watch::Audit) before its promise: a program for a small chip then has no
    /// code of one.
    #[must_use]
    pub fn unaudited(self) -> Goal<Unaudited<C>> {
        Goal { accuracy: Unaudited(self.accuracy), level: self.level }
    }

    /// The same goal, as a share of the rectangle around an area. [`Belief::meets`](crate::belief::Belief::meets) takes
    /// that rectangle, of which the same ground is a smaller share.
    #[must_use]
    pub fn in_bounds_of<G: Workspace>(self, area: &G) -> Self {
        Self { accuracy: self.accuracy.in_bounds_of(area), ..self }
    }
}

impl From<Goal<SlopeWithin>> for Goal {
    fn from(Goal { accuracy: SlopeWithin(most), level }: Goal<SlopeWithin>) -> Self {
        Self { accuracy: Accuracy::SlopeArc(most), level }
    }
}

impl From<Goal<ShareWithin>> for Goal {
    fn from(Goal { accuracy: ShareWithin(most), level }: Goal<ShareWithin>) -> Self {
        Self { accuracy: Accuracy::Misclassified(most), level }
    }
}

const ACUTE: ValueError = ValueError("a goal's angle is above 0 and below 90 degrees");
const SHARE: ValueError = ValueError("a goal's share of the area is from 0.000001 to 1");
const CONFIDENCE: ValueError = ValueError("a confidence is above 0 and at most 0.9999");

/// What can be asked of lines. A type of its own for each, so that a program carries the code of no other.
pub trait Criterion: Copy {
    /// Whether an audit comes before the promise that it is met.
    const AUDITS: bool = true;

    /// The one of both that is this.
    fn of(accuracy: Accuracy) -> Option<Self>;

    /// Whether the lines between these vertices, of one cell or of several, are as close to each other as it asks.
    /// Conservative: `true` is always correct.
    fn is_met<B: Bounds>(self, bounds: &B, area: Area) -> bool;

    /// The standard deviation, over a chord so long, of lines that just meet it, about; lattice units.
    fn deviation(self, chord: f32, area: Area) -> f32;

    /// The same criterion for the rectangle around an area.
    #[must_use]
    fn in_bounds_of<G: Workspace>(self, _area: &G) -> Self {
        self
    }
}

/// No criterion: that of a planner without a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NoGoal {}

/// A criterion that is met without an audit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unaudited<C>(pub C);

impl<C: Criterion> Criterion for Unaudited<C> {
    const AUDITS: bool = false;

    fn of(accuracy: Accuracy) -> Option<Self> {
        C::of(accuracy).map(Self)
    }

    fn is_met<B: Bounds>(self, bounds: &B, area: Area) -> bool {
        self.0.is_met(bounds, area)
    }

    fn deviation(self, chord: f32, area: Area) -> f32 {
        self.0.deviation(chord, area)
    }

    fn in_bounds_of<G: Workspace>(self, area: &G) -> Self {
        Self(self.0.in_bounds_of(area))
    }
}

impl Criterion for NoGoal {
    const AUDITS: bool = false;

    fn of(_: Accuracy) -> Option<Self> {
        None
    }

    fn is_met<B: Bounds>(self, _: &B, _: Area) -> bool {
        match self {}
    }

    fn deviation(self, _: f32, _: Area) -> f32 {
        match self {}
    }
}

/// Any two of the lines make an angle of this at most, below a quarter turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlopeWithin(pub Angle);

impl Criterion for SlopeWithin {
    fn of(accuracy: Accuracy) -> Option<Self> {
        if let Accuracy::SlopeArc(most) = accuracy { Some(Self(most)) } else { None }
    }

    fn is_met<B: Bounds>(self, bounds: &B, _: Area) -> bool {
        arc_of(bounds).is_some_and(|arc| is_narrower(arc, self.0))
    }

    fn deviation(self, chord: f32, _: Area) -> f32 {
        const RADIANS: f32 = core::f32::consts::PI / (1_u32 << 31) as f32;
        LEVER * chord * self.0.0 as f32 * RADIANS / RANGE
    }
}

/// The ground on which not all of the lines agree is at most this share of the area, in millionths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ShareWithin(pub u32);

impl Criterion for ShareWithin {
    fn of(accuracy: Accuracy) -> Option<Self> {
        if let Accuracy::Misclassified(most) = accuracy { Some(Self(most)) } else { None }
    }

    fn is_met<B: Bounds>(self, bounds: &B, area: Area) -> bool {
        let most = self.0 as f32 * 1e-6 * (1.0 - ROUNDING);
        arc_of(bounds).is_some_and(|arc| {
            is_narrower(arc, Angle(1 << 29)) && uncertain_share(arc, bounds, area) <= most
        })
    }

    fn deviation(self, chord: f32, area: Area) -> f32 {
        let [x, z] = area.half_sides().map(|half| 2.0 * half as f32);
        1e-6 * self.0 as f32 * x * z / (chord * RANGE)
    }

    fn in_bounds_of<G: Workspace>(self, area: &G) -> Self {
        Self((self.0 as f32 * area.share_of_bounds()) as u32)
    }
}

/// Either of the two criteria: how well a line is to be known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Accuracy {
    /// Any two of the lines make an angle of this at most, below a quarter turn.
    SlopeArc(Angle),
    /// The ground on which not all of the lines agree is at most this share of the area, in millionths.
    Misclassified(u32),
}

impl Criterion for Accuracy {
    fn of(accuracy: Accuracy) -> Option<Self> {
        Some(accuracy)
    }

    fn is_met<B: Bounds>(self, bounds: &B, area: Area) -> bool {
        match self {
            Self::SlopeArc(most) => SlopeWithin(most).is_met(bounds, area),
            Self::Misclassified(most) => ShareWithin(most).is_met(bounds, area),
        }
    }

    fn deviation(self, chord: f32, area: Area) -> f32 {
        match self {
            Self::SlopeArc(most) => SlopeWithin(most).deviation(chord, area),
            Self::Misclassified(most) => ShareWithin(most).deviation(chord, area),
        }
    }

    fn in_bounds_of<G: Workspace>(self, area: &G) -> Self {
        match self {
            Self::SlopeArc(_) => self,
            Self::Misclassified(most) => {
                Self::Misclassified(ShareWithin(most).in_bounds_of(area).0)
            }
        }
    }
}

/// The vertices of one cell, or of several. They are called one by one in a loop, and a program has its body once.
pub trait Bounds {
    /// Calls a function for each.
    fn each(&self, f: impl FnMut(Bound));
}

impl<I: Iterator<Item = Bound> + Clone> Bounds for I {
    fn each(&self, f: impl FnMut(Bound)) {
        self.clone().for_each(f);
    }
}

/// Points along the area at which the breadth of the uncertain ground is taken, but for the first.
const STATIONS: usize = 16;

/// A goal counts as met where lines would reach over so many standard deviations within it. They reach over some 4.5. Too
/// many are better than too few: a planner that counts on too few labels drives to and fro for the last ones.
const RANGE: f32 = 9.0;

/// The most that rounding takes from a promise, as a share of it.
const ROUNDING: f32 = 1e-4;

/// The arc of the lines' slopes.
fn arc_of<B: Bounds>(bounds: &B) -> Option<SlopeArc> {
    let mut arc = None;
    bounds.each(|Bound { along, .. }| {
        let point = SlopeArc::new(along, along);
        arc = Some(arc.map_or(point, |arc: SlopeArc| arc.hull(point)));
    });
    arc
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
/// Along the arc's bisector the ground lies between the highest of the lines and the lowest. Its breadth is a convex
/// function, so trapezoids between some points of the function are an upper bound. They reach as far as there is such
/// ground inside the area.
fn uncertain_share<B: Bounds>(arc: SlopeArc, bounds: &B, area: Area) -> f32 {
    let axes = BisectorAxes::of(arc, area);
    let ground = axes.ground(bounds);
    if ground.is_empty() {
        return 0.0;
    }
    let (step, half) = (ground.width() / STATIONS as f32, axes.half);
    let mut stations = [Span::NONE; STATIONS + 1];
    bounds.each(|bound| {
        let (slope, offset) = axes.seen(bound);
        for (station, heights) in stations.iter_mut().enumerate() {
            heights.add(slope * (ground.low + station as f32 * step) + offset);
        }
    });
    // What heights anywhere in the area are rounded by, at most.
    let rounding = 8.0 * f32::EPSILON * (half[0] + half[1]);
    let [first, inner @ .., last] = stations.map(|heights| heights.width() + rounding);
    let ground = (inner.iter().sum::<f32>() + 0.5 * (first + last)) * step;
    ground / (4.0 * half[0] * half[1])
}

/// Axes at the middle of an area, the first along the bisector of an arc of slopes.
struct BisectorAxes {
    along: Vector,
    length: f32,
    unit: [f32; 2],
    middle: Site,
    /// Half of the area's sides, metres.
    half: [f32; 2],
}

impl BisectorAxes {
    fn of(arc: SlopeArc, area: Area) -> Self {
        let along = arc.bisector();
        let (x, z) = (along.x as f32, along.z as f32);
        let length = sqrt(x * x + z * z);
        let half = area.half_sides().map(|side| side as f32 * METRE);
        Self { along, length, unit: [x / length, z / length], middle: area.middle(), half }
    }

    /// The slope of a line, and its height at the middle.
    fn seen(&self, bound: Bound) -> (f32, f32) {
        let run = single(self.along.dot(bound.along));
        let slope = cross(self.along, bound.along) / run;
        (slope, -single(bound.at(self.middle)) * (self.length * METRE) / run)
    }

    /// How far uncertain ground reaches along the first axis: where lines enter the area and leave it, and as far as the
    /// corners on which they disagree.
    fn ground<B: Bounds>(&self, bounds: &B) -> Span {
        let ([cos, sin], half) = (self.unit, self.half);
        let mut corners =
            [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]].map(|[right, up]| {
                let (x, z) = (right * half[0], up * half[1]);
                (x * cos + z * sin, z * cos - x * sin, Span::NONE)
            });
        let mut ground = Span::NONE;
        bounds.each(|bound| {
            let (slope, offset) = self.seen(bound);
            for (x, _, heights) in &mut corners {
                heights.add(slope * *x + offset);
            }
            // A point of the line is base + x way.
            let base = [-sin * offset, cos * offset];
            let way = [cos - sin * slope, sin + cos * slope];
            let inside = Span::inside(base, way, half.map(|side| -side), half);
            if !inside.is_empty() {
                ground.add(inside.low);
                ground.add(inside.high);
            }
        });
        for (x, z, heights) in corners {
            if heights.contains(z) {
                ground.add(x);
            }
        }
        ground
    }
}
