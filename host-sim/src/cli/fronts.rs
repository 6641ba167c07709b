//! `campaign --fronts`: missions along fronts that bend and move.

use anyhow::{Result, bail};
use clap::Args;

use planner_core::Front;

use crate::campaign::fronts::flight::Fronts;
use crate::campaign::fronts::kinds::KINDS;
use crate::campaign::fronts::who::Who;
use crate::cli::campaign_flags::{CampaignFlags, check_once};
use crate::cli::campaign_planner::of_fronts;
use crate::cli::format::Format;
use crate::mission::scenario;
use crate::output::file::json;
use crate::report::fronts;

/// Missions for each kind of front, at most: the vertices of one row are in memory.
const MOST: u64 = 10_000;

/// How often labels are true, if nobody says.
const USUAL_P: [f64; 2] = [1.0, 0.9];

/// The flags of a campaign along fronts. Beside them it has `--fields`, `--seed`, `--algorithm` or `--compare`, `--p`,
/// `--reach` and `--format`.
#[derive(Debug, Args)]
pub(crate) struct FrontsFlags {
    /// Follow fronts that bend and move, and measure the maps (track, zigzag, bang-bang)
    #[arg(long, conflicts_with_all = MEANINGLESS)]
    pub(crate) fronts: bool,
    /// The follower is told this multiple of each front's speed (track) [default: 1]
    #[arg(long, value_name = "FACTOR", requires = "fronts")]
    told_speed: Option<f64>,
}

/// Flags of the standard fields that have no meaning with `--fronts` and `--patches`.
pub(crate) const MEANINGLESS: [&str; 31] = [
    "steps",
    "readings",
    "every",
    "fan",
    "kind",
    "step",
    "sharpest",
    "turn_step",
    "radius",
    "shortest",
    "crossing",
    "following",
    "p_prior",
    "true_p",
    "trusted_radius",
    "position_error",
    "motion_error",
    "tolerance",
    "bend",
    "drift",
    "area",
    "price",
    "worth",
    "labels",
    "policy",
    "prior",
    "csv",
    "from",
    "fields_csv",
    "figure",
    "from_nothing",
];

impl FrontsFlags {
    /// Flies the missions; what to print.
    ///
    /// # Errors
    /// Names the flag, what was found and what was expected.
    pub(crate) fn tell(&self, flags: &CampaignFlags, format: Format) -> Result<String> {
        let (flag, planners) = flags.planners();
        check_once(planners)?;
        let campaigns = self.campaigns(flags, &of_fronts(flag, planners)?, flag)?;
        let summaries = campaigns.iter().map(Fronts::run).collect::<Result<Vec<_>>>()?;
        Ok(match (format, &summaries[..]) {
            (Format::Text, all) => fronts::text(all),
            (Format::Json, [single]) if flag == "--algorithm" => json(single),
            (Format::Json, all) => json(&all),
        })
    }

    /// What is flown by each planner.
    fn campaigns(&self, flags: &CampaignFlags, who: &[Who], flag: &str) -> Result<Vec<Fronts>> {
        if flags.fields > MOST {
            bail!("--fields: found {}, expected at most {MOST} with --fronts", flags.fields);
        }
        let p = flags.p.map(|p| scenario::told("--p", p)).transpose()?;
        let p = p.map_or(USUAL_P.to_vec(), |p| vec![p]);
        let reach = flags.vehicle.reach();
        if let Some(reach) = reach.filter(|it| !is_reach(*it)) {
            bail!("--reach: found {reach}, expected 0.1 to 2 m in steps of 0.1 with --fronts");
        }
        self.check_told(who, flag)?;
        let told_speed = self.told_speed.unwrap_or(1.0);
        let (missions, seed) = (flags.fields, flags.seed);
        let of = |who: &Who| Fronts { who: *who, missions, seed, p: p.clone(), told_speed, reach };
        Ok(who.iter().map(of).collect())
    }

    /// Whether a planner can be told so, and whether there is one.
    fn check_told(&self, who: &[Who], flag: &str) -> Result<()> {
        const NAME: &str = "--told-speed";
        let Some(factor) = self.told_speed else { return Ok(()) };
        if !who.iter().any(|it| it.is_told_speed()) {
            let names: Vec<_> = who.iter().map(|it| it.name()).collect();
            let names = names.join(",");
            bail!("{NAME}: found with {flag} {names}, expected with track, told so of fronts");
        }
        for kind in KINDS {
            if let Err(why) = Front::BENDING.moving(kind.speed * factor) {
                bail!("{NAME}: found {factor}, expected a factor that suits all fronts: {why}");
            }
        }
        Ok(())
    }
}

/// Whether missions may have motions of this length, metres.
fn is_reach(metres: f64) -> bool {
    let steps = metres * 10.0;
    (0.999..20.001).contains(&steps) && (steps - steps.round()).abs() < 1e-6
}
