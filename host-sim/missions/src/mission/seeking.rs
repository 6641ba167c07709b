//! `seek` of a scenario file: what a planner is told of a boundary of which nothing is known.

use anyhow::Result;
use planner_core::error::{SetupError, ValueError};
use planner_core::{Likely, Seeking, Track};
use serde::{Deserialize, Serialize};

use crate::mission::definition::Mission;
use crate::mission::strict::{Table, wrong};

/// What a boundary is like that is sought from nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeekTable {
    /// The radius of the smallest patch to be found, metres [default: a sixteenth of the mean of the area's sides].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patch: Option<f64>,
    /// What the boundary most likely is: `spill`, `coast`, or `either` [default: `either`].
    #[serde(default)]
    pub likely: Likely,
    /// Patches to map, 1 to 8 [default: 1].
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub patches: u8,
}

const fn one() -> u8 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
const fn is_one(number: &u8) -> bool {
    *number == 1
}

impl Default for SeekTable {
    fn default() -> Self {
        Self { patch: None, likely: Likely::default(), patches: 1 }
    }
}

impl SeekTable {
    /// What a planner is told, if it is not the usual.
    pub(crate) fn of(seeking: Seeking) -> Option<Self> {
        let (likely, patches) = (seeking.most_likely(), seeking.most_patches());
        let it = Self { patch: seeking.radius(), likely, patches };
        (seeking != Seeking::USUAL).then_some(it)
    }

    /// The same as a planner has it.
    ///
    /// # Errors
    /// Says what is expected.
    pub fn told(self) -> Result<Seeking, ValueError> {
        let seeking = self.patch.map_or(Ok(Seeking::USUAL), Seeking::patches)?;
        seeking.likely(self.likely).several(self.patches)
    }
}

/// What a planner is told.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub(crate) fn seeking(table: Option<&Table<SeekTable>>) -> Result<Seeking> {
    let table = table.map(|table| table.0).unwrap_or_default();
    let radius = table.patch.unwrap_or_default();
    if Seeking::USUAL.several(table.patches).is_err() {
        return wrong("seek.patches", table.patches, "1 to 8");
    }
    table.told().or_else(|why| wrong("seek.patch", radius, format!("metres ({why})")))
}

impl Mission {
    /// Whether patches of the radius that is told suit the area.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub(crate) fn check_patch(&self) -> Result<()> {
        let (area, noise) = (self.terrain(), self.noise_told());
        let track = Track::new(area, self.vehicle, self.front, noise);
        match track.and_then(|track| track.seeking(self.seeking)) {
            Err(why @ SetupError::Patch { .. }) if !self.algorithm.seeks_line() => {
                let radius = self.seeking.radius().unwrap_or_default();
                wrong("seek.patch", radius, format!("metres ({why})"))
            }
            _ => Ok(()),
        }
    }
}
