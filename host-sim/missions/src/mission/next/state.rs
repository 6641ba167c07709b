//! What was done so far, as answers and requests pass it on.

use anyhow::{Result, anyhow};
use crc::{CRC_32_ISO_HDLC, Crc};
use nalgebra::Point2;
use planner_core::{Heading, Pose, Reading, Site};
use serde::{Deserialize, Serialize};

use crate::mission::next::request::{Place, reading};
use crate::mission::session::Arrival;

/// What was done so far.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "the state of the last answer")]
pub(super) struct State {
    /// Of the scenario and of what follows.
    pub(super) check: u32,
    /// Where it began, if the first request said so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) start: Option<Place>,
    /// Labels of others.
    pub(super) samples: Vec<Told>,
    /// The motions.
    pub(super) done: Vec<Done>,
}

/// Metres on the lattice, and a label.
pub(super) type Told = (f64, f64, i8);

/// A motion that was made: where it ended, what was read there, and on the way.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Done {
    pub(super) x: f64,
    pub(super) z: f64,
    pub(super) heading: f64,
    pub(super) label: Option<i8>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) on_the_way: Vec<Told>,
}

impl State {
    pub(super) fn sum(&self, scenario: &str) -> u32 {
        let all = (scenario, &self.start, &self.samples, &self.done);
        let bytes = serde_json::to_vec(&all).unwrap_or_default();
        Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(&bytes)
    }
}

impl Done {
    pub(super) fn arrival(&self, field: &str) -> Result<Arrival> {
        let heading = Heading::from_radians(self.heading);
        let heading = heading.map_err(|why| anyhow!("{field}.heading: {why}"))?;
        Ok(Arrival {
            pose: Pose { site: site(field, self.x, self.z)?, heading },
            reading: self.label.map(|it| reading(&format!("{field}.label"), it)).transpose()?,
            passed: readings_of(field, &self.on_the_way)?,
        })
    }
}

fn site(field: &str, x: f64, z: f64) -> Result<Site> {
    Site::try_from(Point2::new(x, z)).map_err(|why| anyhow!("{field}: {why}"))
}

pub(super) fn readings_of(field: &str, told: &[Told]) -> Result<Vec<(Site, Reading)>> {
    let one = |(k, &(x, z, label)): (usize, &Told)| {
        let field = format!("{field}[{k}]");
        Ok((site(&field, x, z)?, reading(&format!("{field}.label"), label)?))
    };
    told.iter().enumerate().map(one).collect()
}
