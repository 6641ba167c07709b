//! What the commands do.

use std::path::Path;
use std::{env, fs, slice};

use anyhow::{Context as _, Result, bail};
use planner_core::link::message::LabelSource;
use planner_core::motion::any_vehicle::AnyVehicle;
use planner_core::motion::unicycle::Grid;

use crate::campaign::accuracy::{self, Accuracy};
use crate::campaign::calibration::{self, Calibrated};
use crate::campaign::ensemble::Campaign;
use crate::cli::arguments::{
    CampaignArgs, Cli, Command, FIRMWARE, Format, HilArgs, Labels, ReplayArgs, Run,
};
use crate::cli::compare::{self, Told};
use crate::cli::paper;
use crate::hil::flight::{self, Chip, Timings};
use crate::hil::player::Player;
use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::recording::Recording;
use crate::mission::scenario::{self, Overrides};
use crate::mission::vehicle::Source;
use crate::output::file::{Output, csv, json, prepare, temporary};
use crate::replay::record::Replay;
use crate::report::picture::Picture;
use crate::report::{campaign as tables, text, trace};
use crate::world::errors::Errors;
use crate::world::noise::{Extent, NoiseModel};

/// The speed of the firmware's serial lines, bits per second.
const BAUD: u32 = 115_200;

impl Cli {
    /// Does what was asked and returns what to print.
    ///
    /// # Errors
    /// One message that names the culprit.
    pub fn execute(self) -> Result<String> {
        match self.command {
            None => paper::tell(),
            Some(Command::Run(args)) => run(&args),
            Some(Command::Replay(args)) => replay(&args),
            Some(Command::Campaign(args)) => campaign(&args),
            Some(Command::Hil(args)) => hil(&args),
        }
    }
}

fn run(args: &Run) -> Result<String> {
    let mission = args.mission()?;
    let outputs = prepare(&[args.input()], args.outputs())?;
    let recording = Recording::of(&mission).with_context(|| args.name())?;
    args.tell(outputs, &recording)
}

fn hil(args: &HilArgs) -> Result<String> {
    let mission = args.run.mission()?;
    let elf = args.emulator.clone().unwrap_or_else(|| FIRMWARE.into());
    let (chip, board) = match &args.port {
        Some(device) => ("the port", Path::new(device)),
        None => ("the firmware", elf.as_path()),
    };
    let [trace, figure, candidates] = args.run.outputs();
    let (timing, log) = (args.timing.as_deref(), args.log.as_deref());
    let asked = [trace, figure, candidates, ("--timing", timing), ("--log", log)];
    let prepared = prepare(&[args.run.input(), (chip, board)], asked)?;
    let [trace, figure, candidates, timing, log] = prepared;
    // The emulator writes its log as it goes; it comes to its place when it is whole.
    let log = log.map(|log| Ok::<_, anyhow::Error>((log, temporary(&env::temp_dir())?)));
    let log = log.transpose().context("expected a place for temporary files")?;
    let chip = match &args.port {
        Some(device) => Chip::Board { device: device.clone(), baud: args.baud.unwrap_or(BAUD) },
        None => Chip::Emulated { elf, log: log.as_ref().map(|(_, said)| said.path().to_owned()) },
    };
    let labels = match args.labels {
        Labels::Vehicle => LabelSource::Vehicle,
        Labels::Chip => LabelSource::Chip,
    };
    let faults = args.fault.unwrap_or_default();
    let mut player =
        Player::new(&mission, labels, flight::start_number()).with_context(|| args.run.name())?;
    let flown = flight::fly(&mut player, &chip, faults, mission.seed);
    if let Some((log, said)) = log {
        let said = fs::read(said.path())?;
        // What the board said is wanted most when its mission has failed.
        if flown.is_ok() || !said.is_empty() {
            log.write(said)?;
        }
    }
    let turnarounds = flown?;
    let played = player.finish().with_context(|| args.run.name())?;
    let timings = Timings::new(&played, &turnarounds);
    let rows = timings.csv()?;
    let mut text = args.run.tell([trace, figure, candidates], &played.recording)?;
    if let Some(output) = timing {
        output.write(rows)?;
    }
    if args.run.format == Format::Text {
        text.push('\n');
        text.push_str(&timings.report());
    }
    Ok(text)
}

impl Run {
    fn name(&self) -> String {
        self.scenario.display().to_string()
    }

    fn mission(&self) -> Result<Mission> {
        let Self { algorithm, steps, seed, .. } = *self;
        let mission = scenario::read(&self.scenario, Overrides { algorithm, steps, seed })?;
        if self.candidates.is_some() && !mission.is_noisy() {
            bail!("--candidates: found a mission without noise, expected one with noisy labels");
        }
        if let Some(warning) = mission.warning() {
            eprintln!("{}: {warning}", self.name());
        }
        Ok(mission)
    }

    fn input(&self) -> (&'static str, &Path) {
        ("the scenario", &self.scenario)
    }

    fn outputs(&self) -> [(&'static str, Option<&Path>); 3] {
        [
            ("--trace", self.trace.as_deref()),
            ("--figure", self.figure.as_deref()),
            ("--candidates", self.candidates.as_deref()),
        ]
    }

    /// Writes the trace and the figures that were asked for; what to print.
    fn tell(&self, outputs: [Option<Output>; 3], recording: &Recording) -> Result<String> {
        let [trace, figure, candidates] = outputs;
        let name = self.name();
        let lines = trace::lines(&recording.results);
        // All is drawn before anything is written.
        let svg = figure.as_ref().map(|_| Picture::of(&name, recording).svg()).transpose()?;
        let fewest = candidates.as_ref().and_then(|_| Picture::of_candidates(&name, recording));
        let fewest = fewest.map(|picture| picture.svg()).transpose()?;
        for (output, content) in
            [(trace, Some(&lines)), (figure, svg.as_ref()), (candidates, fewest.as_ref())]
        {
            if let (Some(output), Some(content)) = (output, content) {
                output.write(content)?;
            }
        }
        Ok(match self.format {
            Format::Text => text::mission(&name, &recording.results),
            Format::Json => lines,
        })
    }
}

fn replay(args: &ReplayArgs) -> Result<String> {
    let [figure] =
        prepare(&[("the samples", &args.samples)], [("--figure", args.figure.as_deref())])?;
    let replay = Replay::read(&args.samples)?;
    if let Some(output) = figure {
        output.write(replay.figure()?)?;
    }
    Ok(match args.format {
        Format::Text => replay.report(),
        Format::Json => json(&replay.record()),
    })
}

fn campaign(args: &CampaignArgs) -> Result<String> {
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
    let [output] = prepare(&[], [("--csv", args.csv.as_deref())])?;
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
    let Told { table, rows, record } = if args.compare.is_empty() {
        alone(&campaign(args.algorithm)?)?
    } else {
        let campaigns: Vec<_> =
            planners.iter().map(|&planner| campaign(planner)).collect::<Result<_>>()?;
        compare::fly(&campaigns, p < 1.0)?
    };
    if let Some(output) = output {
        output.write(rows)?;
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
        Told { table, rows, record: json(&summary) }
    } else {
        let summary = accuracy::Summary::of(campaign, campaign.run(&Accuracy)?);
        let (table, rows) = (tables::accuracy(&summary), csv(&summary.checkpoints)?);
        Told { table, rows, record: json(&summary) }
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
