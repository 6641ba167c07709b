//! The command line. The contract is in ARCHITECTURE.md.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use clap::{Args, Parser, Subcommand, ValueEnum};
use planner_core::wire::LabelSource;

use crate::campaign::Campaign;
use crate::faults::Faults;
use crate::figure::Figure;
use crate::hil::{self, Chip};
use crate::mission::{Algorithm, Mission};
use crate::names::{CrossingName, FollowingName, PolicyName, PriorName};
use crate::noisy_campaign::NoisyCampaign;
use crate::output::{Output, json};
use crate::recording::Recording;
use crate::replay::Replay;
use crate::scenario::{self, Overrides};
use crate::{report, trace};

/// Simulates a robot that finds an unknown straight boundary from few samples.
///
/// Without a command: the paper's two examples, start to end, with figures in out/.
#[derive(Debug, Parser)]
#[command(version)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run one mission
    Run(Run),
    /// Say what samples determine that were recorded elsewhere
    Replay(ReplayArgs),
    /// Run the standard fields and print tables
    Campaign(CampaignArgs),
    /// Have a board, or its firmware under emulation, fly a mission
    Hil(HilArgs),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people
    #[default]
    Text,
    /// For programs
    Json,
}

#[derive(Debug, Args)]
struct Run {
    /// The mission, a TOML file
    scenario: PathBuf,
    /// Who plans [default: the file's]
    #[arg(long)]
    algorithm: Option<Algorithm>,
    /// Steps at most [default: the file's]
    #[arg(long)]
    steps: Option<u32>,
    /// Seed of whatever is random [default: the file's]
    #[arg(long)]
    seed: Option<u64>,
    /// Write the trace here, as JSON Lines
    #[arg(long, value_name = "FILE.jsonl")]
    trace: Option<PathBuf>,
    /// Write a figure here
    #[arg(long, value_name = "FILE.svg")]
    figure: Option<PathBuf>,
    /// Write a figure of the lines with the fewest violations here (scc)
    #[arg(long, value_name = "FILE.svg")]
    candidates: Option<PathBuf>,
    /// What to print; json prints the trace
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

#[derive(Debug, Args)]
#[group(id = "chip", required = true, multiple = false, args = ["port", "emulator"])]
struct HilArgs {
    #[command(flatten)]
    run: Run,
    /// The serial port that a board is at
    #[arg(long, value_name = "DEVICE")]
    port: Option<String>,
    /// The port's speed, bits per second
    #[arg(long, default_value_t = 115_200)]
    baud: u32,
    /// Emulate the firmware under QEMU instead
    #[arg(
        long,
        value_name = "ELF",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = FIRMWARE
    )]
    emulator: Option<PathBuf>,
    /// Write the emulated board's log here, for defmt-print
    #[arg(long, value_name = "FILE", conflicts_with = "port")]
    log: Option<PathBuf>,
    /// Who reads labels: the simulated vehicle, or the board's own pin
    #[arg(long, value_enum, default_value_t)]
    labels: Labels,
    /// Spoil the link: drop, cut, corrupt, duplicate (probabilities of a frame), delay (at most)
    #[arg(long, value_name = "drop=0.1,delay=20ms,...")]
    fault: Option<Faults>,
    /// Write what each step took here
    #[arg(long, value_name = "FILE.csv")]
    timing: Option<PathBuf>,
}

/// Where `cargo firmware` leaves it.
const FIRMWARE: &str = "target/thumbv7em-none-eabihf/release/firmware";

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Labels {
    /// The simulated vehicle
    #[default]
    Vehicle,
    /// The board's own sensor
    Chip,
}

#[derive(Debug, Args)]
struct ReplayArgs {
    /// The samples, a CSV file with the columns x, z (metres) and label (-1 or 1)
    samples: PathBuf,
    /// Write a figure here
    #[arg(long, value_name = "FILE.svg")]
    figure: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

#[derive(Debug, Args)]
struct CampaignArgs {
    /// Number of standard fields
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    fields: u64,
    /// Steps in each
    #[arg(long, default_value_t = 20)]
    steps: u32,
    /// Seed of the ensemble
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Who plans
    #[arg(long, value_enum, default_value_t = Algorithm::Cfc)]
    algorithm: Algorithm,
    /// How P1 looks for the opposite label
    #[arg(long, value_enum, default_value_t)]
    crossing: CrossingName,
    /// How P2 follows the boundary [default: along-bisector; for scc anyhow]
    #[arg(long, value_enum)]
    following: Option<FollowingName>,
    /// Labels are true with this probability [default: 0.7 for scc, 1 else]
    #[arg(long)]
    p: Option<f64>,
    /// Within this distance of the oracle's points labels are certain, metres
    #[arg(long, default_value_t = 0.0)]
    trusted_radius: f64,
    /// How hypotheses choose an action together (scc)
    #[arg(long, value_enum, default_value_t)]
    policy: PolicyName,
    /// How hypotheses are weighed in that (scc)
    #[arg(long, value_enum, default_value_t)]
    prior: PriorName,
    /// Write a row for each field and mark here
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Cli {
    /// Does what was asked and returns what to print.
    ///
    /// # Errors
    /// One message that names the culprit.
    pub fn execute(self) -> Result<String> {
        match self.command {
            None => paper(),
            Some(Command::Run(args)) => run(&args),
            Some(Command::Replay(args)) => replay(&args),
            Some(Command::Campaign(args)) => campaign(&args),
            Some(Command::Hil(args)) => hil(&args),
        }
    }
}

/// What the bare command tells first.
pub const PAPER_TITLE: &str = "The paper's noiseless example (Section V), Algorithm 1";

const PAPER_NOISY_TITLE: &str = "The paper's noisy example (Section V), Algorithm 2";

const CANDIDATES_TITLE: &str = "Its labels do not tell which line is true: fewest violations";

/// The paper's two examples, start to end.
fn paper() -> Result<String> {
    fs::create_dir_all("out").context("out: expected a place to make a folder")?;
    let names = ["paper-noiseless.svg", "paper-noisy.svg", "paper-noisy-candidates.svg"];
    let places = names.map(|name| Output::create(&Path::new("out").join(name)));
    let places = places.into_iter().collect::<Result<Vec<_>>>()?;
    let example = |text| Recording::of(&scenario::parse("", text, Overrides::default())?);
    let noiseless = example(scenario::PAPER_NOISELESS)?;
    let noisy = example(scenario::PAPER_NOISY)?;
    // All is drawn before anything is written.
    let figures = [
        Some(Figure::of(PAPER_TITLE, &noiseless)),
        Some(Figure::of(PAPER_NOISY_TITLE, &noisy)),
        Figure::of_candidates(CANDIDATES_TITLE, &noisy),
    ];
    let drawn = figures.iter().flatten().map(Figure::svg).collect::<Result<Vec<_>>>()?;
    for (place, svg) in places.into_iter().zip(drawn) {
        place.write(&svg)?;
    }
    Ok(format!(
        "{}\n\n{}\nFigures in out/: {}\n",
        report::mission(PAPER_TITLE, &noiseless),
        report::mission(PAPER_NOISY_TITLE, &noisy),
        names.join(", ")
    ))
}

fn run(args: &Run) -> Result<String> {
    let mission = args.mission()?;
    let outputs = args.outputs()?;
    let recording = Recording::of(&mission).with_context(|| args.name())?;
    args.tell(outputs, &recording)
}

fn hil(args: &HilArgs) -> Result<String> {
    let mission = args.run.mission()?;
    let outputs = args.run.outputs()?;
    let timing = Output::create_if(args.timing.as_ref())?;
    let chip = match (&args.port, &args.emulator) {
        (Some(device), _) => Chip::Board { device: device.clone(), baud: args.baud },
        (None, elf) => {
            let elf = elf.clone().unwrap_or_else(|| FIRMWARE.into());
            Chip::Emulated { elf, log: args.log.clone() }
        }
    };
    let labels = match args.labels {
        Labels::Vehicle => LabelSource::Vehicle,
        Labels::Chip => LabelSource::Chip,
    };
    let faults = args.fault.unwrap_or_default();
    let flight = hil::fly(&mission, labels, &chip, faults).with_context(|| args.run.name())?;
    let rows = flight.csv()?;
    let mut text = args.run.tell(outputs, &flight.played.recording)?;
    if let Some(output) = timing {
        output.write(&rows)?;
    }
    if args.run.format == Format::Text {
        text.push('\n');
        text.push_str(&flight.report());
    }
    Ok(text)
}

/// The files that a mission is told in.
struct Outputs {
    trace: Option<Output>,
    figure: Option<Output>,
    candidates: Option<Output>,
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
        Ok(mission)
    }

    fn outputs(&self) -> Result<Outputs> {
        Ok(Outputs {
            trace: Output::create_if(self.trace.as_ref())?,
            figure: Output::create_if(self.figure.as_ref())?,
            candidates: Output::create_if(self.candidates.as_ref())?,
        })
    }

    /// Writes the files that were asked for; what to print.
    fn tell(&self, outputs: Outputs, recording: &Recording) -> Result<String> {
        let Outputs { trace, figure, candidates } = outputs;
        let name = self.name();
        let lines = trace::lines(recording);
        // All is drawn before anything is written.
        let svg = figure.as_ref().map(|_| Figure::of(&name, recording).svg()).transpose()?;
        let fewest = candidates.as_ref().and_then(|_| Figure::of_candidates(&name, recording));
        let fewest = fewest.map(|figure| figure.svg()).transpose()?;
        for (output, content) in
            [(trace, Some(&lines)), (figure, svg.as_ref()), (candidates, fewest.as_ref())]
        {
            if let (Some(output), Some(content)) = (output, content) {
                output.write(content)?;
            }
        }
        Ok(match self.format {
            Format::Text => report::mission(&name, recording),
            Format::Json => lines,
        })
    }
}

fn replay(args: &ReplayArgs) -> Result<String> {
    let replay = Replay::read(&args.samples)?;
    if let Some(output) = Output::create_if(args.figure.as_ref())? {
        output.write(&replay.figure()?)?;
    }
    Ok(match args.format {
        Format::Text => replay.report(),
        Format::Json => json(&replay.record()),
    })
}

fn campaign(args: &CampaignArgs) -> Result<String> {
    const ORACLE: usize = 4;
    scenario::check_steps("--steps", args.steps, ORACLE)?;
    let output = Output::create_if(args.csv.as_ref())?;
    let campaign = Campaign {
        algorithm: args.algorithm,
        fields: args.fields,
        steps: args.steps,
        seed: args.seed,
        crossing: args.crossing.into(),
        following: args.following.map_or(args.algorithm.following(), Into::into),
    };
    let p = args.p.unwrap_or(if args.algorithm == Algorithm::Scc { 0.7 } else { 1.0 });
    let p = scenario::probability("--p", p)?;
    let trusted_radius = scenario::trusted("--trusted-radius", args.trusted_radius)?;
    let noisy = args.algorithm == Algorithm::Scc || p < 1.0;
    if noisy && args.algorithm == Algorithm::Cfc {
        bail!("--p: found {p}, expected 1 with --algorithm cfc, which takes labels to be true");
    }
    let (table, rows, record) = if noisy {
        let (policy, prior) = (args.policy.into(), args.prior.into());
        let noisy = NoisyCampaign { fields: campaign, p, trusted_radius, policy, prior };
        let summary = noisy.run()?;
        (summary.report(), summary.csv()?, json(&summary))
    } else {
        let summary = campaign.run()?;
        (summary.report(), summary.csv()?, json(&summary))
    };
    if let Some(output) = output {
        output.write(&rows)?;
    }
    Ok(match args.format {
        Format::Text => table,
        Format::Json => record,
    })
}
