//! `seek` of a scenario file: what a planner is told of a boundary of which nothing is known.

use anyhow::Result;
use planner_core::error::SetupError;
use planner_core::{Likely, Seeking, Track, Tracker, Workspace as _};
use serde::{Deserialize, Serialize};

use crate::mission::definition::Mission;
use crate::mission::strict::{Table, wrong};

/// What a boundary is like that is sought from nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeekTable {
    /// The radius of the smallest patch that is to be found, metres. None for a sixteenth of the mean of the area's sides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patch: Option<f64>,
    /// What the boundary most likely is: a spill, a coast, or either.
    #[serde(default)]
    pub likely: Likely,
}

/// What a planner is told.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub(crate) fn seeking(table: Option<&Table<SeekTable>>) -> Result<Seeking> {
    let SeekTable { patch, likely } = table.map(|table| table.0).unwrap_or_default();
    let seeking = patch.map_or(Ok(Seeking::USUAL), Seeking::patches);
    let seeking = seeking
        .or_else(|why| wrong("seek.patch", patch.unwrap_or_default(), format!("metres ({why})")))?;
    Ok(seeking.likely(likely))
}

impl Mission {
    /// Whether patches of the radius that is told suit the area.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub(crate) fn check_patch(&self) -> Result<()> {
        let (area, noise) = (self.config.area, self.noise_told());
        let tracker = Tracker::<16, 16, 3>::new(area.bounds(), self.front, noise);
        let track = Track::new(area, self.vehicle, tracker);
        match track.and_then(|track| track.seeking(self.seeking)) {
            Err(why @ SetupError::Patch { .. }) if !self.algorithm.seeks_line() => {
                let radius = self.seeking.radius().unwrap_or_default();
                wrong("seek.patch", radius, format!("metres ({why})"))
            }
            _ => Ok(()),
        }
    }
}
