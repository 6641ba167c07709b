//! `init`: a scenario to begin with.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};

use crate::cli::help;
use crate::output::file::prepare;

#[derive(Debug, Args)]
#[command(after_help = help::INIT)]
pub(crate) struct Init {
    /// The file to write
    #[arg(default_value = "mission.toml")]
    pub(crate) file: PathBuf,
    /// Of what kind
    #[arg(long, value_enum, default_value_t)]
    pub(crate) kind: Kind,
    /// Replace a file that is there
    #[arg(long)]
    pub(crate) force: bool,
}

/// What a mission begins as.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum Kind {
    /// Labels are true
    #[default]
    True,
    /// Labels are sometimes wrong
    Noisy,
    /// A car, positions that err, keep-outs
    Car,
}

impl Kind {
    const fn scenario(self) -> &'static str {
        match self {
            Self::True => include_str!("../../scenarios/begin-true.toml"),
            Self::Noisy => include_str!("../../scenarios/begin-noisy.toml"),
            Self::Car => include_str!("../../scenarios/begin-car.toml"),
        }
    }
}

/// Writes it, and what to print.
pub(crate) fn init(args: &Init) -> Result<String> {
    let name = args.file.display();
    if args.file.exists() && !args.force {
        bail!("{name}: found a file, expected none there, or --force");
    }
    let [output] = prepare(&[], [("the scenario", Some(args.file.as_path()))])?;
    if let Some(output) = output {
        output.write(args.kind.scenario())?;
    }
    Ok(format!("{name} is written. Fly it:\n\n  host-sim run {name} --figure mission.svg\n"))
}
