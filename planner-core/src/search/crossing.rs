//! A line as it looks from the agent, and where it cuts a circle around it.
//!
//! Approximate and on the safe side: what surely is on one side of the line is.

use crate::belief::sample::Label;
use crate::geometry::approximate::{HALF_TURN, UNITS_PER_RADIAN, acos, sqrt};
use crate::geometry::direction::Heading;
use crate::geometry::line::Bound;
use crate::motion::dynamics::Side;

/// Room for the error of an arc cosine and of a heading: 2 10^-4 rad.
const ROOM: i32 = 35_000;

/// Within this, and some room beside, the arc cosine of `x` falls by less than `1 + 1.75 x^2`.
const STEEP: f32 = 0.9;

/// A line as seen from the agent: at a radius `r` and a heading `t` its value is
/// `height + r cos(t - uphill)`.
#[derive(Clone, Copy)]
pub(crate) struct Mark {
    /// Distance of the agent from the line in lattice units, positive on its +1 side, to 10^-5 of it.
    pub(crate) height: f32,
    /// The heading of its normal.
    pub(crate) uphill: Heading,
    /// On the circle looked at: up to this angle to either side of uphill, it surely is on the line's
    /// +1 side.
    above: i32,
    /// On the circle looked at: from this angle on it surely is on the other side.
    below: i32,
}

impl Mark {
    pub(crate) const fn new(height: f32, uphill: Heading) -> Self {
        Self { height, uphill, above: -1, below: 2 * HALF_TURN }
    }

    pub(crate) fn of(Bound { along, .. }: Bound, value: i64) -> Self {
        let (x, z) = (along.x as f32, along.z as f32);
        Self::new(value as f32 / sqrt(x * x + z * z), Heading::near(along.left()))
    }

    /// How far another line is from this one within a distance of the agent, at most.
    pub(crate) fn aside(&self, other: &Self, reach: f32) -> f32 {
        let turn = ((other.uphill.0.wrapping_sub(self.uphill.0) as i32).unsigned_abs() >> 2) as f32;
        (other.height - self.height).abs() + reach * (turn / UNITS_PER_RADIAN)
    }

    /// Looks at a circle; `room`, in radii, is for the rounding of positions to the lattice.
    pub(crate) fn cut(&mut self, inverse_radius: f32, room: f32) {
        let depth = -self.height * inverse_radius;
        if self.height == 0.0 && self.above >= 0 {
            return; // a line through the agent cuts all circles alike
        }
        if depth.abs() < STEEP {
            let angle = acos(depth);
            let slack = ((1.0 + 1.75 * (depth * depth)) * (room * UNITS_PER_RADIAN)) as i32 + ROOM;
            (self.above, self.below) = (angle - slack, angle + slack);
        } else {
            self.cut_wide(inverse_radius, room);
        }
    }

    /// The same for any room, such as for lines that this one stands for.
    pub(crate) fn cut_wide(&mut self, inverse_radius: f32, room: f32) {
        let depth = -self.height * inverse_radius;
        let (most, least) = (depth + room, depth - room);
        (self.above, self.below) = if most <= -1.0 {
            // A line that misses the circle leaves it on one side all around.
            (2 * HALF_TURN, 2 * HALF_TURN)
        } else if least >= 1.0 {
            (-1, -HALF_TURN)
        } else {
            (acos(most.clamp(-1.0, 1.0)) - ROOM, acos(least.clamp(-1.0, 1.0)) + ROOM)
        };
    }

    /// Which side of the line the circle surely is on at a heading, and how far a turn stays there.
    pub(crate) fn surely(&self, heading: Heading, side: Side) -> Option<(Label, i32)> {
        let turned = (heading.0.wrapping_sub(self.uphill.0) as i32) >> 2;
        let turned = if side == Side::Left { turned } else { -turned };
        let away = turned.abs();
        if away <= self.above {
            return Some((Label::Positive, self.above - turned));
        }
        // The other way around to uphill.
        let around = if turned > 0 { 2 * HALF_TURN - turned } else { away };
        (away >= self.below).then(|| (Label::Negative, around - self.below))
    }
}
