//! What samples determine that were recorded elsewhere, by any means.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, Result, anyhow, bail};
use nalgebra::Point2;
use planner_core::estimate::{self, Estimates};
use planner_core::lattice::{Site, orient};
use planner_core::sample::{Label, Sample};
use planner_core::version_space::{NoVersionSpace, Refused, VersionSpace};
use serde::Serialize;

use crate::figure::{Figure, Ground, Named, area_around};
use crate::mission::CAPACITY;
use crate::report;
use crate::trace::EstimateRecords;

/// Samples from a file and what they determine.
pub struct Replay {
    name: String,
    samples: Vec<Sample>,
    space: VersionSpace<CAPACITY>,
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
        let name = path.display().to_string();
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_path(path)
            .map_err(|error| anyhow!("{name}: expected a readable CSV file: {error}"))?;
        let header = reader.headers().map_err(|error| anyhow!("{name}:1: {error}"))?.clone();
        let column = |wanted: &str| {
            let title = |title: &str| title.trim_start_matches('\u{feff}') == wanted;
            header.iter().position(title).ok_or_else(|| {
                let titles = header.iter().collect::<Vec<_>>().join(",");
                anyhow!("{name}:1: found the header {titles:?}, expected x,z,label")
            })
        };
        let columns = [column("x")?, column("z")?, column("label")?];
        let mut samples = Vec::new();
        let mut reduced = Reduced { samples: Vec::new(), space: Err(NoVersionSpace::Collinear) };
        for row in reader.records() {
            let row = row.map_err(|error| anyhow!("{name}: {error}"))?;
            let line = row.position().map_or(0, csv::Position::line);
            let sample =
                sample(&row, columns).map_err(|error| anyhow!("{name}:{line}: {error}"))?;
            samples.push(sample);
            reduced.take(sample).map_err(|error| anyhow!("{name}:{line}: {error}"))?;
        }
        let space = reduced.space.map_err(|why| {
            anyhow!("{name}: {why}; expected samples of both labels, not all on one line")
        })?;
        Ok(Self { name, samples, space })
    }

    fn estimates(&self) -> Estimates {
        // The printed estimate looks at all samples, the others at those that still matter.
        Estimates { bisector: estimate::bisector(&self.samples), ..Estimates::of(&self.space) }
    }

    /// What the samples determine, in words.
    pub fn report(&self) -> String {
        let (space, estimates) = (&self.space, self.estimates());
        let mut text = String::new();
        let matter = space.support().count();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{}: {} samples, separable by a line; {matter} of them bound it.\n\n\
             {:<28} {}\n{:<28} {}",
            self.name,
            self.samples.len(),
            "slope between, deg",
            report::arcs(&space.slope_arc().intervals_deg()),
            "intercept between, m",
            report::range(space.intercepts()),
        );
        for (name, estimate) in report::named(report::NAMES, &estimates) {
            let _ = writeln!(
                text,
                "{name:<28} {}",
                estimate.map_or("none".into(), |l| report::line(&l))
            );
        }
        text
    }

    /// What the samples determine, as a record.
    pub fn record(&self) -> Record {
        Record {
            samples: self.samples.len(),
            matter: self.space.support().count(),
            slope_arcs: self.space.slope_arc().intervals_deg().to_vec(),
            intercept: self.space.intercepts(),
            estimates: self.estimates().into(),
        }
    }

    /// The samples and what they determine, as an SVG document.
    ///
    /// # Errors
    /// When it could not be drawn.
    pub fn figure(&self) -> Result<String> {
        let area = area_around(&self.samples).context("no area around the samples")?;
        Figure {
            title: self.name.clone(),
            area,
            ground: Ground::Certain(&self.space),
            samples: &self.samples,
            given: 0,
            path: None,
            truth: None,
            lines: Named::estimate(
                "centre of the version space",
                estimate::centre(self.space.candidates()),
            )
            .into_iter()
            .collect(),
        }
        .svg()
    }
}

/// The samples that still matter, all that many rows come to, and what they bound.
struct Reduced {
    samples: Vec<Sample>,
    space: Result<VersionSpace<CAPACITY>, NoVersionSpace>,
}

impl Reduced {
    fn take(&mut self, sample: Sample) -> Result<()> {
        const MIXED: &str = "no line separates this sample from those above it by their labels";
        if let Ok(space) = &mut self.space {
            match space.insert(sample) {
                Ok(_) => return Ok(()),
                Err(Refused::Contradiction(_)) => bail!(MIXED),
                // The samples that no longer matter follow from the others: drop them.
                Err(Refused::Full(_)) => self.samples = space.support().collect(),
            }
        }
        self.samples.push(sample);
        if self.samples.len() > CAPACITY {
            self.samples =
                [Label::Negative, Label::Positive].map(|l| hull(&self.samples, l)).concat();
        }
        self.space = VersionSpace::new(&self.samples);
        match self.space {
            Err(NoVersionSpace::NotSeparable(_)) => bail!(MIXED),
            Err(NoVersionSpace::TooMany) => bail!("more than {CAPACITY} samples bound the line"),
            _ => Ok(()),
        }
    }
}

/// The corners of the convex hull of the samples with a label (Andrew's monotone chain): which
/// lines separate them from others depends on no more.
fn hull(samples: &[Sample], label: Label) -> Vec<Sample> {
    let mut sites: Vec<_> = samples.iter().filter(|s| s.label == label).map(|s| s.site).collect();
    sites.sort_by_key(|site| (site.x(), site.z()));
    sites.dedup();
    let chain = |sites: &mut dyn Iterator<Item = Site>| {
        let mut chain: Vec<Site> = Vec::new();
        for q in sites {
            while let [.., a, b] = chain[..]
                && orient(a, b, q) <= 0
            {
                chain.pop();
            }
            chain.push(q);
        }
        chain
    };
    let mut corners = chain(&mut sites.iter().copied());
    corners.extend(chain(&mut sites.iter().rev().copied()));
    corners.dedup();
    corners.into_iter().map(|site| Sample { site, label }).collect()
}

fn sample(row: &csv::StringRecord, [x, z, label]: [usize; 3]) -> Result<Sample> {
    let number = |name: &str, column: usize| {
        let field = row.get(column).unwrap_or_default();
        let value = field.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| anyhow!("{name}: found {field:?}, expected a finite number"))
    };
    let (x, z) = (number("x", x)?, number("z", z)?);
    let site = Site::try_from(Point2::new(x, z)).map_err(|error| anyhow!("({x}, {z}): {error}"))?;
    let label = match number("label", label)? {
        1.0 => Label::Positive,
        -1.0 => Label::Negative,
        other => bail!("label: found {other}, expected -1 or 1"),
    };
    Ok(Sample { site, label })
}
