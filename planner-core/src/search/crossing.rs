//! A line as seen from the agent, and where a circle around the agent crosses it.
//!
//! Conservative: if this returns a side, it is the true one. It may return nothing.

use crate::belief::sample::Label;
use crate::geometry::angle::CoarseAngle;
use crate::geometry::approximate::{acos, heading_of, single, sqrt};
use crate::geometry::heading::Heading;
use crate::geometry::lattice::Vector;
use crate::geometry::line::Bound;
use crate::motion::dynamics::Side;

/// Covers the errors of an arc cosine and of a heading, some 10^-4 rad, twice.
const MARGIN: CoarseAngle = CoarseAngle::radians(2.048_1e-4);

/// Within this, and some margin beside, the arc cosine of `x` falls by less than `1 + 1.75 x^2`.
const STEEP: f32 = 0.9;

/// A line as seen from the agent: at a radius `r` and a heading `t` its value is
/// `height + r cos(t - uphill)`.
#[derive(Clone, Copy)]
pub(crate) struct SeenLine {
    /// Distance of the agent from the line in lattice units, positive on its +1 side, to 10^-5 of it.
    pub(crate) height: f32,
    /// The heading of its normal.
    pub(crate) uphill: Heading,
    crossing: CircleCrossing,
}

/// Where a circle around the agent crosses a line. Within the angle `above` of uphill, on either side, the circle is on
/// the +1 side. Beyond the angle `below` it is on the other side. Between the two is the margin.
#[derive(Clone, Copy, PartialEq, Eq)]
struct CircleCrossing {
    above: CoarseAngle,
    below: CoarseAngle,
}

impl CircleCrossing {
    /// No circle has been looked at: nothing is certain.
    const UNKNOWN: Self = Self { above: CoarseAngle::NEVER, below: CoarseAngle::WHOLE_TURN };
    /// The circle is on the +1 side all around.
    const ALL_ABOVE: Self = Self { above: CoarseAngle::WHOLE_TURN, below: CoarseAngle::WHOLE_TURN };
    /// It is on the other.
    const ALL_BELOW: Self = Self { above: CoarseAngle::NEVER, below: CoarseAngle::ZERO };
}

impl SeenLine {
    pub(crate) const fn new(height: f32, uphill: Heading) -> Self {
        Self { height, uphill, crossing: CircleCrossing::UNKNOWN }
    }

    /// A line that bounds what is known, and its value where the agent is.
    pub(crate) fn of(Bound { along, .. }: Bound, value: i64) -> Self {
        let (x, z) = (along.x as f32, along.z as f32);
        Self::new(single(value) / sqrt(x * x + z * z), heading_of(along.left()))
    }

    /// The place of the line that is nearest to the agent, as seen from there, and a unit vector along the line.
    pub(crate) fn foot_and_way(&self) -> ([f32; 2], [f32; 2]) {
        const ONE: i32 = 1 << 30;
        let Vector { x, z } = self.uphill.unit().scaled(ONE);
        let [x, z] = [x, z].map(|v| v as f32 / ONE as f32);
        ([-x * self.height, -z * self.height], [-z, x])
    }

    /// How far another line is from this one within a distance of the agent, at most.
    pub(crate) fn aside(&self, other: &Self, reach: f32) -> f32 {
        let turn = CoarseAngle::between(self.uphill, other.uphill).abs().in_radians();
        (other.height - self.height).abs() + reach * turn
    }

    /// Looks at a circle; `margin`, in radii, is for the rounding of positions to the lattice.
    #[expect(
        clippy::inline_always,
        reason = "a build for size does it for each line of each circle"
    )]
    #[inline(always)]
    pub(crate) fn cross(&mut self, inverse_radius: f32, margin: f32) {
        let depth = -self.height * inverse_radius;
        if self.height == 0.0 && self.crossing != CircleCrossing::UNKNOWN {
            return; // a line through the agent crosses all circles alike
        }
        if depth.abs() < STEEP {
            let angle = acos(depth);
            let margin = CoarseAngle::radians_times(margin, 1.0 + 1.75 * (depth * depth)) + MARGIN;
            self.crossing = CircleCrossing { above: angle - margin, below: angle + margin };
        } else {
            self.cross_wide(inverse_radius, margin);
        }
    }

    /// The same for any margin, such as for lines that this one stands for.
    #[inline(never)] // called from two places, by the other case of a small function
    pub(crate) fn cross_wide(&mut self, inverse_radius: f32, margin: f32) {
        let depth = -self.height * inverse_radius;
        let (most, least) = (depth + margin, depth - margin);
        self.crossing = if most <= -1.0 {
            CircleCrossing::ALL_ABOVE
        } else if least >= 1.0 {
            CircleCrossing::ALL_BELOW
        } else {
            let above = acos(most.clamp(-1.0, 1.0)) - MARGIN;
            CircleCrossing { above, below: acos(least.clamp(-1.0, 1.0)) + MARGIN }
        };
    }

    /// The side of the line on which the circle is at a heading, if that is certain. Also returns the turn within which
    /// it stays there.
    #[expect(clippy::inline_always, reason = "a build for size does it for each line of each look")]
    #[inline(always)]
    pub(crate) fn certain_until(
        &self,
        heading: Heading,
        side: Side,
    ) -> Option<(Label, CoarseAngle)> {
        let CircleCrossing { above, below } = self.crossing;
        let turned = CoarseAngle::between(self.uphill, heading);
        let turned = if side == Side::Left { turned } else { -turned };
        let away = turned.abs();
        if away <= above {
            return Some((Label::Positive, above - turned));
        }
        // The other way around to uphill.
        let around =
            if turned > CoarseAngle::ZERO { CoarseAngle::WHOLE_TURN - turned } else { away };
        (away >= below).then(|| (Label::Negative, around - below))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_as_far_apart_as_a_turn_takes_them_within_reach() {
        let line = SeenLine::new(3.0, Heading(0));
        let other = SeenLine::new(5.0, Heading::from_radians(0.01).unwrap());
        let aside = line.aside(&other, 1_000.0);
        assert!((aside - 12.0).abs() < 0.2, "{aside}");
    }
}
