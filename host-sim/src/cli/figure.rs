//! `figure`: the paper's figures, from what is computed here.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;

use crate::cli::help;
use crate::output::file::{make_folder, prepare};
use crate::report::paper::{FIGURES, figure as draw};

#[derive(Debug, Args)]
#[command(after_help = help::FIGURE)]
pub(crate) struct FigureArgs {
    /// The number of the paper's figure, 1 to 8, or all
    #[arg(value_name = "N|all", value_parser = which)]
    which: Which,
    /// Write paper-figure-N.svg into this folder
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug)]
enum Which {
    One(u32),
    All,
}

fn which(word: &str) -> Result<Which> {
    if word == "all" {
        return Ok(Which::All);
    }
    match word.parse() {
        Ok(number) if (1..=FIGURES).contains(&number) => Ok(Which::One(number)),
        _ => bail!("expected 1 to {FIGURES}, or all"),
    }
}

/// Draws them, and what to print.
pub(crate) fn figure(args: &FigureArgs) -> Result<String> {
    const MOST: usize = FIGURES as usize;
    let numbers = match args.which {
        Which::One(number) => number..=number,
        Which::All => 1..=FIGURES,
    };
    make_folder("--out: ", &args.out)?;
    let places: [_; MOST] = std::array::from_fn(|k| {
        let number = k as u32 + 1;
        let name = format!("paper-figure-{number}.svg");
        (format!("figure {number}"), numbers.contains(&number).then(|| args.out.join(name)))
    });
    let outputs =
        prepare(&[], places.each_ref().map(|(what, path)| (what.as_str(), path.as_deref())))?;
    // All is drawn before anything is written.
    let drawn = numbers.map(draw).collect::<Result<Vec<_>>>()?;
    for (output, svg) in outputs.into_iter().flatten().zip(drawn) {
        output.write(svg)?;
    }
    let written = places.iter().filter_map(|(_, path)| path.as_ref());
    let written: Vec<_> = written.map(|path| path.display().to_string()).collect();
    Ok(written.join("\n") + "\n")
}
