//! `campaign --patches`: missions that seek a patch or a coast from nothing.

use anyhow::{Result, bail};
use clap::Args;

use crate::campaign::patches::flight::Patches;
use crate::cli::campaign_flags::CampaignFlags;
use crate::cli::format::Format;
use crate::cli::fronts::MEANINGLESS;
use crate::mission::scenario;
use crate::output::file::json;
use crate::report::patches;

/// Missions of a row, at most.
const MOST: u64 = 10_000;

/// How often labels are true, if nobody says.
const USUAL_P: [f64; 4] = [1.0, 0.9, 0.8, 0.7];

/// The flags of a campaign that seeks. Beside them it has `--fields`, `--seed`, `--p` and `--format`.
#[derive(Debug, Args)]
pub(crate) struct PatchesFlags {
    /// Seek patches and coasts from nothing, beside a lawnmower
    #[arg(
        long,
        conflicts_with_all = ["fronts", "steps", "algorithm", "compare"],
        conflicts_with_all = MEANINGLESS
    )]
    pub(crate) patches: bool,
    /// The planner is told this multiple of each patch's radius [default: 1]
    #[arg(long, value_name = "FACTOR", requires = "patches")]
    told_patch: Option<f64>,
}

impl PatchesFlags {
    /// Flies the missions; what to print.
    ///
    /// # Errors
    /// Names the flag, what was found and what was expected.
    pub(crate) fn tell(&self, flags: &CampaignFlags, format: Format) -> Result<String> {
        let (missions, seed) = (flags.fields, flags.seed);
        if missions > MOST {
            bail!("--fields: found {missions}, expected at most {MOST} with --patches");
        }
        let told = self.told_patch.unwrap_or(1.0);
        if !(0.5..=2.0).contains(&told) {
            bail!("--told-patch: found {told}, expected a factor from 0.5 to 2");
        }
        let p = flags.p.map(|p| scenario::told("--p", p)).transpose()?;
        let p = p.map_or(USUAL_P.to_vec(), |p| vec![p]);
        let rows = [false, true]
            .map(|mows| Patches { mows, missions, seed, p: p.clone(), told }.run())
            .into_iter()
            .collect::<Result<Vec<_>>>()?;
        Ok(match format {
            Format::Text => patches::text(&rows, (missions, seed)),
            Format::Json => json(&rows),
        })
    }
}
