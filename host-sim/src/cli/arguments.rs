//! The command line: what can be asked. The contract is in ARCHITECTURE.md; each command has a file of its own.

use anyhow::Result;
use clap::{Parser, Subcommand, ValueEnum};

use crate::cli::campaign::{CampaignArgs, campaign};
use crate::cli::hil::{HilArgs, hil};
use crate::cli::paper;
use crate::cli::reference::{ReferenceArgs, reference};
use crate::cli::replay::{ReplayArgs, replay};
use crate::cli::run::{Run, run};

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
    /// Solve the paper's full-horizon problem of a scenario, and say what the planners pay above its optimum
    Reference(ReferenceArgs),
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
            Some(Command::Hil(args)) => hil(&args),
            Some(Command::Reference(args)) => reference(&args),
        }
    }
}
