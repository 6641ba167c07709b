//! The command line: commands and flags. The contract is in docs/reference/command-line.md, whose tables of flags are made
//! from these. Each command has a file of its own.

use std::any::TypeId;
use std::path::PathBuf;

use anyhow::Result;
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::cli::campaign::{CampaignArgs, campaign};
use crate::cli::completions::{Completions, completions};
use crate::cli::done::Done;
use crate::cli::figure::{FigureArgs, figure};
use crate::cli::fly::{FlyArgs, fly};
use crate::cli::hil::{HilArgs, hil};
use crate::cli::init::{Init, init};
use crate::cli::join::{JoinArgs, join};
use crate::cli::next::{Next, next};
use crate::cli::reference::{ReferenceArgs, reference};
use crate::cli::replay::{ReplayArgs, replay};
use crate::cli::run::{RunArgs, run};
use crate::cli::size::{SizeArgs, size};
use crate::cli::{help, paper};
use crate::output::notes::{self, Loudness};

/// Simulates a robot that finds and maps an unknown boundary, straight or bending.
///
/// Without a command: the paper's two examples, as printed, by default and by look-ahead, with
/// figures in out/.
#[derive(Debug, Parser)]
#[command(version, after_help = help::MAIN)]
pub struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// Print results and errors alone: no progress, no warnings
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// Also print which files are written and what is built
    #[arg(short, long, global = true, conflicts_with = "quiet")]
    pub(crate) verbose: bool,
}

fn with_hyphens(command: clap::Command) -> clap::Command {
    let with_hyphen = |arg: clap::Arg| {
        let is_file = arg.get_value_parser().type_id() == TypeId::of::<PathBuf>();
        match arg.get_action().takes_values() {
            true if arg.is_positional() => arg.allow_negative_numbers(true),
            true if !is_file => arg.allow_hyphen_values(true),
            _ => arg,
        }
    };
    command.mut_args(with_hyphen).mut_subcommands(with_hyphens)
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run one mission
    Run(RunArgs),
    /// Print what a robot is to do next, in JSON, after a request in JSON on standard input
    Next(Next),
    /// Print what samples recorded elsewhere determine
    Replay(ReplayArgs),
    /// Join the maps of several robots on one front
    Join(JoinArgs),
    /// Run the standard fields and print tables
    Campaign(Box<CampaignArgs>),
    /// Draw the paper's figures from what is computed here
    Figure(FigureArgs),
    /// Have a board, or its firmware under emulation, fly a mission
    Hil(HilArgs),
    /// Fly a mission with a vehicle that speaks `MAVLink`
    Fly(Box<FlyArgs>),
    /// Solve the paper's full-horizon problem of a scenario, and say what the planners pay above its optimum
    Reference(ReferenceArgs),
    /// Print what a planner needs on a chip: flash, RAM, instructions
    Size(SizeArgs),
    /// Write a commented file to begin with: a scenario, or a recording
    Init(Init),
    /// Print a script with which a shell completes commands and flags
    Completions(Completions),
}

impl Cli {
    /// Reads the command line. A value may begin with a hyphen, so that a negative number is refused by its flag; a file's
    /// name may not.
    ///
    /// # Errors
    /// Help, a version, or what is wrong.
    pub fn read() -> Result<Self, clap::Error> {
        let matches = with_hyphens(Self::command()).try_get_matches()?;
        Self::from_arg_matches(&matches)
    }

    /// Does what was asked.
    ///
    /// # Errors
    /// One message that names the culprit.
    pub fn execute(self) -> Result<Done> {
        notes::set(match (self.quiet, self.verbose) {
            (true, _) => Loudness::Quiet,
            (_, true) => Loudness::Verbose,
            _ => Loudness::Usual,
        });
        let text = match self.command {
            Some(Command::Fly(args)) => return fly(&args),
            Some(Command::Run(args)) => return run(&args),
            Some(Command::Replay(args)) => return replay(&args),
            Some(Command::Hil(args)) => return hil(&args),
            None => paper::tell(),
            Some(Command::Campaign(args)) => campaign(&args),
            Some(Command::Join(args)) => join(&args),
            Some(Command::Next(args)) => next(&args),
            Some(Command::Figure(args)) => figure(&args),
            Some(Command::Size(args)) => size(&args),
            Some(Command::Reference(args)) => reference(&args),
            Some(Command::Init(args)) => init(&args),
            Some(Command::Completions(args)) => completions(&args, Self::command()),
        };
        text.map(Done::from)
    }
}
