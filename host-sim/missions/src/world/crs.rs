//! Systems of coordinates in metres, such as UTM, and where their positions are on the globe.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use anyhow::{Context as _, Result, bail};
use geographiclib_rs::{Geodesic, InverseGeodesic as _};
#[cfg(not(target_family = "wasm"))]
use proj4rs::{Proj, transform::transform};
use serde::{Serialize, Serializer};

/// A system by its number in the EPSG registry. Its x points east and its z north.
#[derive(Clone)]
pub struct Crs {
    code: u16,
    systems: Arc<Systems>,
}

/// The system, and degrees of WGS84. Each is some 600 bytes.
#[cfg(not(target_family = "wasm"))]
struct Systems {
    own: Proj,
    degrees: Proj,
}

/// None is known in a browser: the table of all is larger than the rest.
#[cfg(target_family = "wasm")]
enum Systems {}

/// How far a metre of the system may be from a metre on the ground.
const DISTORTION: f64 = 0.01;

/// Distance between the places at which a metre is measured, metres.
const APART: f64 = 100.0;

impl FromStr for Crs {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (authority, number) = text.split_once(':').unwrap_or(("", text));
        let code = number.parse().ok().filter(|_| authority.eq_ignore_ascii_case("EPSG"));
        let code: u16 = code.with_context(|| {
            format!("found {text:?}, expected EPSG: and a number, as EPSG:25832")
        })?;
        Ok(Self { code, systems: Arc::new(Systems::of(code)?) })
    }
}

#[cfg(target_family = "wasm")]
impl Systems {
    fn of(code: u16) -> Result<Self> {
        bail!("found EPSG:{code}, expected latitude and longitude: a browser knows no other system")
    }

    fn degrees(&self, _: [f64; 2]) -> Option<[f64; 2]> {
        match *self {}
    }

    fn metres(&self, _: [f64; 2]) -> Option<[f64; 2]> {
        match *self {}
    }
}

#[cfg(not(target_family = "wasm"))]
impl Systems {
    fn of(code: u16) -> Result<Self> {
        let proj = Proj::from_epsg_code(code).map_err(|error| {
            anyhow::anyhow!("found EPSG:{code}, expected a system that is known here: {error}")
        })?;
        let degrees = Proj::from_proj_string("+proj=longlat +datum=WGS84 +no_defs")
            .map_err(|error| anyhow::anyhow!("WGS84: {error}"))?;
        if proj.is_latlong() {
            bail!(
                "found EPSG:{code}, which is in degrees, expected a system in metres; \
                 latitude and longitude need --columns lat=TITLE,lon=TITLE alone"
            );
        }
        if (proj.to_meter() - 1.0).abs() > 1e-12 {
            bail!("found EPSG:{code}, which is in {}, expected a system in metres", proj.units());
        }
        if proj.is_geocent() || !proj.has_inverse() || !proj.is_normalized_axis() {
            bail!(
                "found EPSG:{code}, which has other axes than east and north, expected a map in metres"
            );
        }
        Ok(Self { own: proj, degrees })
    }

    fn degrees(&self, [x, z]: [f64; 2]) -> Option<[f64; 2]> {
        let mut at = (x, z);
        transform(&self.own, &self.degrees, &mut at).ok()?;
        Some([at.1, at.0].map(f64::to_degrees))
    }

    fn metres(&self, [lat, lon]: [f64; 2]) -> Option<[f64; 2]> {
        let mut at = (lon.to_radians(), lat.to_radians());
        transform(&self.degrees, &self.own, &mut at).ok()?;
        Some(at.into())
    }
}

impl PartialEq for Crs {
    fn eq(&self, other: &Self) -> bool {
        self.code == other.code
    }
}

impl fmt::Display for Crs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "EPSG:{}", self.code)
    }
}

impl fmt::Debug for Crs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Serialize for Crs {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl Crs {
    /// Latitude and longitude of a position, WGS84, degrees.
    ///
    /// # Errors
    /// The system does not reach there.
    pub fn degrees(&self, [x, z]: [f64; 2]) -> Result<[f64; 2]> {
        let place = self.systems.degrees([x, z]).filter(|it| it.iter().all(|it| it.is_finite()));
        place.with_context(|| {
            format!("--crs {self}: found ({x}, {z}), which is no place of this system")
        })
    }

    /// The position in the system of a latitude and a longitude, WGS84, degrees.
    ///
    /// # Errors
    /// The system does not reach there.
    pub fn metres(&self, [lat, lon]: [f64; 2]) -> Result<[f64; 2]> {
        let at = self.systems.metres([lat, lon]).filter(|it| it.iter().all(|it| it.is_finite()));
        at.with_context(|| {
            format!("{self}: found latitude {lat}, longitude {lon}, which it does not reach")
        })
    }

    /// Checks that a metre of the system is one on the ground about a position.
    ///
    /// # Errors
    /// How long it is there.
    pub fn check(&self, [x, z]: [f64; 2]) -> Result<()> {
        let half = APART / 2.0;
        for [dx, dz] in [[half, 0.0], [0.0, half]] {
            let [from, to] = [self.degrees([x - dx, z - dz])?, self.degrees([x + dx, z + dz])?];
            let metres: f64 = Geodesic::wgs84().inverse(from[0], from[1], to[0], to[1]);
            let scale = metres / APART;
            if (scale - 1.0).abs() > DISTORTION {
                bail!(
                    "--crs {self}: a metre of this system is {scale:.3} m on the ground at ({x}, {z}); expected x to the \
                     east and z to the north in a system that is true there, such as UTM (are x and z swapped?)"
                );
            }
        }
        Ok(())
    }
}
