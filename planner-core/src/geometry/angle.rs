//! Coarse angles for approximate geometry: a quarter of a heading's resolution, and sums do not wrap.

use core::ops::{Add, Neg, Sub};

use crate::geometry::heading::Heading;

/// An angle whose unit is four times a [`Heading`]'s, so that sums of three half turns still fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct CoarseAngle(i32);

impl CoarseAngle {
    /// Less than the size of any angle between two headings, so that no angle is within it.
    pub(crate) const NEVER: Self = Self(-1);
    pub(crate) const ZERO: Self = Self(0);
    pub(crate) const QUARTER_TURN: Self = Self(1 << 28);
    pub(crate) const HALF_TURN: Self = Self(1 << 29);
    pub(crate) const WHOLE_TURN: Self = Self(1 << 30);

    const PER_RADIAN: f32 = (1 << 29) as f32 / core::f32::consts::PI;

    /// Rounded towards zero.
    pub(crate) const fn radians(radians: f32) -> Self {
        Self((radians * Self::PER_RADIAN) as i32)
    }

    /// A multiple of so many radians, rounded towards zero.
    pub(crate) const fn radians_times(radians: f32, factor: f32) -> Self {
        Self((factor * (radians * Self::PER_RADIAN)) as i32)
    }

    /// The turn from one heading to another, the shorter way around: positive to the left.
    pub(crate) const fn between(from: Heading, to: Heading) -> Self {
        Self((to.0.wrapping_sub(from.0) as i32) >> 2)
    }

    /// The angle in radians.
    pub(crate) const fn in_radians(self) -> f32 {
        self.0 as f32 / Self::PER_RADIAN
    }

    pub(crate) const fn abs(self) -> Self {
        Self(self.0.abs())
    }

    /// The turn in a heading's units. A negative angle becomes 0, and whole turns are dropped.
    pub(crate) const fn turn(self) -> u32 {
        (if self.0 < 0 { 0 } else { self.0 as u32 }) << 2
    }

    /// The heading at this angle to the x axis.
    pub(crate) const fn heading(self) -> Heading {
        Heading((self.0 as u32) << 2)
    }
}

impl Add for CoarseAngle {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for CoarseAngle {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Neg for CoarseAngle {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}
