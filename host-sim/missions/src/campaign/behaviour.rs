//! A fingerprint of a build: a checksum of the rows of the first fields. Builds with equal checksums are treated as
//! one.

use anyhow::{Context as _, Result};

use crate::campaign::ensemble::{Campaign, Measure};
use crate::campaign::rows::{Planners, RowWriter};
use crate::output::checksum::Checksum;

/// Fields that are flown for it: few, as it is done at each start.
const FIELDS: u64 = 4;

/// The checksum of the rows that this build computes for the first of `fields`, by these planners.
///
/// # Errors
/// Names the field in which a sample contradicts what is known.
pub fn behaviour<M: Measure>(
    campaigns: &[Campaign],
    fields: u64,
    planners: &Planners,
    measure: &M,
) -> Result<Checksum> {
    let mut writer = RowWriter::new(Checksum::default(), planners);
    for (number, campaign) in campaigns.iter().enumerate() {
        for field in 0..fields.min(FIELDS) {
            let rows = campaign.measured(measure, field);
            for row in rows.with_context(|| format!("field {field}"))? {
                writer.write(number, &row)?;
            }
        }
    }
    writer.into_inner()
}
