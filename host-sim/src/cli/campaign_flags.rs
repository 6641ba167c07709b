//! The flags that determine a campaign: what to fly.

use std::slice;

use anyhow::{Error, Result, bail};
use clap::builder::ArgPredicate;
use clap::{Args, ValueEnum};
use planner_core::{AnyReliability, AnyVehicle, Area, Reliability, UnknownReliability};

use crate::campaign::ensemble::Campaign;
use crate::campaign::rows::Planners;
use crate::campaign::standard_field::SIDE_M;
use crate::cli::campaign_planner::{CampaignPlanner, of_lines};
use crate::mission::algorithm::Algorithm;
use crate::mission::allowance::Allowance;
use crate::mission::asking::{Asked, Asking, Price};
use crate::mission::names::{CrossingName, FanName, FollowingName, PolicyName, PriorName};
use crate::mission::scenario::{self, Room};
use crate::mission::vehicle::{Source, VehicleTable};
use crate::world::errors::Errors;
use crate::world::noise::{Extent, NoiseModel, limit};

/// Points that the oracle gives in a standard field.
const ORACLE: usize = 4;

/// The settings that determine the rows of a campaign.
#[derive(Debug, Args)]
pub(crate) struct CampaignFlags {
    /// Number of standard fields; with --fronts missions for each kind of front, 300 by default and at most 10000; the
    /// same with --patches, 200 by default
    #[arg(
        long,
        default_value_t = 1000,
        default_value_ifs([
            ("fronts", ArgPredicate::IsPresent, "300"),
            ("patches", ArgPredicate::IsPresent, "200"),
        ]),
        value_parser = clap::value_parser!(u64).range(1..=1_000_000)
    )]
    pub(crate) fields: u64,
    /// Steps in each, 1 to 64; where labels are true, or with --labels or --price, 1 to 10000
    #[arg(long, default_value_t = 20)]
    steps: u32,
    /// Readings of each motion, 1 to 50, evenly spread over its length; the last is the label at its end
    #[arg(long, default_value_t = 1)]
    readings: u32,
    /// Measure at every step (or label), not only at those of the usual tables
    #[arg(long)]
    every: bool,
    /// Seed of the ensemble
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Who plans [with --fronts: track]
    #[arg(
        long,
        value_enum,
        default_value_t = CampaignPlanner::Line(Algorithm::Cfc),
        default_value_if("fronts", ArgPredicate::IsPresent, "track")
    )]
    algorithm: CampaignPlanner,
    /// Who plans, one after the other on the same fields: one table shows them side by side
    #[arg(
        long,
        value_enum,
        value_name = "PLANNER,...",
        value_delimiter = ',',
        conflicts_with = "algorithm"
    )]
    compare: Vec<CampaignPlanner>,
    /// How finely the vehicle turns [default: paper; for lookahead fine]
    #[arg(long, value_enum)]
    fan: Option<FanName>,
    #[command(flatten)]
    pub(crate) vehicle: VehicleTable,
    /// How P1 looks for the opposite label (cfc, scc) [default: anyhow]
    #[arg(long, value_enum)]
    crossing: Option<CrossingName>,
    /// How P2 follows the boundary (cfc, scc) [default: along-bisector; for scc anyhow]
    #[arg(long, value_enum)]
    following: Option<FollowingName>,
    /// Labels are true with this probability (all but cfc) [default: 0.7 for scc, 1 else; with --fronts both 1
    /// and 0.9]
    #[arg(long)]
    pub(crate) p: Option<f64>,
    /// Nobody knows that probability: planners are told the prior Beta(A, B), and each field's is drawn from it
    #[arg(long, value_name = "A,B", conflicts_with = "p")]
    p_prior: Option<String>,
    /// Labels are really true with this probability, whatever planners are told (with --p below 1, or --p-prior)
    #[arg(long, value_name = "P")]
    true_p: Option<f64>,
    /// Within this distance of the oracle's points labels are certain, metres (where p is below 1) [default: 0]
    #[arg(long)]
    trusted_radius: Option<f64>,
    /// Standard deviation of the positions that robots report, metres an axis
    #[arg(long, value_name = "METRES", default_value_t = 0.0)]
    position_error: f64,
    /// Standard deviation of where motions end, metres an axis
    #[arg(long, value_name = "METRES", default_value_t = 0.0)]
    motion_error: f64,
    /// The largest position error that planners assume, metres [default: 3 times the position error]
    #[arg(long, value_name = "METRES")]
    tolerance: Option<f64>,
    /// Added to the tolerance: how far the boundary may be from a straight line, metres (the fields' are straight)
    #[arg(long, value_name = "METRES", default_value_t = 0.0)]
    bend: f64,
    /// Added to the tolerance: how far the line may move during a mission, metres (the fields' do not move)
    #[arg(long, value_name = "METRES", default_value_t = 0.0)]
    drift: f64,
    /// The sides of the fields, metres: the standard fields are stretched to them [default: 20,20]
    #[arg(long, value_name = "X,Z", value_delimiter = ',')]
    area: Vec<f64>,
    /// Planners are given no points: they first seek the line
    #[arg(long, conflicts_with_all = ["trusted_radius", "fields_csv"])]
    from_nothing: bool,
    /// What a label costs, metres driven; labels are then sought all along the line (lookahead) [default: none; with
    /// --labels up to a fifth of the mean side, by how far --steps lead]
    #[arg(long, value_name = "METRES|none")]
    price: Option<Price>,
    /// Bits that a label must be expected to carry, else it is not read (lookahead) [default: 0]
    #[arg(long, value_name = "BITS")]
    worth: Option<f64>,
    /// Labels in each at most; then missions are compared by labels and not by steps
    #[arg(long)]
    labels: Option<u32>,
    /// How hypotheses choose an action together (scc) [default: mixture-of-own]
    #[arg(long, value_enum)]
    policy: Option<PolicyName>,
    /// How hypotheses are weighed in that (scc; lookahead and margin where p is below 1) [default: area]
    #[arg(long, value_enum)]
    prior: Option<PriorName>,
}

/// What is to be flown.
#[derive(Debug)]
pub(crate) struct Campaigns {
    /// One for each planner, over all fields.
    pub(crate) of_each: Vec<Campaign>,
    /// Whether they are compared, and not a single one.
    pub(crate) are_compared: bool,
    /// Whether the rows measure labels that may be wrong.
    pub(crate) labels_err: bool,
}

impl Campaigns {
    /// What their rows call them.
    pub(crate) fn planners(&self) -> Planners {
        let names = self.of_each.iter().map(|it| it.algorithm.name()).collect();
        Planners { names, are_named: self.are_compared }
    }
}

impl CampaignFlags {
    /// What they ask for.
    ///
    /// # Errors
    /// Names the flag, what was found and what was expected.
    pub(crate) fn campaigns(&self) -> Result<Campaigns> {
        scenario::check_readings("--readings", self.readings)?;
        let sides = sides(&self.area)?;
        let (flag, planners) = self.planners();
        check_once(planners)?;
        let planners = &of_lines(flag, planners)?[..];
        let p = self.p.unwrap_or(if planners.contains(&Algorithm::Scc) { 0.7 } else { 1.0 });
        let p = scenario::told("--p", p)?;
        let prior = self.p_prior.as_deref().map(prior).transpose()?;
        let p = prior.map_or(p, UnknownReliability::mean);
        let p_told = self.p_told(p, prior)?;
        let true_p = self.true_p.unwrap_or(p);
        planners.iter().try_for_each(|&planner| self.check_meanings(planner, p))?;
        let radius = self.trusted_radius.unwrap_or_default();
        let trusted_radius = scenario::trusted("--trusted-radius", radius)?;
        let errors = Errors {
            position: scenario::deviation("--position-error", self.position_error)?,
            motion: scenario::deviation("--motion-error", self.motion_error)?,
            ..Errors::default()
        };
        let allowance = Allowance { bend: self.bend, drift: self.drift, ..Allowance::NONE };
        allowance.check("--")?;
        let position = scenario::position("--tolerance", self.tolerance, errors)?;
        let tolerance = allowance.tolerance("--tolerance", position)?;
        if prior.is_some() {
            for &planner in planners {
                scenario::check_unknown("--p-prior", tolerance, planner)?;
            }
        }
        let extent = Extent::OutsideBalls(trusted_radius);
        let campaign = |algorithm: Algorithm| {
            let vehicle = self.moving(algorithm)?;
            let area = Area::metres([0.0; 2], sides).map_err(Error::msg)?.into();
            // What is meant for look-ahead alone does not keep others from being compared with it.
            let is_meant = algorithm == Algorithm::Lookahead || self.compare.is_empty();
            let asked = Asked {
                price: self.price.filter(|_| is_meant),
                labels: self.labels,
                worth: self.worth.filter(|_| is_meant),
            };
            let names = ["--price", "--labels", "--worth"];
            let weighs = algorithm.weighs(p < 1.0);
            let most = scenario::most_labels(ORACLE, weighs)?;
            let bounds = (self.steps, most, limit(p));
            let asking = Asking::of(names, asked, (algorithm, &area, &vehicle), bounds)?;
            let room = Room::of(weighs, &asking, false);
            scenario::check_steps("--steps", self.steps, ORACLE, room)?;
            Ok::<_, Error>(Campaign {
                fields: self.fields,
                readings: self.readings,
                every: self.every,
                seed: self.seed,
                crossing: self.crossing.unwrap_or_default().into(),
                following: self.following.map_or(algorithm.following(), Into::into),
                vehicle,
                noise: algorithm.weighs(p < 1.0).then_some(NoiseModel { p: true_p, extent }),
                p_told,
                draws_p: prior.is_some() && self.true_p.is_none(),
                errors,
                tolerance,
                policy: self.policy.unwrap_or_default().into(),
                prior: self.prior.unwrap_or_default().into(),
                sides,
                from_nothing: self.from_nothing,
                asking,
                ..Campaign::of(algorithm, self.steps)
            })
        };
        let of_each = planners.iter().map(|&it| campaign(it)).collect::<Result<Vec<_>>>()?;
        let are_compared = !self.compare.is_empty();
        let labels_err =
            if are_compared { p < 1.0 } else { of_each.iter().any(|it| it.noise.is_some()) };
        Ok(Campaigns { of_each, are_compared, labels_err })
    }

    /// What planners are told of how often labels are true, if that is not what simulated sensors do. `p` is that number,
    /// or the mean of the prior.
    fn p_told(&self, p: f64, prior: Option<UnknownReliability>) -> Result<Option<AnyReliability>> {
        if let Some(true_p) = self.true_p {
            scenario::probability("--true-p", true_p)?;
            if p >= 1.0 {
                bail!(
                    "--true-p: found {true_p} where planners take labels to be true, expected with --p below 1 or --p-prior"
                );
            }
        }
        let known = || self.true_p.and_then(|_| Reliability::new(p).ok()).map(AnyReliability::from);
        Ok(prior.map(AnyReliability::from).or_else(known))
    }

    /// Who plans, and the flag that says so.
    pub(crate) fn planners(&self) -> (&'static str, &[CampaignPlanner]) {
        if self.compare.is_empty() {
            ("--algorithm", slice::from_ref(&self.algorithm))
        } else {
            ("--compare", &self.compare)
        }
    }

    /// The vehicle of this planner.
    fn moving(&self, planner: Algorithm) -> Result<AnyVehicle> {
        self.vehicle.vehicle(Source::Flags, planner, self.fan.is_some(), self.grid(planner))
    }

    /// How finely a planner's vehicle turns.
    fn grid(&self, planner: Algorithm) -> FanName {
        self.fan.unwrap_or(planner.grid())
    }

    /// Whether every flag that was given has a meaning for a planner. `p` is how often labels are true.
    fn check_meanings(&self, planner: Algorithm, p: f64) -> Result<()> {
        let (flag, _) = self.planners();
        let name = planner.name();
        if p < 1.0 && !planner.weighs(true) {
            if let Some(prior) = &self.p_prior {
                bail!(
                    "--p-prior: found {prior}, expected none with {flag} {name}, which takes labels to be true"
                );
            }
            let found = if self.p.is_some() { "" } else { ", the default with scc" };
            bail!(
                "--p: found {p}{found}, expected 1 with {flag} {name}, which takes labels to be true"
            );
        }
        if !planner.copes_with(self.grid(planner)) {
            bail!("--fan: found fine with {flag} {name}, expected paper, as it tries every action");
        }
        if self.from_nothing && planner == Algorithm::Chords {
            bail!(
                "--from-nothing: found with {flag} {name}, expected given points, between which chords lead"
            );
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
                "labels that can be wrong: any --algorithm but cfc, --p below 1",
            ),
        ] {
            if is_given && !has_meaning {
                bail!("{given}: found with {flag} {name}, expected with {meant}");
            }
        }
        Ok(())
    }
}

/// The prior of a flag.
///
/// # Errors
/// Names the flag, what was found and what was expected.
fn prior(text: &str) -> Result<UnknownReliability> {
    let numbers: Vec<f64> = text.split(',').flat_map(|it| it.trim().parse()).collect();
    match (&numbers[..], text.split(',').count()) {
        (&[a, b], 2) => scenario::p_prior("--p-prior", [a, b]),
        _ => bail!("--p-prior: found {text}, expected the a and b of a Beta prior, such as 8,2"),
    }
}

/// The sides of a flag.
fn sides(flag: &[f64]) -> Result<[f64; 2]> {
    match *flag {
        [] => Ok([SIDE_M; 2]),
        [x, z] if [x, z].iter().all(|side| (1.0..=8_000.0).contains(side)) => Ok([x, z]),
        _ => bail!("--area: found {flag:?}, expected two sides in metres, each from 1 to 8000"),
    }
}

/// Whether each planner is compared once.
///
/// # Errors
/// Names the one that is there twice.
pub(crate) fn check_once<T: ValueEnum + PartialEq>(planners: &[T]) -> Result<()> {
    for (k, planner) in planners.iter().enumerate() {
        if planners[..k].contains(planner) {
            let name = planner.to_possible_value().map(|it| it.get_name().to_owned());
            bail!("--compare: found {} twice, expected once", name.unwrap_or_default());
        }
    }
    Ok(())
}
