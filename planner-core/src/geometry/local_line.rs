//! Lines in single precision that lose no accuracy: each has a frame of its own, which is exact and near to it.

use crate::geometry::approximate::{METRE, UnitVector, cross};
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::value::ValueError;

/// Axes about a site: along a direction, and to its left.
#[derive(Clone, Copy)]
pub(crate) struct LocalAxes {
    about: Site,
    along: Vector,
    unit: UnitVector,
}

/// A line by slope and intercept in axes of its own: a site, and an exact direction near the line's.
///
/// At a distance `d` from `about` along the direction, the line lies `intercept + slope d` metres to the left. Its +1
/// side is to the left of it. The line differs little from the exact one through the site, so single precision is
/// enough wherever it lies. A [`Line`](crate::geometry::line::Line) describes it in metres from the origin, in double
/// precision.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "(Site, [i32; 2], [f32; 2])", into = "(Site, [i32; 2], [f32; 2])")
)]
pub struct LocalLine {
    pub(crate) about: Site,
    pub(crate) along: Vector,
    pub(crate) slope: f32,
    pub(crate) intercept: f32,
}

impl LocalLine {
    /// The line with this slope and this intercept, metres, in the axes about a site along a direction.
    ///
    /// `None` if the direction is zero, the slope steeper than 1, or one of the two not finite.
    pub fn new(about: Site, along: Vector, slope: f32, intercept: f32) -> Option<Self> {
        let is_one = along != Vector::default() && slope.abs() <= 1.0 && intercept.is_finite();
        is_one.then_some(Self { about, along, slope, intercept })
    }

    /// Where its axes begin.
    pub const fn about(&self) -> Site {
        self.about
    }

    /// The direction of the first axis, of any length.
    pub const fn along(&self) -> Vector {
        self.along
    }

    /// The slope against that direction, at most 1 in size.
    pub const fn slope(&self) -> f32 {
        self.slope
    }

    /// How far to the left it passes the site, against the first axis, metres.
    pub const fn intercept(&self) -> f32 {
        self.intercept
    }
}

/// Its site, its direction, and slope and intercept.
impl From<LocalLine> for (Site, [i32; 2], [f32; 2]) {
    fn from(LocalLine { about, along, slope, intercept }: LocalLine) -> Self {
        (about, [along.x, along.z], [slope, intercept])
    }
}

impl TryFrom<(Site, [i32; 2], [f32; 2])> for LocalLine {
    type Error = ValueError;

    fn try_from(
        (about, [x, z], [slope, intercept]): (Site, [i32; 2], [f32; 2]),
    ) -> Result<Self, ValueError> {
        let line = Vector::new(x, z).and_then(|along| Self::new(about, along, slope, intercept));
        line.ok_or(ValueError("a line has a direction, a slope and an intercept"))
    }
}

impl LocalAxes {
    pub(crate) fn new(about: Site, along: Vector) -> Self {
        Self { about, along, unit: UnitVector::of(along) }
    }

    pub(crate) const fn about(&self) -> Site {
        self.about
    }

    pub(crate) const fn along(&self) -> Vector {
        self.along
    }

    pub(crate) const fn unit(&self) -> UnitVector {
        self.unit
    }

    /// A direction's unit vector in these axes.
    pub(crate) fn seen(&self, direction: Vector, unit: UnitVector) -> [f32; 2] {
        let sin = cross(self.along, direction) * (self.unit.per_length * unit.per_length);
        [self.unit.dot(unit), sin]
    }

    /// How far a site lies to the left of the line through the frame's site along a direction, metres.
    pub(crate) fn distance(&self, site: Site, unit: UnitVector, direction: Vector) -> f32 {
        cross(direction, site - self.about) * (unit.per_length * METRE)
    }

    /// A site in these axes, metres.
    pub(crate) fn place(&self, site: Site) -> [f32; 2] {
        let (from_here, scale) = (site - self.about, self.unit.per_length * METRE);
        [cross(from_here, self.along.left()) * scale, cross(self.along, from_here) * scale]
    }

    /// The line `normal . q = offset` in these axes, +1 where the normal points. The three may have any common
    /// factor above zero.
    pub(crate) fn line(&self, [ahead, left]: [f32; 2], offset: f32) -> Option<LocalLine> {
        // Of the four directions of the axes, that to whose left the normal points.
        let (along, ahead, left) = if left.abs() >= ahead.abs() {
            (self.along, ahead, left)
        } else {
            (self.along.left(), left, -ahead)
        };
        let along = if left < 0.0 { along.reversed() } else { along };
        LocalLine::new(self.about, along, -ahead / left, offset / left.abs())
    }
}
