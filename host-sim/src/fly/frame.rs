//! Where the scenario lies in the vehicle's local frame: its x points east, its z north, and its origin is the
//! vehicle's own, from which `LOCAL_POSITION_NED` counts. In an area from a map places have a latitude and a longitude, and
//! the vehicle says those of its origin (`GPS_GLOBAL_ORIGIN`).
//!
//! Local positions are single precision. Sites are 2^-16 m apart, so within 128 m of the origin each has a float of its
//! own. Further out the nearest float is taken, at most half a millimetre off.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Point2, Vector2};
use planner_core::{Heading, Pose, Site};

use crate::mission::lake::Lake;
use crate::world::frame::Frame;

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

/// The scenario in the vehicle's local frame: the same frame, or a map whose places have a latitude and a longitude.
#[derive(Clone, Debug, Default)]
pub struct Local(Option<OnMap>);

/// A map, and the latitude and the longitude that the vehicle counts from.
#[derive(Clone, Debug)]
struct OnMap {
    map: Frame,
    origin: [f64; 2],
}

impl Local {
    /// The frame of a scenario's map, if it has one, for a vehicle that counts from a latitude and a longitude.
    pub fn of(map: Option<&Lake>, origin: Option<[f64; 2]>) -> Self {
        Self(map.zip(origin).map(|(lake, origin)| OnMap { map: lake.frame.clone(), origin }))
    }

    /// Where a site lies; `None` if the map has no latitude there.
    pub fn ned(&self, site: Site) -> Option<Ned> {
        let Some(on) = &self.0 else { return Some(site.into()) };
        let [north, east] = on.north_east(site.into())?;
        Some(Ned { north: north as f32, east: east as f32 })
    }

    /// The site of a place; `None` if it is off the lattice.
    pub fn site(&self, at: Ned) -> Option<Site> {
        let [north, east] = [at.north, at.east].map(f64::from);
        match &self.0 {
            None => Site::try_from(Point2::new(east, north)).ok(),
            Some(on) => on.map.site_on_globe(offset(on.origin, [north, east])).ok(),
        }
    }

    /// The yaw of a pose's heading.
    pub fn yaw(&self, pose: Pose) -> f32 {
        let turn = self.0.as_ref().and_then(|on| on.turn(pose.site.into())).unwrap_or(0.0);
        libm::remainder(f64::from(yaw(pose.heading)) + turn, TAU) as f32
    }

    /// The pose of a vehicle that was sent to the pose `sent`. A place that equals the target's in single precision counts
    /// as the target's. So does a yaw that is [`ALIKE`]. `None` if it is off the lattice.
    pub fn pose(&self, sent: Pose, at: Ned, facing: f32) -> Option<Pose> {
        let site = if self.ned(sent.site) == Some(at) { sent.site } else { self.site(at)? };
        let own = self.yaw(sent);
        let heading = if apart(facing, own) < ALIKE {
            sent.heading
        } else {
            let turned = libm::remainder(f64::from(own) - f64::from(facing), TAU);
            Heading::from_radians(sent.heading.radians() + turned).ok()?
        };
        Some(Pose { site, heading })
    }
}

impl OnMap {
    /// How far north and east of the vehicle's origin a place of the map lies, metres.
    fn north_east(&self, at: Point2<f64>) -> Option<[f64; 2]> {
        Some(apart_on_globe(self.origin, self.map.on_globe(at).ok()?))
    }

    /// By how much the map's north is turned to the east, as the vehicle sees it.
    fn turn(&self, at: Point2<f64>) -> Option<f64> {
        let [from, to] = [at, at + Vector2::y() * AHEAD].map(|it| self.north_east(it));
        let ([n, e], [north, east]) = (from?, to?);
        Some(libm::atan2(east - e, north - n))
    }
}

/// Metres between the two places that tell where north is.
const AHEAD: f64 = 100.0;

/// Metres to the north of a degree, as `ArduPilot` counts.
const DEGREE: f64 = 111_318.845_021_450_34;

/// How far north and east one latitude and longitude is of another, as `ArduPilot` counts.
pub(crate) fn apart_on_globe(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let east = libm::remainder(to[1] - from[1], 360.0);
    [(to[0] - from[0]) * DEGREE, east * DEGREE * of_longitude(f64::midpoint(from[0], to[0]))]
}

/// The latitude and longitude so far north and east of another.
fn offset(from: [f64; 2], [north, east]: [f64; 2]) -> [f64; 2] {
    let lat = from[0] + north / DEGREE;
    let lon = from[1] + east / DEGREE / of_longitude(f64::midpoint(from[0], lat));
    [lat, libm::remainder(lon, 360.0)]
}

/// How long a degree of longitude is at a latitude, of one at the equator.
fn of_longitude(lat: f64) -> f64 {
    libm::cos(lat.to_radians()).max(0.01)
}

#[cfg(test)]
mod tests {
    use geographiclib_rs::{Geodesic, InverseGeodesic as _};

    use super::*;
    use crate::world::crs::Crs;

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
            let back = Local::default()
                .pose(sent, there.into(), yaw(sent.heading))
                .expect("on the lattice");
            assert_eq!(back, Pose { site: there, ..sent });
        }
        let turned =
            Local::default().pose(sent, sent.site.into(), yaw(sent.heading) + 1.0).expect("finite");
        let off = turned.heading.0.wrapping_sub(sent.heading.0) as i32;
        assert!((Heading(off as u32).radians() + 1.0).abs() < 1e-6, "{off}");
    }

    #[test]
    fn what_single_precision_cannot_tell_apart_is_where_it_was_sent() {
        let far = Site::new(400_000_001, 7).expect("on the lattice");
        let sent = Pose { site: far, heading: Heading(5) };
        assert_eq!(Local::default().pose(sent, far.into(), yaw(Heading(5))), Some(sent));
        assert_eq!(Local::default().pose(sent, Ned { north: 0.0, east: f32::NAN }, 0.0), None);
        assert_eq!(Local::default().pose(sent, Ned { north: 0.0, east: 9000.0 }, 0.0), None);
    }

    /// A map in degrees and one of a system, for vehicles that count from some way off, across the date line too.
    #[test]
    fn places_of_a_map_go_there_and_back() {
        let utm: Crs = "EPSG:32635".parse().expect("known");
        for (places, crs) in [
            ([[60.20, 24.90], [60.21, 24.92], [60.205, 24.93]], None),
            ([[-17.0, 179.999], [-17.01, -179.999], [-17.02, 179.99]], None),
            (
                [[383_000.0, 6_675_000.0], [384_000.0, 6_675_500.0], [384_000.0, 6_676_000.0]],
                Some(&utm),
            ),
        ] {
            let map = Frame::of(&places, crs.is_none(), None, crs).expect("a map");
            let middle = map.on_globe(Point2::origin()).expect("on the globe");
            let origin = [middle[0] - 0.02, middle[1] + 0.03];
            let local = Local(Some(OnMap { map: map.clone(), origin }));
            for (x, z) in [(0.0, 0.0), (-700.0, 300.0), (3_000.0, -4_000.0)] {
                let there = site(x, z);
                let at = local.ned(there).expect("on the globe");
                let back = local.site(at).expect("on the lattice");
                let [a, b] = [there, back].map(Point2::<f64>::from);
                // Single precision is half a millimetre this far off.
                assert!((a - b).norm() < 2e-3, "{a} {b}");
                let sent = Pose { site: there, heading: Heading(1 << 30) };
                assert_eq!(local.pose(sent, at, local.yaw(sent)), Some(sent));
                // Its way north, by the ellipsoid.
                let ahead = map.on_globe(a + Vector2::y() * AHEAD).expect("on the globe");
                let from = map.on_globe(a).expect("on the globe");
                let north: f64 = {
                    let (_, azimuth, ..): (f64, f64, f64, f64) =
                        Geodesic::wgs84().inverse(from[0], from[1], ahead[0], ahead[1]);
                    azimuth.to_radians()
                };
                assert!((f64::from(local.yaw(sent)) - north).abs() < 1e-3, "{north}");
            }
        }
    }
}
