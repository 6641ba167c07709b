//! `campaign`: the standard fields.

use std::path::PathBuf;
use std::slice;

use anyhow::{Result, bail};
use clap::Args;
use planner_core::motion::any_vehicle::AnyVehicle;
use planner_core::motion::unicycle::Grid;

use crate::campaign::accuracy::{self, Accuracy};
use crate::campaign::calibration::{self, Calibrated};
use crate::campaign::ensemble::Campaign;
use crate::cli::arguments::Format;
use crate::cli::compare::{self, Told};
use crate::mission::algorithm::Algorithm;
use crate::mission::names::{CrossingName, FanName, FollowingName, PolicyName, PriorName};
use crate::mission::scenario;
use crate::mission::vehicle::{Source, VehicleTable};
use crate::output::file::{csv, json, prepare};
use crate::report::campaign as tables;
use crate::report::curves::Curves;
use crate::world::errors::Errors;
use crate::world::noise::{Extent, NoiseModel};

#[derive(Debug, Args)]
pub(crate) struct CampaignArgs {
    /// Number of standard fields
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) fields: u64,
    /// Steps in each
    #[arg(long, default_value_t = 20)]
    pub(crate) steps: u32,
    /// Seed of the ensemble
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Who plans
    #[arg(long, value_enum, default_value_t = Algorithm::Cfc)]
    pub(crate) algorithm: Algorithm,
    /// Who plans, one after the other on the same fields: one table shows them side by side
    #[arg(
        long,
        value_enum,
        value_name = "PLANNER,...",
        value_delimiter = ',',
        conflicts_with = "algorithm"
    )]
    pub(crate) compare: Vec<Algorithm>,
    /// How finely the vehicle turns [default: paper; for lookahead fine]
    #[arg(long, value_enum)]
    pub(crate) fan: Option<FanName>,
    #[command(flatten)]
    pub(crate) vehicle: VehicleTable,
    /// How P1 looks for the opposite label (cfc, scc) [default: anyhow]
    #[arg(long, value_enum)]
    pub(crate) crossing: Option<CrossingName>,
    /// How P2 follows the boundary (cfc, scc) [default: along-bisector; for scc anyhow]
    #[arg(long, value_enum)]
    pub(crate) following: Option<FollowingName>,
    /// Labels are true with this probability (scc, lookahead, margin, random) [default: 0.7 for scc, 1 else]
    #[arg(long)]
    pub(crate) p: Option<f64>,
    /// Within this distance of the oracle's points labels are certain, metres (where p is below 1) [default: 0]
    #[arg(long)]
    pub(crate) trusted_radius: Option<f64>,
    /// Standard deviation of the positions that robots report, metres an axis
    #[arg(long, value_name = "METRES", default_value_t = 0.0)]
    pub(crate) position_error: f64,
    /// Standard deviation of where motions end, metres an axis
    #[arg(long, value_name = "METRES", default_value_t = 0.0)]
    pub(crate) motion_error: f64,
    /// How far off planners are told that positions are, at most, metres [default: 3 times the position error]
    #[arg(long, value_name = "METRES")]
    pub(crate) tolerance: Option<f64>,
    /// How hypotheses choose an action together (scc) [default: mixture-of-own]
    #[arg(long, value_enum)]
    pub(crate) policy: Option<PolicyName>,
    /// How hypotheses are weighed in that (scc; lookahead and margin where p is below 1) [default: area]
    #[arg(long, value_enum)]
    pub(crate) prior: Option<PriorName>,
    /// Write a row for each field and mark here
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Draw how errors shrink and bits grow here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

/// Flies them, and what to print.
pub(crate) fn campaign(args: &CampaignArgs) -> Result<String> {
    const ORACLE: usize = 4;
    scenario::check_steps("--steps", args.steps, ORACLE)?;
    compare::check_once(&args.compare)?;
    let planners = args.planners();
    let p = args.p.unwrap_or(if planners.contains(&Algorithm::Scc) { 0.7 } else { 1.0 });
    let p = scenario::probability("--p", p)?;
    planners.iter().try_for_each(|&planner| args.check_meanings(planner, p))?;
    let radius = args.trusted_radius.unwrap_or_default();
    let trusted_radius = scenario::trusted("--trusted-radius", radius)?;
    let errors = Errors {
        position: scenario::deviation("--position-error", args.position_error)?,
        motion: scenario::deviation("--motion-error", args.motion_error)?,
        ..Errors::default()
    };
    let tolerance = scenario::tolerance("--tolerance", args.tolerance, errors)?;
    let asked = [("--csv", args.csv.as_deref()), ("--figure", args.figure.as_deref())];
    let [output, drawn] = prepare(&[], asked)?;
    let extent = Extent::OutsideBalls(trusted_radius);
    let campaign = |algorithm: Algorithm| {
        Ok::<_, anyhow::Error>(Campaign {
            algorithm,
            fields: args.fields,
            steps: args.steps,
            seed: args.seed,
            crossing: args.crossing.unwrap_or_default().into(),
            following: args.following.map_or(algorithm.following(), Into::into),
            vehicle: args.moving(algorithm)?,
            noise: algorithm.weighs(p < 1.0).then_some(NoiseModel { p, extent }),
            errors,
            tolerance,
            policy: args.policy.unwrap_or_default().into(),
            prior: args.prior.unwrap_or_default().into(),
        })
    };
    let Told { table, rows, record, curves } = if args.compare.is_empty() {
        alone(&campaign(args.algorithm)?)?
    } else {
        let campaigns: Vec<_> =
            planners.iter().map(|&planner| campaign(planner)).collect::<Result<_>>()?;
        compare::fly(&campaigns, p < 1.0)?
    };
    if let Some(output) = output {
        output.write(rows)?;
    }
    if let Some(output) = drawn {
        output.write(curves.svg())?;
    }
    Ok(match args.format {
        Format::Text => table,
        Format::Json => record,
    })
}

/// Flies one campaign.
fn alone(campaign: &Campaign) -> Result<Told> {
    Ok(if campaign.noise.is_some() {
        let summary = calibration::Summary::of(campaign, campaign.run(&Calibrated)?);
        let (table, rows) = (tables::calibration(&summary), csv(&summary.checkpoints)?);
        let curves = Curves::of_calibration(slice::from_ref(&summary));
        Told { table, rows, record: json(&summary), curves }
    } else {
        let summary = accuracy::Summary::of(campaign, campaign.run(&Accuracy)?);
        let (table, rows) = (tables::accuracy(&summary), csv(&summary.checkpoints)?);
        let curves = Curves::of_accuracy(slice::from_ref(&summary));
        Told { table, rows, record: json(&summary), curves }
    })
}

impl CampaignArgs {
    /// Who plans.
    fn planners(&self) -> &[Algorithm] {
        if self.compare.is_empty() { slice::from_ref(&self.algorithm) } else { &self.compare }
    }

    /// What moves when this one plans.
    fn moving(&self, planner: Algorithm) -> Result<AnyVehicle> {
        self.vehicle.vehicle(Source::Flags, planner, self.fan.is_some(), self.grid(planner))
    }

    /// How finely a planner's vehicle turns.
    fn grid(&self, planner: Algorithm) -> Grid {
        self.fan.map_or(planner.grid(), Into::into)
    }

    /// Whether every flag that was given has a meaning for a planner. `p` is how often labels are true.
    fn check_meanings(&self, planner: Algorithm, p: f64) -> Result<()> {
        let flag = if self.compare.is_empty() { "--algorithm" } else { "--compare" };
        let name = planner.name();
        if p < 1.0 && !planner.weighs(true) {
            let found = if self.p.is_some() { "" } else { ", the default with scc" };
            bail!(
                "--p: found {p}{found}, expected 1 with {flag} {name}, which takes labels to be true"
            );
        }
        if !planner.copes_with(self.grid(planner)) {
            bail!("--fan: found fine with {flag} {name}, expected paper, as it tries every action");
        }
        let plans = planner.poses_problems();
        let weighs = planner == Algorithm::Scc;
        // Look-ahead predicts from hypotheses, margin sampling asks the most likely one.
        let reads = matches!(planner, Algorithm::Lookahead | Algorithm::Margin);
        let asks = weighs || reads && p < 1.0;
        for (given, is_given, has_meaning, meant) in [
            ("--crossing", self.crossing.is_some(), plans, "--algorithm cfc or scc"),
            ("--following", self.following.is_some(), plans, "--algorithm cfc or scc"),
            ("--policy", self.policy.is_some(), weighs, "--algorithm scc"),
            (
                "--prior",
                self.prior.is_some(),
                asks,
                "--algorithm scc, or lookahead or margin with --p below 1",
            ),
            (
                "--trusted-radius",
                self.trusted_radius.is_some(),
                p < 1.0,
                "labels that can be wrong: --algorithm scc, lookahead, margin or random, --p below 1",
            ),
        ] {
            if is_given && !has_meaning {
                bail!("{given}: found with {flag} {name}, expected with {meant}");
            }
        }
        Ok(())
    }
}
