//! `next`: what a robot is to do next, for programs.

use std::io::Read as _;
use std::path::PathBuf;

use anyhow::{Context as _, Result};
use clap::Args;

use crate::cli::help;
use crate::mission::{next, scenario};
use crate::output::plain;

#[derive(Debug, Args)]
#[command(after_help = help::NEXT)]
pub(crate) struct Next {
    /// The mission, a TOML file, if the request does not say all of it
    scenario: Option<PathBuf>,
}

/// Answers the request on standard input.
pub(crate) fn next(args: &Next) -> Result<String> {
    let mut request = String::new();
    std::io::stdin().read_to_string(&mut request).context("standard input: expected JSON")?;
    let Some(path) = &args.scenario else { return next::answer(&request, None) };
    let (name, text) = (plain::name(&path.display().to_string()), scenario::content(path)?);
    next::answer(&request, Some((&name, &text, scenario::beside(path))))
}
