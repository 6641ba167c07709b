//! `reference`: the paper's full-horizon problem of a scenario, solved, and what planners pay above its optimum.

use std::path::PathBuf;

use anyhow::{Context as _, Result, bail};
use clap::Args;

use crate::cli::format::Format;
use crate::cli::help;
use crate::mission::scenario::{self, Overrides};
use crate::mission::setting::Setting;
use crate::output::file::{json, prepare};
use crate::output::plain;
use crate::reference::instance::Instance;
use crate::reference::objective::LineCost;
use crate::reference::solution::Solution;
use crate::report::picture::Picture;
use crate::report::reference as told;

#[derive(Debug, Args)]
#[command(after_help = help::REFERENCE)]
pub(crate) struct ReferenceArgs {
    /// The mission, a TOML file
    pub(crate) scenario: PathBuf,
    /// Motions in a sequence
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..=12))]
    pub(crate) horizon: u32,
    /// What a line costs, where labels are true [default: slope]
    #[arg(long, value_enum, value_name = "COST")]
    pub(crate) line: Option<LineCost>,
    /// Any key of the scenario, as noise.p=0.9; as often as there are keys
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<Setting>,
    /// Write a figure of the optimum here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

/// Solves it, and what to print.
pub(crate) fn reference(args: &ReferenceArgs) -> Result<String> {
    let name = plain::name(&args.scenario.display().to_string());
    let mission =
        scenario::read(&args.scenario, Overrides { set: &args.set, ..Overrides::default() })?;
    mission.warn(&name);
    let [figure] =
        prepare(&[("the scenario", &args.scenario)], [("--figure", args.figure.as_deref())])?;
    let solution = Instance::new(mission, args.horizon, args.line)
        .and_then(Solution::of)
        .with_context(|| name.clone())?;
    if let Some(output) = figure {
        let Some(optimum) = &solution.optimum else {
            bail!(
                "--figure: found no sequence of motions that keeps the constraints, expected an optimum to draw"
            )
        };
        output.write(Picture::of(&format!("{name}, optimum"), optimum).svg())?;
    }
    Ok(match args.format {
        Format::Text => told::text(&name, &solution),
        Format::Json => json(&solution.record()),
    })
}
