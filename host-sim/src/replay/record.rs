//! What samples determine that were recorded elsewhere, by any means.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, Result, anyhow};
use planner_core::belief::estimate::Estimates;
use planner_core::belief::sample::Sample;
use planner_core::belief::version_space::NoVersionSpace;
use planner_core::geometry::local_line::LocalLine;
use serde::Serialize;

use crate::mission::results::EstimateRecords;
use crate::replay::hull::in_order;
use crate::replay::sample_file::SampleFile;
use crate::replay::separation::Separation;
use crate::replay::shortest_pairs::bisector;
use crate::report::picture::{Dot, Ground, Named, Picture, area_around};
use crate::report::text;

/// Samples that a figure shows beside those that bound the line.
const MOST_OTHERS: usize = 2_000;

/// Samples from a file and what they determine.
pub struct Replay {
    name: String,
    samples: Vec<Sample>,
    lines: Separation,
    /// The centre, for the figure.
    centre: Option<LocalLine>,
    estimates: EstimateRecords,
}

/// What samples determine.
#[derive(Serialize)]
pub struct Record {
    samples: usize,
    matter: usize,
    slope_arcs: Vec<[f64; 2]>,
    intercept: Option<[f64; 2]>,
    estimates: EstimateRecords,
}

impl Replay {
    /// Reads a CSV file with the columns `x`, `z` and `label`, in any order, others beside them,
    /// of any length.
    ///
    /// # Errors
    /// Names the file and the line, what was found and what was expected; for samples that no line
    /// separates, the first line of which that is true.
    pub fn read(path: &Path) -> Result<Self> {
        Self::of(SampleFile::read(path)?)
    }

    /// As [`read`](Self::read), from the text of the file called `name`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(name: &str, text: &[u8]) -> Result<Self> {
        Self::of(SampleFile::parse(name, text)?)
    }

    fn of(recorded: SampleFile) -> Result<Self> {
        let rows = in_order(&recorded.samples);
        let lines = Separation::of(&recorded.samples, &rows).map_err(|why| match why {
            NoVersionSpace::NotSeparable(index) => anyhow!(
                "{}: no line separates this sample from those above it by their labels",
                recorded.place(index)
            ),
            why => anyhow!(
                "{}: {why}; expected samples of both labels, not all on one line",
                recorded.name
            ),
        })?;
        let estimates = Estimates {
            bisector: bisector(&rows),
            centre: lines.centre(),
            maximum_margin: lines.maximum_margin(),
        };
        let centre = estimates.centre;
        let estimates = EstimateRecords::beside(estimates, |_| None);
        Ok(Self { name: recorded.name, samples: recorded.samples, lines, centre, estimates })
    }

    /// What the samples determine, in words.
    pub fn report(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{}: {} samples, separable by a line; {} of them bound it.\n\n\
             {:<28} {}\n{:<28} {}",
            self.name,
            self.samples.len(),
            self.lines.support().len(),
            "slope between, deg",
            text::arcs(&self.lines.slope_arc().intervals_deg()),
            "intercept between, m",
            text::range(self.lines.intercepts()),
        );
        for (name, estimate) in text::named(text::NAMES, &self.estimates) {
            let _ =
                writeln!(text, "{name:<28} {}", estimate.map_or("none".into(), |l| text::line(&l)));
        }
        text
    }

    /// What the samples determine, as a record.
    pub fn record(&self) -> Record {
        Record {
            samples: self.samples.len(),
            matter: self.lines.support().len(),
            slope_arcs: self.lines.slope_arc().intervals_deg().to_vec(),
            intercept: self.lines.intercepts(),
            estimates: self.estimates,
        }
    }

    /// The samples and what they determine, as an SVG document. Of very many samples it shows all that bound
    /// the line, and some of the others.
    ///
    /// # Errors
    /// When it could not be drawn.
    pub fn figure(&self) -> Result<String> {
        let area = area_around(&self.samples).context("no area around the samples")?;
        let bounding: Vec<_> = self.lines.support().collect();
        let count = self.samples.len();
        let (shown, note) = if count - bounding.len() > MOST_OTHERS {
            let every = count.div_ceil(MOST_OTHERS);
            let some = self.samples.iter().step_by(every).copied();
            let note = format!(
                "shown: one in {every} of {count} samples, all {} that bound the line",
                bounding.len()
            );
            (some.chain(bounding.iter().copied()).collect(), Some(note))
        } else {
            (self.samples.clone(), None)
        };
        let centre = Named::estimate("centre of the version space", self.centre);
        let dot = |s: &Sample| Dot { at: s.site.into(), label: s.label, wrong: false };
        let svg = Picture {
            title: self.name.clone(),
            note,
            area: area.into(),
            ground: Ground::certain(area.into(), &bounding),
            samples: shown.iter().map(dot).collect(),
            given: 0,
            path: None,
            truth: None,
            lines: centre.into_iter().collect(),
        }
        .svg();
        Ok(svg)
    }
}
