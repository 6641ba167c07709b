//! Systems of coordinates in metres, such as UTM, and where their positions are on the globe.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use anyhow::{Context as _, Result, anyhow, bail};
use geographiclib_rs::{Geodesic, InverseGeodesic as _};
use proj4rs::Proj;
use proj4rs::transform::transform;
use serde::{Serialize, Serializer};

/// A system by its number in the EPSG registry. Its x points east and its z north.
#[derive(Clone)]
pub struct Crs {
    code: u16,
    systems: Arc<Systems>,
}

/// The system, and degrees of WGS84. Each is some 600 bytes.
struct Systems {
    own: Proj,
    degrees: Proj,
}

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
        let proj = Proj::from_epsg_code(code).map_err(|error| {
            anyhow!("found EPSG:{code}, expected a system that is known here: {error}")
        })?;
        let degrees = Proj::from_proj_string("+proj=longlat +datum=WGS84 +no_defs")
            .map_err(|error| anyhow!("WGS84: {error}"))?;
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
        Ok(Self { code, systems: Arc::new(Systems { own: proj, degrees }) })
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
        let mut at = (x, z);
        let found = transform(&self.systems.own, &self.systems.degrees, &mut at);
        let place = [at.1, at.0].map(f64::to_degrees);
        match found {
            Ok(()) if place.iter().all(|it| it.is_finite()) => Ok(place),
            _ => bail!("--crs {self}: found ({x}, {z}), which is no place of this system"),
        }
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
