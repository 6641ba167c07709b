//! A place with a heading or a label, as requests give it and as the state keeps it.

use anyhow::{Result, anyhow};
use nalgebra::Point2;
use planner_core::{Label, Reading, Site};
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

use crate::mission::lake::Lake;
use crate::mission::strict::wrong;
use crate::mission::terrain::on_map;

/// A place as a request gives it, with a heading or with a label.
#[skip_serializing_none]
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a place, as { \"x\": 2, \"z\": 1 }")]
pub(super) struct Place {
    x: Option<f64>,
    z: Option<f64>,
    lat: Option<f64>,
    lon: Option<f64>,
    pub(super) heading: Option<f64>,
    label: Option<i8>,
}

/// Metres on the lattice, and a label.
pub(super) type Told = (f64, f64, i8);

impl Place {
    /// Metres on the lattice.
    pub(super) fn at(mut self, field: &str, lake: Option<&Lake>) -> Result<[f64; 2]> {
        on_map(field, lake, [&mut self.x, &mut self.z], [self.lat, self.lon])?;
        match (self.x, self.z) {
            (Some(x), Some(z)) => Ok([x, z]),
            _ => wrong(field, "a part of a position", "x and z"),
        }
    }

    fn told(self, field: &str, lake: Option<&Lake>) -> Result<Told> {
        let [x, z] = self.at(field, lake)?;
        let key = format!("{field}.label");
        let Some(label) = self.label else {
            return wrong(
                &key,
                "none",
                "-1, 0 on the boundary, or 1; leave out what could not be read",
            );
        };
        reading(&key, label)?;
        Ok((x, z, label))
    }
}

pub(super) fn told(field: &str, places: &[Place], lake: Option<&Lake>) -> Result<Vec<Told>> {
    let each = places.iter().enumerate();
    each.map(|(k, it)| it.told(&format!("{field}[{k}]"), lake)).collect()
}

pub(super) fn site(field: &str, x: f64, z: f64) -> Result<Site> {
    Site::try_from(Point2::new(x, z)).map_err(|why| anyhow!("{field}: {why}"))
}

pub(super) fn reading(key: &str, label: i8) -> Result<Reading> {
    Ok(match label {
        1 => Label::Positive.into(),
        -1 => Label::Negative.into(),
        0 => Reading::Boundary,
        other => return wrong(key, other, "-1, 0 on the boundary, or 1"),
    })
}
pub(super) fn readings_of(field: &str, told: &[Told]) -> Result<Vec<(Site, Reading)>> {
    let one = |(k, &(x, z, label)): (usize, &Told)| {
        let field = format!("{field}[{k}]");
        Ok((site(&field, x, z)?, reading(&format!("{field}.label"), label)?))
    };
    told.iter().enumerate().map(one).collect()
}
