//! What was done so far, as answers and requests pass it on.

use anyhow::{Result, anyhow};
use crc::{CRC_32_ISO_HDLC, Crc};
use planner_core::{Heading, Pose};
use serde::{Deserialize, Serialize};

use crate::mission::next::place::{Place, Told, reading, readings_of, site};
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
