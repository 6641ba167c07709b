//! Where recorded positions lie on the lattice, which reaches 8,192 m about its origin.
//!
//! Positions that are all within the lattice stay as they are. Others, such as the eastings and northings of a map, are
//! shifted to the middle of the data. The shift is in whole metres, so it rounds nothing. Latitude and longitude
//! (WGS84) are projected about their middle, keeping distance and direction from there (azimuthal equidistant): x is to
//! the east and z to the north. Within 8 km a straight line of this map is a straight way on the ground to less than a
//! centimetre.

use anyhow::{Result, anyhow, bail};
use geographiclib_rs::{DirectGeodesic as _, Geodesic, InverseGeodesic as _};
use nalgebra::Point2;
use planner_core::lattice::{LIMIT, UNITS_PER_METRE};
use planner_core::{Line, Site};
use serde::Serialize;

use crate::world::crs::Crs;
use crate::world::extent::span;

/// How far the lattice reaches, metres.
const REACH: f64 = LIMIT as f64 / UNITS_PER_METRE as f64;

/// Of latitude; a degree of longitude has fewer.
const METRES_PER_DEGREE: f64 = 111_320.0;

/// Rows that have a middle: fewer bound no line.
const FEWEST: usize = 3;

/// How recorded positions become positions on the lattice: metres, or latitude and longitude, about an origin if they
/// have one.
#[derive(Clone, Debug, Serialize)]
pub struct Frame {
    #[serde(skip_serializing_if = "Option::is_none")]
    /// Latitude and longitude, or metres.
    pub origin: Option<[f64; 2]>,
    /// The coordinate system of the metres, if it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crs: Option<Crs>,
    /// Of latitude and longitude, degrees.
    #[serde(skip)]
    ellipsoid: Option<Geodesic>,
}

/// What coordinates are.
#[derive(Clone, Debug)]
pub enum System {
    /// Those of the map.
    OfMap,
    /// Longitudes and latitudes of WGS84, degrees.
    Degrees,
    /// Metres of another system.
    Metres(Crs),
}

impl Frame {
    /// The frame of some positions, about an origin if there is one.
    ///
    /// # Errors
    /// Names the origin if it is no place.
    pub fn of(
        positions: &[[f64; 2]],
        is_geographic: bool,
        origin: Option<[f64; 2]>,
        crs: Option<&Crs>,
    ) -> Result<Self> {
        let is_near = |at: &[f64; 2]| Site::try_from(Point2::from(*at)).is_ok();
        let is_plain = || positions.len() < FEWEST || positions.iter().all(is_near);
        let origin = match origin {
            Some(_) => origin,
            None if is_geographic && crs.is_none() => Some(geographic_middle(positions)),
            None if crs.is_none() && is_plain() => None,
            None => Some(middle(positions, REACH).map(f64::round)),
        };
        let mut ellipsoid = None;
        match (crs, origin) {
            (Some(crs), Some(origin)) => crs.check(origin)?,
            (None, Some(origin)) if is_geographic => {
                check_degrees(origin).map_err(|error| anyhow!("the origin: {error}"))?;
                ellipsoid = Some(Geodesic::wgs84());
            }
            _ => {}
        }
        Ok(Self { origin, crs: crs.cloned(), ellipsoid })
    }

    /// The site of a recorded position.
    ///
    /// # Errors
    /// How far off it lies, if that is too far.
    pub fn site(&self, [x, z]: [f64; 2]) -> Result<Site> {
        let [x0, z0] = self.origin.unwrap_or_default();
        let at = if let Some(ellipsoid) = &self.ellipsoid {
            let (metres, azimuth, ..): (f64, f64, f64, f64) = ellipsoid.inverse(x0, z0, x, z);
            let (sin, cos) = libm::sincos(azimuth.to_radians());
            [metres * sin, metres * cos]
        } else {
            [x - x0, z - z0]
        };
        Site::try_from(Point2::from(at)).map_err(|error| match self.origin {
            None => anyhow!("({x}, {z}): {error}"),
            Some(_) => anyhow!(
                "({x}, {z}): found {:.0} m from the origin ({x0}, {z0}), expected less than {REACH} m along each axis",
                libm::hypot(at[0], at[1])
            ),
        })
    }

    /// Whether positions are latitude and longitude.
    pub const fn is_geographic(&self) -> bool {
        self.ellipsoid.is_some()
    }

    /// A position as it would have been recorded: `x` and `z`, or latitude and longitude.
    pub fn recorded(&self, at: Point2<f64>) -> [f64; 2] {
        let it = self.exactly(at);
        if self.is_geographic() { it.map(to_grain) } else { it }
    }

    /// The same with all digits, so that [`site`](Self::site) finds the same place again.
    pub fn exactly(&self, at: Point2<f64>) -> [f64; 2] {
        let [x0, z0] = self.origin.unwrap_or_default();
        let Some(ellipsoid) = &self.ellipsoid else { return [at.x + x0, at.y + z0] };
        let azimuth = libm::atan2(at.x, at.y).to_degrees();
        let (lat, lon): (f64, f64) = ellipsoid.direct(x0, z0, azimuth, libm::hypot(at.x, at.y));
        [lat, lon]
    }

    /// Latitude and longitude of a position, with all digits.
    ///
    /// # Errors
    /// Metres have none by themselves.
    pub fn on_globe(&self, at: Point2<f64>) -> Result<[f64; 2]> {
        let exactly = self.exactly(at);
        match &self.crs {
            _ if self.is_geographic() => Ok(exactly),
            Some(crs) => crs.degrees(exactly),
            None => bail!("found metres, expected latitude and longitude"),
        }
    }

    /// The site of a latitude and a longitude.
    ///
    /// # Errors
    /// As [`site`](Self::site), and where the system does not reach.
    pub fn site_on_globe(&self, degrees: [f64; 2]) -> Result<Site> {
        self.site(self.crs.as_ref().map_or(Ok(degrees), |crs| crs.metres(degrees))?)
    }

    /// A position in coordinates of a system, the first one to the east. Longitudes count from about `middle`.
    ///
    /// # Errors
    /// The system does not reach there.
    pub fn on_map(
        &self,
        at: Point2<f64>,
        system: &System,
        middle: Point2<f64>,
    ) -> Result<Point2<f64>> {
        let degrees = |[lat, lon]: [f64; 2]| {
            Point2::new(middle.x + libm::remainder(lon - middle.x, 360.0), lat)
        };
        Ok(match system {
            System::OfMap if self.is_geographic() => degrees(self.exactly(at)),
            System::OfMap => self.exactly(at).into(),
            System::Degrees => degrees(self.on_globe(at)?),
            System::Metres(crs) => crs.metres(self.on_globe(at)?)?.into(),
        })
    }

    /// A position in the file's coordinates, if these are not the planner's.
    pub fn in_file(&self, at: Point2<f64>) -> Option<[f64; 2]> {
        self.origin.map(|_| self.recorded(at))
    }

    /// Whether positions have a latitude and a longitude.
    pub fn is_on_globe(&self) -> bool {
        self.is_geographic() || self.crs.is_some()
    }

    /// Longitude and latitude of a position.
    ///
    /// # Errors
    /// Metres have none by themselves.
    pub fn degrees(&self, at: Point2<f64>) -> Result<[f64; 2]> {
        let [lat, lon] = self.on_globe(at)?.map(to_grain);
        Ok([lon, lat])
    }

    /// A ring of positions, closed, as longitudes and latitudes.
    ///
    /// # Errors
    /// Metres have none by themselves.
    pub fn ring<P: Copy + Into<Point2<f64>>>(&self, ring: &[P]) -> Result<Vec<[f64; 2]>> {
        ring.iter().chain(ring.first()).map(|at| self.degrees((*at).into())).collect()
    }

    /// Checks that positions have a place on the globe, all on one side of the 180th meridian. `name` is what they are
    /// of, and `or` another way to have one.
    ///
    /// # Errors
    /// Names what was found and what was expected.
    pub fn check_globe(
        &self,
        (name, or): (&str, &str),
        places: impl Iterator<Item = Point2<f64>>,
    ) -> Result<()> {
        if !self.is_on_globe() {
            bail!(
                "--geojson: found positions in metres in {name}, expected latitude and longitude{or}, or the system of the \
                 metres (--crs EPSG:...)"
            );
        }
        let lons = places.map(|at| Ok(self.degrees(at)?[0])).collect::<Result<Vec<_>>>()?;
        let [least, most] = span(lons);
        if most - least > 180.0 {
            bail!(
                "--geojson: {name} lies on both sides of the 180th meridian, expected positions on one"
            );
        }
        Ok(())
    }

    /// A line in the file's metres; `None` where the file has none.
    pub fn line(&self, [a, b, c]: [f64; 3]) -> Option<Line> {
        let [x, z] = self.origin.unwrap_or_default();
        (!self.is_geographic()).then(|| Line::from_coefficients(a, b, c - a * x - b * z))?
    }

    /// The origin of positions, in words: a line, if there is one.
    pub fn about(&self) -> String {
        let of = self.crs.as_ref().map_or(String::new(), |crs| format!(" of {crs}"));
        match self.origin {
            None => String::new(),
            Some([lat, lon]) if self.is_geographic() => format!(
                "Metres to the east (x) and the north (z) of latitude {lat}, longitude {lon}.\n"
            ),
            Some([x, z]) => format!("Metres{of} about the origin ({x}, {z}).\n"),
        }
    }
}

/// Degrees to a tenth of a millimetre.
fn to_grain(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

/// The middle of positions. Where they reach further from it than the lattice does, their medians: a stray one is far
/// from these, and not all others.
fn middle(positions: &[[f64; 2]], reach: f64) -> [f64; 2] {
    let along = |k: usize| positions.iter().map(move |at| at[k]);
    let spans = [0, 1].map(|k| span(along(k)));
    if spans.iter().all(|[least, most]| most - least <= 2.0 * reach) {
        return spans.map(|[least, most]| least.midpoint(most));
    }
    [0, 1].map(|k| {
        let mut sorted: Vec<_> = along(k).collect();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
    })
}

/// The middle of latitudes and longitudes, to a ten-thousandth of a degree. Longitudes are counted from the first
/// row's, so that it does not matter where they jump by a turn.
fn geographic_middle(positions: &[[f64; 2]]) -> [f64; 2] {
    let Some(&[south, first]) = positions.first() else { return [0.0; 2] };
    // As many metres as a degree of latitude, at most.
    let metres = libm::cos(south.to_radians()).max(1e-3);
    let turned = |lon: f64| metres * libm::remainder(lon - first, 360.0);
    let from_first: Vec<_> = positions.iter().map(|[lat, lon]| [*lat, turned(*lon)]).collect();
    let [lat, lon] = middle(&from_first, REACH / METRES_PER_DEGREE);
    [lat, libm::remainder(lon / metres + first, 360.0)].map(|degrees| (degrees * 1e4).round() / 1e4)
}

/// Checks a latitude and a longitude.
///
/// # Errors
/// Which of the two is wrong, and what was expected.
pub fn check_degrees([lat, lon]: [f64; 2]) -> Result<()> {
    if !(-90.0..=90.0).contains(&lat) {
        bail!("lat: found {lat}, expected a latitude from -90 to 90 degrees");
    }
    if !(-180.0..=360.0).contains(&lon) {
        bail!("lon: found {lon}, expected a longitude from -180 to 360 degrees");
    }
    Ok(())
}
