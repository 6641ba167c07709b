//! `replay`: what samples determine that were recorded elsewhere.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use crate::cli::arguments::Format;
use crate::cli::help;
use crate::output::file::{json, prepare};
use crate::replay::record::Replay;

#[derive(Debug, Args)]
#[command(after_help = help::REPLAY)]
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

/// Reads them, and what to print.
pub(crate) fn replay(args: &ReplayArgs) -> Result<String> {
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
