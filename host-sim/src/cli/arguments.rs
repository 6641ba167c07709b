//! The command line: what can be asked. The contract is in ARCHITECTURE.md.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::hil::faults::Faults;
use crate::mission::algorithm::Algorithm;
use crate::mission::names::{CrossingName, FanName, FollowingName, PolicyName, PriorName};
use crate::mission::vehicle::VehicleTable;

/// Simulates a robot that finds an unknown straight boundary from few samples.
///
/// Without a command: the paper's two examples, as printed, by default and by look-ahead, with
/// figures in out/.
#[derive(Debug, Parser)]
#[command(version)]
pub struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
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
pub(crate) enum Format {
    /// For people
    #[default]
    Text,
    /// For programs
    Json,
}

#[derive(Debug, Args)]
pub(crate) struct Run {
    /// The mission, a TOML file
    pub(crate) scenario: PathBuf,
    /// Who plans [default: the file's]
    #[arg(long)]
    pub(crate) algorithm: Option<Algorithm>,
    /// Steps at most [default: the file's]
    #[arg(long)]
    pub(crate) steps: Option<u32>,
    /// Seed of whatever is random [default: the file's]
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Write the trace here, as JSON Lines
    #[arg(long, value_name = "FILE.jsonl")]
    pub(crate) trace: Option<PathBuf>,
    /// Write a figure here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// Write a figure of the lines with the fewest violations here (scc)
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) candidates: Option<PathBuf>,
    /// What to print; json prints the trace
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
#[group(id = "chip", required = true, multiple = false, args = ["port", "emulator"])]
pub(crate) struct HilArgs {
    #[command(flatten)]
    pub(crate) run: Run,
    /// The serial port that a board is at
    #[arg(long, value_name = "DEVICE")]
    pub(crate) port: Option<String>,
    /// The port's speed, bits per second [default: 115200]
    #[arg(long, conflicts_with = "emulator")]
    pub(crate) baud: Option<u32>,
    /// Emulate the firmware under QEMU instead
    #[arg(
        long,
        value_name = "ELF",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = FIRMWARE
    )]
    pub(crate) emulator: Option<PathBuf>,
    /// Write the emulated board's log here, for defmt-print
    #[arg(long, value_name = "FILE", conflicts_with = "port")]
    pub(crate) log: Option<PathBuf>,
    /// Who reads labels: the simulated vehicle, or the board's own pin
    #[arg(long, value_enum, default_value_t)]
    pub(crate) labels: Labels,
    /// Spoil the link: drop, cut, corrupt, duplicate (probabilities of a frame), delay (at most)
    #[arg(long, value_name = "drop=0.1,delay=20ms,...")]
    pub(crate) fault: Option<Faults>,
    /// Write what each step took here
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) timing: Option<PathBuf>,
}

/// Where `cargo firmware` leaves it.
pub(crate) const FIRMWARE: &str = "target/thumbv7em-none-eabihf/release/firmware";

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Labels {
    /// The simulated vehicle
    #[default]
    Vehicle,
    /// The board's own sensor
    Chip,
}

#[derive(Debug, Args)]
pub(crate) struct ReplayArgs {
    /// The samples, a CSV file with the columns x, z (metres) and label (-1 or 1)
    pub(crate) samples: PathBuf,
    /// Write a figure here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

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
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}
