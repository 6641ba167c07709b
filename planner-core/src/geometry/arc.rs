//! Arcs of directions modulo pi: the slopes that a line may have.

use heapless::Vec;

use crate::geometry::approximate::sqrt;
use crate::geometry::lattice::Vector;

/// An arc of directions modulo pi, narrower than pi: the paper's `E_rho`, as the exact directions
/// of its two ends.
///
/// A line has no front, so a direction lies in the arc when it or its opposite does. An arc across
/// the vertical is the paper's "disjoint union of two intervals".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlopeArc {
    from: Vector,
    to: Vector,
}

impl SlopeArc {
    /// The arc that runs counter-clockwise from one direction to another, less than half a turn.
    pub const fn new(from: Vector, to: Vector) -> Self {
        Self { from, to }
    }

    /// The arc that spans all these oriented directions, which lie within half a turn of each
    /// other; `None` when there are none.
    pub fn spanning(directions: impl IntoIterator<Item = Vector>) -> Option<Self> {
        directions.into_iter().fold(None, |arc, d| {
            let Self { from, to } = arc.unwrap_or(Self { from: d, to: d });
            Some(Self {
                from: if from.cross(d) < 0 { d } else { from },
                to: if to.cross(d) > 0 { d } else { to },
            })
        })
    }

    /// The arc that spans two which lie within half a turn of each other.
    #[must_use]
    pub const fn hull(self, other: Self) -> Self {
        Self {
            from: if self.from.cross(other.from) < 0 { other.from } else { self.from },
            to: if self.to.cross(other.to) > 0 { other.to } else { self.to },
        }
    }

    /// The arc of directions that track one: those within 0.9 degrees of it (a tangent of 1/64). The rays of the
    /// paper's grid are 0.57 degrees apart, so some ray always lies in the arc.
    pub const fn tracking(direction: Vector) -> Self {
        let (d, aside) = (direction, direction.left());
        Self {
            from: Vector { x: d.x - aside.x / 64, z: d.z - aside.z / 64 },
            to: Vector { x: d.x + aside.x / 64, z: d.z + aside.z / 64 },
        }
    }

    /// The directions of this arc that track its bisector.
    #[must_use]
    pub fn middle(&self) -> Self {
        let middle = Self::tracking(self.bisector());
        if self.contains(middle.from) { middle } else { *self }
    }

    /// Where the arc begins.
    pub const fn from(&self) -> Vector {
        self.from
    }

    /// Where the arc ends, counter-clockwise from its beginning.
    pub const fn to(&self) -> Vector {
        self.to
    }

    /// Whether the direction or its opposite lies in the arc, ends included. Exact.
    pub const fn contains(&self, direction: Vector) -> bool {
        let (from, to) = (self.from.cross(direction), direction.cross(self.to));
        (from >= 0 && to >= 0) || (from <= 0 && to <= 0)
    }

    /// The direction that halves the arc, some 2^28 units long. Rounded: it proposes, and decides
    /// nothing.
    pub fn bisector(&self) -> Vector {
        let unit = |v: Vector| {
            let (x, z) = (v.x as f32, v.z as f32);
            let scale = (1 << 27) as f32 / sqrt(x * x + z * z);
            (x * scale, z * scale)
        };
        let ((ax, az), (bx, bz)) = (unit(self.from), unit(self.to));
        let (x, z) = (ax + bx, az + bz);
        // Of nearly opposite ends the sum has no digits left: their difference is at right angles to it.
        let is_sum = x.abs() + z.abs() > (1 << 25) as f32;
        let (x, z) = if is_sum { (x, z) } else { (bz - az, ax - bx) };
        Vector { x: x as i32, z: z as i32 }
    }

    /// Width in degrees.
    pub fn width_deg(&self) -> f64 {
        libm::atan2(self.from.cross(self.to) as f64, self.from.dot(self.to) as f64).to_degrees()
    }

    /// The arc as intervals of slope angles in degrees within [-90, 90]: one, or two when it
    /// crosses the vertical.
    pub fn intervals_deg(&self) -> Vec<[f64; 2], 2> {
        let angle = |v: Vector| {
            let v = if v.x < 0 { v.reversed() } else { v };
            libm::atan2(f64::from(v.z), f64::from(v.x)).to_degrees()
        };
        // Oriented, the arc crosses the vertical exactly when its ends point to opposite sides.
        let crosses = (self.from.x > 0 && self.to.x < 0) || (self.from.x < 0 && self.to.x > 0);
        // An end on the vertical is 90 or -90, whichever side the arc lies on.
        let from = if self.from.x == 0 { -90.0 } else { angle(self.from) };
        let to = if self.to.x == 0 { 90.0 } else { angle(self.to) };
        if crosses {
            Vec::from_array([[-90.0, to], [from, 90.0]])
        } else {
            Vec::from_iter([[from, to]])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn v(x: i32, z: i32) -> Vector {
        Vector { x, z }
    }

    #[test]
    fn a_direction_and_its_opposite_are_one() {
        let arc = SlopeArc::new(v(10, -1), v(10, 7));
        for (direction, inside) in [
            (v(1, 0), true),
            (v(-1, 0), true),
            (v(10, 7), true),
            (v(-10, 1), true),
            (v(0, 1), false),
        ] {
            assert_eq!(arc.contains(direction), inside, "{direction:?}");
        }
        assert!(SlopeArc::new(v(1, 1), v(1, 1)).contains(v(-3, -3)));
        assert!(!SlopeArc::new(v(1, 1), v(1, 1)).contains(v(3, 2)));
    }

    #[test]
    fn an_arc_across_the_vertical_is_two_intervals() {
        assert_eq!(
            SlopeArc::new(v(1, 1), v(-1, 1)).intervals_deg(),
            [[-90.0, -45.0], [45.0, 90.0]]
        );
        assert_eq!(
            SlopeArc::new(v(-1, -1), v(1, -1)).intervals_deg(),
            [[-90.0, -45.0], [45.0, 90.0]]
        );
        assert_eq!(SlopeArc::new(v(1, -1), v(1, 1)).intervals_deg(), [[-45.0, 45.0]]);
        assert_eq!(SlopeArc::new(v(-1, 1), v(-1, -1)).intervals_deg(), [[-45.0, 45.0]]);
        assert_eq!(SlopeArc::new(v(1, 1), v(0, 1)).intervals_deg(), [[45.0, 90.0]]);
        assert_eq!(SlopeArc::new(v(0, 1), v(-1, 1)).intervals_deg(), [[-90.0, -45.0]]);
    }

    #[test]
    fn a_bisector_halves_arcs_of_any_width() {
        for n in 1..20_000 {
            let wide = core::f64::consts::PI * (1.0 - 1.0 / f64::from(n));
            let (sin, cos) = libm::sincos(wide);
            let arc = SlopeArc::new(v(1 << 28, 0), v((cos * 268e6) as i32, (sin * 268e6) as i32));
            let Vector { x, z } = arc.bisector();
            let off = libm::atan2(f64::from(z), f64::from(x)) - wide / 2.0;
            assert!(off.abs() < 2e-4, "{n}: {off}");
        }
    }

    #[test]
    fn the_arc_of_several_directions_has_their_outermost_as_ends() {
        let arc = SlopeArc::spanning([v(3, 1), v(1, 3), v(2, -1), v(1, 1)]).unwrap();
        assert_eq!((arc.from(), arc.to()), (v(2, -1), v(1, 3)));
        assert!(arc.contains(arc.bisector()));
        assert_eq!(SlopeArc::spanning([]), None);
    }
}
