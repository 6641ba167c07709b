//! The command line. The contract is in ARCHITECTURE.md.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::campaign::Campaign;
use crate::figure::Figure;
use crate::mission::Algorithm;
use crate::output::Output;
use crate::recording::Recording;
use crate::replay::Replay;
use crate::scenario::{self, CrossingName, FollowingName, Overrides};
use crate::{report, trace};

/// Simulates a robot that finds an unknown straight boundary from few samples.
///
/// Without a command: the paper's noiseless example, start to end, with a figure in out/.
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
    /// What to print; json prints the trace
    #[arg(long, value_enum, default_value_t)]
    format: Format,
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
    /// How P2 follows the boundary
    #[arg(long, value_enum, default_value_t)]
    following: FollowingName,
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
        }
    }
}

/// What the bare command tells.
pub const PAPER_TITLE: &str = "The paper's noiseless example (Section V), Algorithm 1";

/// The paper's example, start to end.
fn paper() -> Result<String> {
    let path = Path::new("out").join("paper-noiseless.svg");
    fs::create_dir_all("out").context("out: expected a place to make a folder")?;
    let output = Output::create(&path)?;
    let name = "paper-noiseless.toml";
    let mission = scenario::parse(name, scenario::PAPER_NOISELESS, Overrides::default())?;
    let recording = Recording::of(mission)?;
    output.write(&Figure::of(PAPER_TITLE, &recording).svg()?)?;
    let story = report::mission(PAPER_TITLE, &recording);
    Ok(format!("{story}\nFigure: {}\n", path.display()))
}

fn run(args: &Run) -> Result<String> {
    let Run { scenario, algorithm, steps, seed, trace, figure, format } = args;
    let overrides = Overrides { algorithm: *algorithm, steps: *steps, seed: *seed };
    let mission = scenario::read(scenario, overrides)?;
    let outputs = (Output::create_if(trace.as_ref())?, Output::create_if(figure.as_ref())?);
    let name = scenario.display().to_string();
    let recording = Recording::of(mission).with_context(|| name.clone())?;
    let lines = trace::lines(&recording);
    let svg = outputs.1.as_ref().map(|_| Figure::of(&name, &recording).svg()).transpose()?;
    if let Some(output) = outputs.0 {
        output.write(&lines)?;
    }
    if let (Some(output), Some(svg)) = (outputs.1, svg) {
        output.write(&svg)?;
    }
    Ok(match format {
        Format::Text => report::mission(&name, &recording),
        Format::Json => lines,
    })
}

fn replay(args: &ReplayArgs) -> Result<String> {
    let replay = Replay::read(&args.samples)?;
    if let Some(output) = Output::create_if(args.figure.as_ref())? {
        output.write(&replay.figure()?)?;
    }
    Ok(match args.format {
        Format::Text => replay.report(),
        Format::Json => replay.json(),
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
        following: args.following.into(),
    };
    let summary = campaign.run()?;
    if let Some(output) = output {
        output.write(&summary.csv()?)?;
    }
    Ok(match args.format {
        Format::Text => summary.report(),
        Format::Json => summary.json(),
    })
}
