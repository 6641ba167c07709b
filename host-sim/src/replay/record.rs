//! What samples recorded elsewhere determine, by any means; as a record.

use std::path::Path;

use anyhow::Result;
use nalgebra::Point2;
use planner_core::Line;
use serde::Serialize;

use crate::mission::read_out::LEVEL;
use crate::mission::results::{CredibleRecord, EstimateRecords, LineRecord};
use crate::replay::answer::{Answer, Trust};
use crate::replay::fit_record::FitRecord;
use crate::replay::rows::{Layout, Skipped};
use crate::replay::sample_file::SampleFile;
use crate::report::picture::area_around;
use crate::world::polygon::Polygon;

/// Samples from a file and what they determine.
pub struct Replay {
    pub(crate) file: SampleFile,
    pub(crate) answer: Answer,
}

/// What samples determine.
#[derive(Serialize)]
pub struct Record {
    samples: usize,
    skipped: SkippedRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    matter: Option<usize>,
    slope_arcs: Vec<[f64; 2]>,
    intercept: Option<[f64; 2]>,
    estimates: EstimateRecords,
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    crs: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    in_file: Option<EstimateRecords<LineInFile>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(flatten)]
    doubt: Option<DoubtRecord>,
    /// Whether a straight line explains the labels.
    fit: FitRecord,
}

/// Rows that lack a value.
#[derive(Serialize)]
pub(crate) struct SkippedRecord {
    rows: usize,
    /// The line of the first, or its feature.
    #[serde(skip_serializing_if = "Option::is_none")]
    first: Option<usize>,
}

impl From<&Skipped> for SkippedRecord {
    fn from(skipped: &Skipped) -> Self {
        Self { rows: skipped.count, first: skipped.first.as_ref().map(|first| first.0) }
    }
}

/// A line in a file's own coordinates.
#[derive(Clone, Copy, Serialize)]
pub(crate) struct LineInFile {
    /// Of metres; a vertical line has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intercept: Option<f64>,
    /// Where it crosses the border of the ground around the samples.
    pub ends: Option<[[f64; 2]; 2]>,
}

/// What labels that may be wrong determine.
#[derive(Serialize)]
struct DoubtRecord {
    p: f64,
    pruned_mass: f64,
    /// The smallest set of lines that has the level; lines that are equally likely are in it together.
    credible: CredibleRecord,
    most_likely: MostLikelyRecord,
}

/// The most likely line.
#[derive(Serialize)]
struct MostLikelyRecord {
    #[serde(flatten)]
    line: LineRecord,
    /// The lines of the file that disagree with it.
    disagreeing: Vec<usize>,
}

impl Replay {
    /// Reads a file of any length and finds what its samples determine, as far as they are trusted.
    ///
    /// # Errors
    /// Names the file and the line, what was found and what was expected; for samples that no line
    /// separates, the first line of which that is true.
    pub fn read(path: &Path, layout: &Layout, trust: Trust) -> Result<Self> {
        Self::of(SampleFile::read(path, layout)?, trust)
    }

    /// As [`read`](Self::read), from the text of the file called `name`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(name: &str, text: &[u8], layout: &Layout, trust: Trust) -> Result<Self> {
        Self::of(SampleFile::parse(name, text, layout)?, trust)
    }

    fn of(file: SampleFile, trust: Trust) -> Result<Self> {
        let answer = Answer::of(&file, trust)?;
        Ok(Self { file, answer })
    }

    /// A line in the file's coordinates, if these are not the planner's.
    pub(crate) fn in_file(&self, line: &Line) -> Option<LineInFile> {
        let frame = &self.file.frame;
        frame.origin()?;
        let own = frame.line(line.coefficients());
        Some(LineInFile {
            slope: own.and_then(|own| own.slope()),
            intercept: own.and_then(|own| own.intercept()),
            ends: self.ends(line).map(|ends| ends.map(|at| frame.recorded(at))),
        })
    }

    /// Where a line crosses the border of the ground around the samples, from left to right as one looks from its +1
    /// side.
    pub(crate) fn ends(&self, line: &Line) -> Option<[Point2<f64>; 2]> {
        Polygon::from(area_around(&self.file.samples)?).chord(line)
    }

    /// What the samples determine, as a record.
    pub fn record(&self) -> Record {
        let Answer { bounding, slope_arcs, intercept, tolerance, doubt, .. } = &self.answer;
        let estimates = EstimateRecords {
            bisector: self.answer.bisector.map(Into::into),
            centre: self.answer.centre.map(Into::into),
            maximum_margin: self.answer.maximum_margin.map(Into::into),
        };
        let in_file = |line: Option<Line>| line.and_then(|line| self.in_file(&line));
        let lines_of_file =
            |indices: &[usize]| indices.iter().map(|it| self.file.line(*it)).collect();
        Record {
            samples: self.file.samples.len(),
            skipped: (&self.file.skipped).into(),
            matter: doubt.is_none().then_some(bounding.len()),
            slope_arcs: slope_arcs.clone(),
            intercept: *intercept,
            estimates,
            origin: self.file.frame.origin(),
            crs: self.file.frame.crs().map(ToString::to_string),
            in_file: self.file.frame.origin().map(|_| EstimateRecords {
                bisector: in_file(self.answer.bisector),
                centre: in_file(self.answer.centre),
                maximum_margin: in_file(self.answer.maximum_margin),
            }),
            tolerance: *tolerance,
            fit: FitRecord::of(&self.file, &self.answer.fit, doubt.as_ref().map(|doubt| doubt.p)),
            doubt: doubt.as_ref().map(|doubt| DoubtRecord {
                p: doubt.p,
                pruned_mass: doubt.pruned_mass,
                credible: CredibleRecord {
                    level: LEVEL,
                    slope_arcs: slope_arcs.clone(),
                    intercept: *intercept,
                    probability: doubt.probability,
                    ..CredibleRecord::default()
                },
                most_likely: MostLikelyRecord {
                    line: doubt.most_likely.into(),
                    disagreeing: lines_of_file(&doubt.disagreeing),
                },
            }),
        }
    }
}
