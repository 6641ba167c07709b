//! What is known of the line beforehand: `bounds` of scenario files.

use anyhow::{Result, anyhow};
use planner_core::Sample;
use planner_core::bounds::{intercept_within, slope_within_degrees};
use planner_core::error::ValueError;
use planner_core::link::message::MissionArea;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// `bounds` of a scenario file: what is known of the line beforehand.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// The line's direction lies between these, degrees, less than 180 apart.
    pub slope: Option<[f64; 2]>,
    /// It crosses `x = 0` between these, metres.
    pub intercept: Option<[f64; 2]>,
}

impl Bounds {
    /// Nothing is known.
    pub const NONE: Self = Self { slope: None, intercept: None };

    /// Samples that say the same where +1 lies above the line, in an area.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub(crate) fn samples(&self, area: &MissionArea) -> Result<Vec<Sample>> {
        let refused = |key: &str, found: [f64; 2], why: ValueError| {
            anyhow!("bounds.{key}: found {found:?}, expected others: {why}")
        };
        let mut samples = Vec::new();
        if let Some(bounds) = self.slope {
            let of_slope = slope_within_degrees(area, bounds);
            samples.extend(of_slope.map_err(|why| refused("slope", bounds, why))?);
        }
        if let Some(bounds) = self.intercept {
            let of_intercept = intercept_within(bounds);
            samples.extend(of_intercept.map_err(|why| refused("intercept", bounds, why))?);
        }
        Ok(samples)
    }

    /// How many samples that are.
    pub const fn len(&self) -> usize {
        6 * self.slope.is_some() as usize + 2 * self.intercept.is_some() as usize
    }

    /// Whether nothing is known.
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
