//! What samples determine that were recorded elsewhere, by any means: in words, as a record, as a figure.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, Result};
use nalgebra::Point2;
use planner_core::belief::sample::Sample;
use planner_core::geometry::line::Line;
use serde::Serialize;

use crate::mission::read_out::LEVEL;
use crate::mission::results::{EstimateRecords, LineRecord};
use crate::replay::answer::{Answer, Doubted, Trust};
use crate::replay::rows::Layout;
use crate::replay::sample_file::SampleFile;
use crate::report::picture::{Dot, Ground, Kind, Named, Picture, area_around};
use crate::report::text;
use crate::world::polygon::Polygon;

/// Samples that a figure shows beside those that bound the line.
const MOST_OTHERS: usize = 2_000;

/// Lines of a file that are named in words; the record has all.
const MOST_NAMED: usize = 20;

/// Samples from a file and what they determine.
pub struct Replay {
    pub(crate) file: SampleFile,
    pub(crate) answer: Answer,
}

/// What samples determine.
#[derive(Serialize)]
pub struct Record {
    samples: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    matter: Option<usize>,
    slope_arcs: Vec<[f64; 2]>,
    intercept: Option<[f64; 2]>,
    estimates: EstimateRecords,
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    in_file: Option<EstimatesInFile>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(flatten)]
    doubt: Option<DoubtRecord>,
}

/// The estimates where the file has them.
#[derive(Serialize)]
struct EstimatesInFile {
    bisector: Option<LineInFile>,
    centre: Option<LineInFile>,
    maximum_margin: Option<LineInFile>,
}

/// A line in a file's own coordinates.
#[derive(Clone, Copy, Serialize)]
struct LineInFile {
    /// Of metres; a vertical line has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    slope: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    intercept: Option<f64>,
    /// Where it crosses the border of the ground around the samples.
    ends: Option<[[f64; 2]; 2]>,
}

/// What labels that may be wrong come to.
#[derive(Serialize)]
struct DoubtRecord {
    p: f64,
    pruned_mass: f64,
    credible: CredibleRecord,
    most_likely: MostLikelyRecord,
}

/// The smallest set of lines that holds a probability; lines that are equally likely are in it together.
#[derive(Serialize)]
struct CredibleRecord {
    level: f64,
    slope_arcs: Vec<[f64; 2]>,
    intercept: Option<[f64; 2]>,
    /// What it holds.
    probability: f64,
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

    /// What the samples determine, in words.
    pub fn report(&self) -> String {
        let mut text = format!("{}: {}.\n{}\n", self.file.name, self.headline(), self.about());
        // Writing to a string cannot fail.
        let mut row = |name: &str, value: &str| {
            let _ = writeln!(text, "{name:<28} {value}");
        };
        let of_set = if self.answer.doubt.is_some() { " (90 %)" } else { "" };
        row(&format!("slope between, deg{of_set}"), &text::arcs(&self.answer.slope_arcs));
        row(&format!("intercept between, m{of_set}"), &text::range(self.answer.intercept));
        for (name, line) in self.named() {
            row(name, &line.map_or("none".into(), |line| text::line(&line.into())));
            if let Some(in_file) = line.and_then(|line| self.in_file(&line)) {
                row("  in the file's coordinates", &in_file.in_words());
            }
        }
        if let Some(doubt) = &self.answer.doubt {
            text += &self.doubt_in_words(doubt);
        }
        text
    }

    fn headline(&self) -> String {
        let Answer { bounding, tolerance, doubt, .. } = &self.answer;
        let (count, bounding) = (self.file.samples.len(), bounding.len());
        match (doubt, tolerance) {
            (None, None) => {
                format!("{count} samples, separable by a line; {bounding} of them bound it")
            }
            (None, Some(off)) => format!(
                "{count} samples, separable by a line with each within {off} m of where it is said to be; {bounding} of them bound it"
            ),
            (Some(Doubted { p, .. }), None) => {
                format!("{count} samples, each label true with probability {p}")
            }
            (Some(Doubted { p, .. }), Some(off)) => format!(
                "{count} samples, each label true with probability {p}, each position within {off} m"
            ),
        }
    }

    /// What positions are about.
    fn about(&self) -> String {
        match self.file.frame.origin() {
            None => String::new(),
            Some([lat, lon]) if self.file.frame.is_geographic() => format!(
                "Metres to the east (x) and the north (z) of latitude {lat}, longitude {lon}.\n"
            ),
            Some([x, z]) => format!("Metres about the origin ({x}, {z}).\n"),
        }
    }

    /// The lines to tell, the recommended one first.
    fn named(&self) -> Vec<(&'static str, Option<Line>)> {
        let Answer { centre, maximum_margin, bisector, tolerance, doubt, .. } = &self.answer;
        let [mean, margin, printed] = text::NAMES;
        match (doubt, tolerance) {
            (Some(doubt), _) => {
                vec![("posterior mean", *centre), ("most likely line", Some(doubt.most_likely))]
            }
            (None, Some(_)) => {
                vec![("centre of the lines left", *centre), (margin, *maximum_margin)]
            }
            (None, None) => {
                vec![(mean, *centre), (margin, *maximum_margin), (printed, *bisector)]
            }
        }
    }

    fn doubt_in_words(&self, doubt: &Doubted) -> String {
        let Doubted { pruned_mass, probability, disagreeing, .. } = doubt;
        let mut text = format!(
            "\nOf all lines through the ground around the samples the 90 % set holds {probability:.3};\n\
             what was left out of account weighs {pruned_mass:.6} at most.\n",
        );
        let count = disagreeing.len();
        let lines: Vec<_> = disagreeing
            .iter()
            .take(MOST_NAMED)
            .map(|index| self.file.line(*index).to_string())
            .collect();
        let more = if count > lines.len() { " and others" } else { "" };
        let where_they_are =
            if count == 0 { String::new() } else { format!(": lines {}{more}", lines.join(", ")) };
        let _ = writeln!(
            text,
            "Disagree with the most likely line: {count} of {} samples{where_they_are}.",
            self.file.samples.len()
        );
        text
    }

    /// A line in the file's coordinates, where these are others.
    fn in_file(&self, line: &Line) -> Option<LineInFile> {
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
        let on = Polygon::from(area_around(&self.file.samples)?).across(line);
        let [a, b, _] = line.coefficients();
        let along = |at: &Point2<f64>| b * at.x - a * at.y;
        let first = on.iter().min_by(|p, q| along(p).total_cmp(&along(q)))?;
        let last = on.iter().max_by(|p, q| along(p).total_cmp(&along(q)))?;
        Some([*first, *last])
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
            matter: doubt.is_none().then_some(bounding.len()),
            slope_arcs: slope_arcs.clone(),
            intercept: *intercept,
            estimates,
            origin: self.file.frame.origin(),
            in_file: self.file.frame.origin().map(|_| EstimatesInFile {
                bisector: in_file(self.answer.bisector),
                centre: in_file(self.answer.centre),
                maximum_margin: in_file(self.answer.maximum_margin),
            }),
            tolerance: *tolerance,
            doubt: doubt.as_ref().map(|doubt| DoubtRecord {
                p: doubt.p,
                pruned_mass: doubt.pruned_mass,
                credible: CredibleRecord {
                    level: LEVEL,
                    slope_arcs: slope_arcs.clone(),
                    intercept: *intercept,
                    probability: doubt.probability,
                },
                most_likely: MostLikelyRecord {
                    line: doubt.most_likely.into(),
                    disagreeing: lines_of_file(&doubt.disagreeing),
                },
            }),
        }
    }

    /// The samples and what they determine, as an SVG document. Of very many samples it shows all that bound
    /// the line, and some of the others.
    ///
    /// # Errors
    /// When it could not be drawn.
    pub fn figure(&self) -> Result<String> {
        let samples = &self.file.samples;
        let area = area_around(samples).context("no area around the samples")?;
        let Answer { bounding, doubt, .. } = &self.answer;
        let mut wrong = vec![false; samples.len()];
        for &index in doubt.iter().flat_map(|doubt| &doubt.disagreeing) {
            wrong[index] = true;
        }
        let count = samples.len();
        let every =
            if count - bounding.len() > MOST_OTHERS { count.div_ceil(MOST_OTHERS) } else { 1 };
        let dot = |s: &Sample, wrong| Dot { at: s.site.into(), label: s.label, wrong };
        let mut dots: Vec<_> =
            samples.iter().zip(wrong).step_by(every).map(|(s, wrong)| dot(s, wrong)).collect();
        if every > 1 {
            dots.extend(bounding.iter().map(|s| dot(s, false)));
        }
        let sparse = (every > 1).then(|| {
            let bounding = bounding.len();
            format!("shown: one in {every} of {count} samples, all {bounding} that bound the line")
        });
        let note = match (sparse, doubt) {
            (note, None) => note,
            (None, Some(_)) => Some(
                "by all lines of the 90 % credible set; ringed: disagrees with the line".to_owned(),
            ),
            (Some(_), Some(_)) => {
                Some(format!("one in {every} of {count}; by the 90 % credible set"))
            }
        };
        let (name, line) = self.named()[0];
        let centre = line.map(|line| Named {
            name: format!("estimate: {name}"),
            line,
            kind: Kind::Estimate,
            beside: None,
        });
        let svg = Picture {
            title: self.file.name.clone(),
            note,
            area: area.into(),
            ground: Ground::Certain(self.answer.ground(area)),
            samples: dots,
            given: 0,
            path: None,
            truth: None,
            lines: centre.into_iter().collect(),
        }
        .svg();
        Ok(svg)
    }
}

impl LineInFile {
    fn in_words(self) -> String {
        let from_to = self.ends.map(|[[a, b], [c, d]]| format!("from ({a}, {b}) to ({c}, {d})"));
        let from_to = from_to.unwrap_or_default();
        match (self.slope, self.intercept) {
            (Some(slope), Some(intercept)) => {
                format!("z = {slope} x {intercept:+}, {from_to}")
            }
            _ => from_to,
        }
    }
}
