//! The command line: what can be asked. The contract is in ARCHITECTURE.md; each command has a file of its own.

use anyhow::Result;
use clap::{Parser, Subcommand, ValueEnum};

use crate::cli::campaign::{CampaignArgs, campaign};
use crate::cli::figure::{FigureArgs, figure};
use crate::cli::hil::{HilArgs, hil};
use crate::cli::paper;
use crate::cli::replay::{ReplayArgs, replay};
use crate::cli::run::{RunArgs, run};

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
    Run(RunArgs),
    /// Say what samples determine that were recorded elsewhere
    Replay(ReplayArgs),
    /// Run the standard fields and print tables
    Campaign(CampaignArgs),
    /// Draw the paper's figures from what is computed here
    Figure(FigureArgs),
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
            Some(Command::Figure(args)) => figure(&args),
            Some(Command::Hil(args)) => hil(&args),
        }
    }
}
