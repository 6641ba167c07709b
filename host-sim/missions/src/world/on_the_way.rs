//! Where a robot reads on the way of a motion.

use nalgebra::{Point2, Vector2};
use planner_core::{Heading, Pose, Site};

/// How many readings a motion has, and what its way is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    /// Readings a motion, evenly spread over its length. The last is at its end, where the planner asks for it.
    pub readings: u32,
    /// Whether a motion is one arc. Otherwise it is a turn, and then a straight drive.
    pub is_arc: bool,
}

impl Way {
    /// A motion with a reading at its end alone.
    pub const END: Self = Self { readings: 1, is_arc: false };

    /// Where readings before the last lie between two poses; none where the robot stays where it is.
    ///
    /// An arc turns by `w`. Its place after a share `t` lies in the direction of the chord, turned back by `(1 - t) w / 2`.
    /// It is `sin(t w / 2) / sin(w / 2)` of the chord's length away.
    pub fn sites(self, from: Pose, to: Pose) -> impl Iterator<Item = Site> {
        let [start, end] = [from, to].map(|pose| Point2::<f64>::from(pose.site));
        let (chord, readings) = (end - start, self.readings);
        let turn = Heading(to.heading.0.wrapping_sub(from.heading.0)).radians();
        let half = if self.is_arc { 0.5 * turn } else { 0.0 };
        let last = if chord == Vector2::zeros() { 0 } else { readings };
        (1..last).map(move |k| {
            let share = f64::from(k) / f64::from(readings);
            let (sin, cos) = libm::sincos((share - 1.0) * half);
            let is_straight = half.abs() < 1e-9;
            let length =
                if is_straight { share } else { libm::sin(share * half) / libm::sin(half) };
            let way = Vector2::new(cos * chord.x - sin * chord.y, sin * chord.x + cos * chord.y);
            // It lies beside the chord of two sites by less than that is long.
            Site::try_from(start + way * length).unwrap_or(from.site)
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::*;

    fn pose(x: f64, z: f64, heading: f64) -> Pose {
        let heading = Heading::from_radians(heading).expect("an angle");
        Pose::at([x, z], heading).expect("within the lattice")
    }

    fn places(way: Way, from: Pose, to: Pose) -> Vec<Point2<f64>> {
        way.sites(from, to).map(Point2::from).collect()
    }

    #[test]
    fn readings_are_evenly_spread_and_the_end_is_none_of_them() {
        let (from, to) = (pose(1.0, 2.0, 0.3), pose(3.0, 1.0, 5.0));
        let way = Way { readings: 4, is_arc: false };
        let expected = [[1.5, 1.75], [2.0, 1.5], [2.5, 1.25]].map(Point2::from);
        assert_eq!(places(way, from, to), expected);
        assert!(places(way, from, from).is_empty());
        assert!(places(Way::END, from, to).is_empty());
    }

    #[test]
    fn along_an_arc_they_lie_on_its_circle() {
        for (side, turn) in [(1.0, FRAC_PI_2), (-1.0, -FRAC_PI_2)] {
            // A quarter of the circle with the radius 2 about (0, 2) or (0, -2), from the origin.
            let (from, to) = (pose(0.0, 0.0, 0.0), pose(2.0, 2.0 * side, turn));
            let way = Way { readings: 2, is_arc: true };
            let [middle] = places(way, from, to)[..] else { panic!("one in the middle") };
            let (sin, cos) = FRAC_PI_4.sin_cos();
            let expected = Point2::new(2.0 * sin, 2.0 * side * (1.0 - cos));
            assert!((middle - expected).norm() < 1e-4, "{middle}");
            let all = places(Way { readings: 50, ..way }, from, to);
            let mut before = Point2::origin();
            for at in all {
                assert!(((at - Point2::new(0.0, 2.0 * side)).norm() - 2.0).abs() < 1e-4, "{at}");
                assert!(((at - before).norm() - 0.062_83).abs() < 1e-3, "{at} after {before}");
                before = at;
            }
        }
    }
}
