//! `init`: a scenario to begin with.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};

use crate::cli::help;
use crate::output::file::prepare;
use crate::output::plain;

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
    let name = plain::name(&args.file.display().to_string());
    if args.file.exists() && !args.force {
        bail!("{name}: found a file, expected none there, or --force");
    }
    let [output] = prepare(&[], [("the scenario", Some(args.file.as_path()))])?;
    let next = next(&args.file);
    if let Some(output) = output {
        output.write(args.kind.scenario().replace(NEXT, &next))?;
    }
    Ok(format!("{name} is written. Fly it:\n\n  {next}\n"))
}

/// The command that the scenarios have in their first lines.
const NEXT: &str = "host-sim run mission.toml --figure mission.svg";

/// The same command for a file of another name. Its figure is beside it.
fn next(file: &Path) -> String {
    let is_figure = file.extension().is_some_and(|it| it.eq_ignore_ascii_case("svg"));
    let figure = file.with_extension(if is_figure { "svg.svg" } else { "svg" });
    format!("host-sim run {} --figure {}", word(file), word(&figure))
}

/// A path as one word of a shell.
fn word(path: &Path) -> String {
    let name = plain::name(&path.display().to_string());
    let name = if name.starts_with('-') { format!("./{name}") } else { name };
    let is_simple = |it: char| it.is_alphanumeric() || "/._-+,:@%=".contains(it);
    if name.chars().all(is_simple) { name } else { format!("'{}'", name.replace('\'', "'\\''")) }
}
