//! `size`: the flash, RAM and time that a planner needs on a chip.

use std::fmt::Write as _;

use anyhow::{Result, bail};
use clap::Args;

use crate::cli::format::Format;
use crate::cli::help;
use crate::size::configuration::{Configuration, Planner};
use crate::size::measurements::{Call, Flash, M4F, Other, Size, size as measured};

#[derive(Debug, Args)]
#[command(after_help = help::SIZE)]
pub(crate) struct SizeArgs {
    /// Who plans
    #[arg(long, value_enum, default_value_t = Planner::Lookahead)]
    algorithm: Planner,
    /// Samples, the given ones included: 36 unless one says
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(3..))]
    samples: Option<u16>,
    /// Hypotheses, if labels may be wrong: all that 32 labels can have are 529
    #[arg(long, value_name = "H", value_parser = clap::value_parser!(u16).range(2..))]
    hypotheses: Option<u16>,
    /// Any vehicle among polygons and keep-outs, instead of a unicycle in a rectangle
    #[arg(long)]
    any_vehicle: bool,
    /// The clock of the Cortex-M4F, MHz
    #[arg(long, value_name = "F", default_value_t = 168.0, value_parser = clock)]
    mhz: f64,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

fn clock(word: &str) -> Result<f64> {
    match word.parse() {
        Ok(mhz) if (0.001..=10_000.0).contains(&mhz) => Ok(mhz),
        _ => bail!("expected a clock from 0.001 to 10000 MHz"),
    }
}

/// What it takes, to print.
pub(crate) fn size(args: &SizeArgs) -> Result<String> {
    let asked = configuration(args)?;
    let size = measured(asked, args.mhz)?;
    match args.format {
        Format::Json => Ok(serde_json::to_string_pretty(&(asked, size)).map(|it| it + "\n")?),
        Format::Text => Ok(text(asked, &size, args.mhz)),
    }
}

fn configuration(args: &SizeArgs) -> Result<Configuration> {
    let planner = args.algorithm;
    if planner == Planner::Track {
        for (flag, given) in
            [("--samples", args.samples.is_some()), ("--hypotheses", args.hypotheses.is_some())]
        {
            if given {
                bail!("{flag}: a follower of fronts stores no labels");
            }
        }
    }
    let (samples, hypotheses) = match (planner, args.hypotheses) {
        (Planner::Track, _) => (0, 0),
        (Planner::Cfc, Some(_)) => bail!("--hypotheses: Algorithm 1 takes labels to be true"),
        (Planner::Scc, None) => {
            bail!("--hypotheses: Algorithm 2 needs some: 529 hold all of 32 labels")
        }
        (_, hypotheses) => (args.samples.unwrap_or(36), hypotheses.unwrap_or(1)),
    };
    Ok(Configuration { planner, samples, hypotheses, roams: args.any_vehicle })
}

fn text(asked: Configuration, size: &Size, mhz: f64) -> String {
    let Size { program, room, flash, flash_of_planner, stack, static_ram, calls, others } = size;
    let mut text =
        format!("{asked}\nat most what `{program}` takes, which has room for {room}\n\n");
    for Flash { core, bytes } in flash {
        let _ = writeln!(text, "flash, {core:<24}{bytes:>10} bytes, with the link");
    }
    let name = M4F.name;
    let _ = writeln!(text, "flash of the planner, {name:<10}{flash_of_planner:>9} bytes");
    let _ = writeln!(text, "stack, {name:<24}{stack:>10} bytes, a bound; the planner is on it");
    let _ = writeln!(text, "other RAM{static_ram:>32} bytes");
    for Call { call, program, median, worst, worst_ms } in calls {
        let _ = writeln!(
            text,
            "{call:<31}{median:>10} instructions in the median, {worst} at worst: {worst_ms:.2} ms at {mhz} MHz (`{program}`)"
        );
    }
    for Other { core, program, stack_seen, mhz, calls } in others {
        let _ =
            writeln!(text, "\n{core} at {mhz} MHz (`{program}`): {stack_seen} bytes of stack seen");
        for Call { call, median, worst, worst_ms, .. } in calls {
            let _ = writeln!(
                text,
                "{call:<31}{median:>10} instructions in the median, {worst} at worst: {worst_ms:.2} ms at least"
            );
        }
    }
    if calls.len() < 3 || others.len() < 2 || others.iter().any(|it| it.calls.len() < 3) {
        text += "\nWhat is missing was not timed with as much room.\n";
    }
    text
}
