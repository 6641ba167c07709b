//! `init`: a file to begin with.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};

use crate::cli::help;
use crate::output::file::prepare;
use crate::output::plain;

#[derive(Debug, Args)]
#[command(after_help = help::INIT)]
pub(crate) struct Init {
    /// What to begin with
    #[arg(value_enum, default_value_t)]
    pub(crate) kind: Kind,
    /// The file to write [default: mission.toml, or samples.csv of a recording]
    pub(crate) file: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum Kind {
    /// A straight boundary, and labels that are true
    #[default]
    Line,
    /// A straight boundary, and labels that are sometimes wrong
    Noisy,
    /// A car among keep-outs, whose positions err
    Car,
    /// A front that bends, such as a coast: follow and map it
    Front,
    /// A spill somewhere: find it from nothing, go round it
    Spill,
    /// Samples of your own, as a CSV file for `replay`
    Recording,
}

/// A command, the usual file that it reads, and what `init` writes there.
type Beginning = (&'static str, &'static str, &'static str);

const fn beginning(kind: Kind) -> Beginning {
    const fn mission(text: &'static str) -> Beginning {
        ("run", "mission.toml", text)
    }
    match kind {
        Kind::Line => mission(include_str!("../../scenarios/begin-line.toml")),
        Kind::Noisy => mission(include_str!("../../scenarios/begin-noisy.toml")),
        Kind::Car => mission(include_str!("../../scenarios/begin-car.toml")),
        Kind::Front => mission(include_str!("../../scenarios/begin-front.toml")),
        Kind::Spill => mission(include_str!("../../scenarios/begin-spill.toml")),
        Kind::Recording => ("replay", "samples.csv", include_str!("../../recordings/begin.csv")),
    }
}

/// Writes it, and what to print.
pub(crate) fn init(args: &Init) -> Result<String> {
    let (command, usual, text) = beginning(args.kind);
    let usual = Path::new(usual);
    let file = args.file.as_deref().unwrap_or(usual);
    let name = plain::name(&file.display().to_string());
    if file.is_file() && !args.force {
        bail!("{name}: found a file, expected none there, or --force");
    }
    let [output] = prepare(&[], [("the file", Some(file))])?;
    let next = next(command, file);
    if let Some(output) = output {
        output.write(text.replace(&self::next(command, usual), &next))?;
    }
    Ok(format!("{name} is written. Next:\n\n  {next}\n"))
}

/// The command that reads a file, as the file's first lines have it too. Its figure is beside the file.
fn next(command: &str, file: &Path) -> String {
    let is_figure = file.extension().is_some_and(|it| it.eq_ignore_ascii_case("svg"));
    let figure = file.with_extension(if is_figure { "svg.svg" } else { "svg" });
    format!("host-sim {command} {} --figure {}", word(file), word(&figure))
}

/// A path as one word of a shell.
fn word(path: &Path) -> String {
    let name = plain::name(&path.display().to_string());
    let name = if name.starts_with('-') { format!("./{name}") } else { name };
    let is_simple = |it: char| it.is_alphanumeric() || "/._-+,:@%=".contains(it);
    if name.chars().all(is_simple) { name } else { format!("'{}'", name.replace('\'', "'\\''")) }
}
