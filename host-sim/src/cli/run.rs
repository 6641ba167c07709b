//! `run`: one mission.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use clap::Args;

use crate::cli::arguments::Format;
use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::recording::Recording;
use crate::mission::scenario::{self, Overrides};
use crate::output::file::{Output, prepare};
use crate::report::picture::Picture;
use crate::report::{text, trace};

#[derive(Debug, Args)]
pub(crate) struct Run {
    /// The mission, a TOML file
    pub(crate) scenario: PathBuf,
    /// Who plans [default: the file's]
    #[arg(long)]
    pub(crate) algorithm: Option<Algorithm>,
    /// Steps at most [default: the file's]
    #[arg(long)]
    pub(crate) steps: Option<u32>,
    /// Seed of whatever is random [default: the file's]
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Write the trace here, as JSON Lines
    #[arg(long, value_name = "FILE.jsonl")]
    pub(crate) trace: Option<PathBuf>,
    /// Write a figure here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// Write a figure of the lines with the fewest violations here (scc)
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) candidates: Option<PathBuf>,
    /// What to print; json prints the trace
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

/// Flies it, and what to print.
pub(crate) fn run(args: &Run) -> Result<String> {
    let mission = args.mission()?;
    let outputs = prepare(&[args.input()], args.outputs())?;
    let recording = Recording::of(&mission).with_context(|| args.name())?;
    args.tell(outputs, &recording)
}

impl Run {
    pub(crate) fn name(&self) -> String {
        self.scenario.display().to_string()
    }

    pub(crate) fn mission(&self) -> Result<Mission> {
        let Self { algorithm, steps, seed, .. } = *self;
        let mission = scenario::read(&self.scenario, Overrides { algorithm, steps, seed })?;
        if self.candidates.is_some() && !mission.is_noisy() {
            bail!("--candidates: found a mission without noise, expected one with noisy labels");
        }
        if let Some(warning) = mission.warning() {
            eprintln!("{}: {warning}", self.name());
        }
        Ok(mission)
    }

    pub(crate) fn input(&self) -> (&'static str, &Path) {
        ("the scenario", &self.scenario)
    }

    pub(crate) fn outputs(&self) -> [(&'static str, Option<&Path>); 3] {
        [
            ("--trace", self.trace.as_deref()),
            ("--figure", self.figure.as_deref()),
            ("--candidates", self.candidates.as_deref()),
        ]
    }

    /// Writes the trace and the figures that were asked for; what to print.
    pub(crate) fn tell(
        &self,
        outputs: [Option<Output>; 3],
        recording: &Recording,
    ) -> Result<String> {
        let [trace, figure, candidates] = outputs;
        let name = self.name();
        let title = self.scenario.file_stem().unwrap_or_default().to_string_lossy();
        let lines = trace::lines(&recording.results);
        // All is drawn before anything is written.
        let svg = figure.as_ref().map(|_| Picture::of(&title, recording).svg());
        let fewest = candidates.as_ref().and_then(|_| Picture::of_candidates(&title, recording));
        let fewest = fewest.map(|picture| picture.svg());
        for (output, content) in
            [(trace, Some(&lines)), (figure, svg.as_ref()), (candidates, fewest.as_ref())]
        {
            if let (Some(output), Some(content)) = (output, content) {
                output.write(content)?;
            }
        }
        Ok(match self.format {
            Format::Text => text::mission(&name, &recording.results),
            Format::Json => lines,
        })
    }
}
