//! Where the scenario lies in the vehicle's local frame: its x points east, its z north, and its origin is the
//! vehicle's own, from which `LOCAL_POSITION_NED` counts.
//!
//! Local positions are single precision. Sites are 2^-16 m apart, so within 128 m of the origin each has a float of its
//! own. Further out the nearest float is taken, at most half a millimetre off.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Point2;
use planner_core::{Heading, Pose, Site};

/// Yaws that differ by less, in radians, are taken for the same: a compass knows no better.
pub const ALIKE: f64 = 0.1;

/// A place in the local frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ned {
    /// To the north.
    pub north: f32,
    /// To the east.
    pub east: f32,
}

impl Ned {
    /// How far apart two places are, metres.
    pub fn distance(self, other: Self) -> f64 {
        let [north, east] = [self.north - other.north, self.east - other.east].map(f64::from);
        libm::hypot(north, east)
    }
}

impl From<Site> for Ned {
    fn from(site: Site) -> Self {
        let at = Point2::<f64>::from(site);
        Self { north: at.y as f32, east: at.x as f32 }
    }
}

/// The yaw of a heading: clockwise from north, where headings count anticlockwise from x. In [-pi, pi].
pub fn yaw(heading: Heading) -> f32 {
    libm::remainder(FRAC_PI_2 - heading.radians(), TAU) as f32
}

/// By how much two yaws differ, radians.
pub fn apart(a: f32, b: f32) -> f64 {
    libm::remainder(f64::from(a) - f64::from(b), TAU).abs()
}

/// The site of a place; `None` if it is off the lattice.
pub fn site(at: Ned) -> Option<Site> {
    Site::try_from(Point2::new(f64::from(at.east), f64::from(at.north))).ok()
}

/// The pose of a vehicle that was sent to the pose `sent`. A place that equals the target's in single precision counts
/// as the target's. So does a yaw that is [`ALIKE`]. `None` if it is off the lattice.
pub fn pose(sent: Pose, at: Ned, facing: f32) -> Option<Pose> {
    let site = if Ned::from(sent.site) == at { sent.site } else { site(at)? };
    let heading = if apart(facing, yaw(sent.heading)) < ALIKE {
        sent.heading
    } else {
        Heading::from_radians(FRAC_PI_2 - f64::from(facing)).ok()?
    };
    Some(Pose { site, heading })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site(x: f64, z: f64) -> Site {
        Site::try_from(Point2::new(x, z)).expect("on the lattice")
    }

    #[test]
    fn x_is_east_and_z_is_north() {
        assert_eq!(Ned::from(site(3.0, -4.5)), Ned { north: -4.5, east: 3.0 });
        for (heading, faces) in [(0.0, 90.0), (90.0, 0.0), (180.0, -90.0), (-90.0, 180.0)] {
            let heading = Heading::from_radians(f64::to_radians(heading)).expect("finite");
            assert!(apart(yaw(heading), f32::to_radians(faces)) < 1e-6, "{faces}");
        }
    }

    #[test]
    fn places_within_128_m_and_yaws_go_there_and_back() {
        let sent = Pose { site: site(0.0, 0.0), heading: Heading(12_345_678) };
        for units in [1, 65_535, 8_388_607, -8_388_607] {
            let there = Site::new(units, -units).expect("on the lattice");
            let back = pose(sent, there.into(), yaw(sent.heading)).expect("on the lattice");
            assert_eq!(back, Pose { site: there, ..sent });
        }
        let turned = pose(sent, sent.site.into(), yaw(sent.heading) + 1.0).expect("finite");
        let off = turned.heading.0.wrapping_sub(sent.heading.0) as i32;
        assert!((Heading(off as u32).radians() + 1.0).abs() < 1e-6, "{off}");
    }

    #[test]
    fn what_single_precision_cannot_tell_apart_is_where_it_was_sent() {
        let far = Site::new(400_000_001, 7).expect("on the lattice");
        let sent = Pose { site: far, heading: Heading(5) };
        assert_eq!(pose(sent, far.into(), yaw(Heading(5))), Some(sent));
        assert_eq!(pose(sent, Ned { north: 0.0, east: f32::NAN }, 0.0), None);
        assert_eq!(pose(sent, Ned { north: 0.0, east: 9000.0 }, 0.0), None);
    }
}
