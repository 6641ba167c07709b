//! What samples recorded elsewhere determine, by any means: a line.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, Result};
use geojson::GeometryValue;
use nalgebra::Point2;
use planner_core::{Line, Sample};
use serde::Serialize;
use serde_json::json;

use crate::mission::read_out::LEVEL;
use crate::mission::results::{CredibleRecord, EstimateRecords, LineRecord};
use crate::output::file;
use crate::replay::answer::{Answer, Trust};
use crate::replay::fit_record::FitRecord;
use crate::replay::fit_words::Words;
use crate::replay::rows::{Layout, Skipped};
use crate::replay::sample_file::SampleFile;
use crate::replay::{MOST_NAMED, Report};
use crate::report::ground::{AGREED, CERTAIN, Ground};
use crate::report::look::{self, DISAGREES};
use crate::report::on_map::{collection, feature};
use crate::report::picture::{Dot, Drawn, Picture, area_around};
use crate::report::style::ESTIMATE;
use crate::report::text;
use crate::world::frame::Frame;
use crate::world::polygon::Polygon;

/// Samples that a figure shows beside those that bound the line.
const MOST_OTHERS: usize = 2_000;

/// Samples from a file and what they determine.
pub struct Replay {
    file: SampleFile,
    pub(crate) answer: Answer,
}

/// What samples determine.
#[derive(Serialize)]
struct SamplesRecord<'a> {
    samples: usize,
    skipped: &'a Skipped,
    #[serde(skip_serializing_if = "Option::is_none")]
    matter: Option<usize>,
    slope_arcs: &'a [[f64; 2]],
    intercept: Option<[f64; 2]>,
    estimates: EstimateRecords,
    #[serde(flatten)]
    frame: &'a Frame,
    #[serde(skip_serializing_if = "Option::is_none")]
    in_file: Option<EstimateRecords<LineInFile>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(flatten)]
    doubt: Option<DoubtRecord>,
    /// Whether a straight line explains the labels.
    fit: FitRecord,
}

/// A line in a file's own coordinates.
#[derive(Serialize)]
struct LineInFile {
    /// Of metres; a vertical line has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    slope: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    intercept: Option<f64>,
    /// Where it crosses the border of the ground around the samples.
    ends: Option<[[f64; 2]; 2]>,
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

    /// Where a line crosses the border of the ground around the samples, from left to right as one looks from its +1
    /// side.
    fn ends(&self, line: &Line) -> Option<[Point2<f64>; 2]> {
        Polygon::from(area_around(&self.file.samples)?).chord(line)
    }

    /// A line in the file's coordinates, if these are not the planner's.
    fn in_file(&self, line: &Line) -> Option<LineInFile> {
        let frame = &self.file.frame;
        frame.origin?;
        let own = frame.line(line.coefficients());
        Some(LineInFile {
            slope: own.and_then(|own| own.slope()),
            intercept: own.and_then(|own| own.intercept()),
            ends: self.ends(line).map(|ends| ends.map(|at| frame.recorded(at))),
        })
    }

    fn estimates(&self) -> EstimateRecords<Line> {
        let &Answer { bisector, centre, maximum_margin, .. } = &self.answer;
        EstimateRecords { bisector, centre, maximum_margin }
    }

    /// The lines to report, the recommended one first.
    fn named(&self) -> Vec<(&'static str, Option<Line>)> {
        let EstimateRecords { bisector, centre, maximum_margin } = self.estimates();
        let [mean, margin, printed] = text::NAMES;
        match (&self.answer.doubt, self.answer.tolerance) {
            (Some(doubt), _) => {
                vec![("posterior mean", centre), ("most likely line", Some(doubt.most_likely))]
            }
            (None, Some(_)) => {
                vec![("centre of the lines left", centre), (margin, maximum_margin)]
            }
            (None, None) => vec![(mean, centre), (margin, maximum_margin), (printed, bisector)],
        }
    }

    /// How often labels are true, where they may be wrong.
    fn p(&self) -> Option<f64> {
        self.answer.doubt.as_ref().map(|doubt| doubt.p)
    }

    /// The verdict on the fit, and what to do.
    fn verdict(&self) -> Words {
        Words::of(&self.file, &self.answer.fit, self.p())
    }

    fn headline(&self) -> String {
        let (count, bounding) = (self.file.samples.len(), self.answer.bounding.len());
        let off = self.answer.tolerance;
        if let Some(p) = self.p() {
            let within = off.map_or(String::new(), |it| format!(", each position within {it} m"));
            return format!("{count} samples, each label true with probability {p}{within}");
        }
        let within = off.map(|it| format!(" with each within {it} m of where it is said to be"));
        let within = within.unwrap_or_default();
        format!("{count} samples, separable by a line{within}; {bounding} of them bound it")
    }

    fn doubt_in_words(&self) -> Option<String> {
        let doubt = self.answer.doubt.as_ref()?;
        let unit = self.file.unit.name();
        let lines = doubt.disagreeing.iter().take(MOST_NAMED);
        let lines: Vec<_> = lines.map(|it| self.file.line(*it).to_string()).collect();
        let more = if doubt.disagreeing.len() > lines.len() { " and others" } else { "" };
        let are = format!(": {unit}s {}{more}", lines.join(", "));
        let are = if lines.is_empty() { "" } else { &are };
        Some(format!(
            "\nOf all lines through the ground around the samples the 90 % set holds {:.3};\n\
             what was left out of account weighs {:.6} at most.\n\
             Disagree with the most likely line: {} of {} samples{are}.\n",
            doubt.probability,
            doubt.pruned_mass,
            doubt.disagreeing.len(),
            self.file.samples.len()
        ))
    }
}

impl Report for Replay {
    fn words(&self) -> String {
        let mut text = self.file.beginning(&self.headline()) + "\n";
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
        text.extend(self.doubt_in_words());
        let Words { says, advice } = self.verdict();
        let end = if advice.is_empty() { "" } else { "\n" };
        text + &format!("\n{says}\n{advice}{end}")
    }

    fn json(&self) -> String {
        let Answer { bounding, slope_arcs, intercept, tolerance, doubt, fit, .. } = &self.answer;
        let frame = &self.file.frame;
        let of_doubt = doubt.as_ref().map(|doubt| DoubtRecord {
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
                disagreeing: doubt.disagreeing.iter().map(|it| self.file.line(*it)).collect(),
            },
        });
        let in_file = || self.estimates().and_then(|line| self.in_file(&line));
        file::json(&SamplesRecord {
            samples: self.file.samples.len(),
            skipped: &self.file.rows.skipped,
            matter: doubt.is_none().then_some(bounding.len()),
            slope_arcs,
            intercept: *intercept,
            estimates: self.estimates().and_then(|line| Some(line.into())),
            frame,
            in_file: frame.origin.map(|_| in_file()),
            tolerance: *tolerance,
            doubt: of_doubt,
            fit: FitRecord::of(&self.file, fit, self.p()),
        })
    }

    /// Of very many samples it shows all that bound the line, and some of the others.
    fn figure(&self) -> Result<String> {
        let samples = &self.file.samples;
        let area = area_around(samples).context("no area around the samples")?;
        let Answer { bounding, doubt, .. } = &self.answer;
        let read = |s: &Sample| Dot::new(s.site, look::read(s.label));
        let mut dots: Vec<_> = samples.iter().map(read).collect();
        for &index in doubt.iter().flat_map(|doubt| &doubt.disagreeing) {
            dots[index].ring = Some(DISAGREES);
        }
        let (count, bound) = (samples.len(), bounding.len());
        let is_sparse = count - bound > MOST_OTHERS;
        let every = if is_sparse { count.div_ceil(MOST_OTHERS) } else { 1 };
        if is_sparse {
            dots = dots.into_iter().step_by(every).chain(bounding.iter().map(read)).collect();
        }
        let mut note = match (is_sparse, doubt) {
            (false, None) => String::new(),
            (true, None) => {
                format!("shown: one in {every} of {count} samples, all {bound} that bound the line")
            }
            (false, Some(_)) => "set: the 90 % credible set of lines".to_owned(),
            (true, Some(_)) => format!("one in {every} of {count}; set: the 90 % credible set"),
        };
        let fit = &self.answer.fit;
        if fit.is_bad() && !note.is_empty() {
            note = format!("{note}; verdict: {}", fit.verdict());
        }
        let (name, line) = self.named()[0];
        let estimate =
            |line| Drawn::across(&area.into(), line, ESTIMATE, format!("estimate: {name}"));
        let picture = Picture {
            ground: Ground::Labelled(self.answer.ground(area)),
            says: if doubt.is_some() { AGREED } else { CERTAIN },
            samples: dots,
            lines: line.map(estimate).into_iter().collect(),
            ..Picture::bare(&self.file.name, note, area)
        };
        Ok(picture.svg())
    }

    /// Samples, lines, and the ground to which all lines left give one label. Where labels may be wrong, these are the
    /// lines of the credible set.
    fn geojson(&self) -> Result<String> {
        let area = self.file.area_on_globe()?;
        let (frame, doubt) = (&self.file.frame, self.answer.doubt.as_ref());
        let mut features = Vec::new();
        for (polygon, label) in self.answer.ground(area).into_iter().zip([1, -1]) {
            if polygon.0.len() >= 3 {
                let level = doubt.map_or(1.0, |doubt| doubt.probability);
                let told = json!({ "kind": "ground", "label": label, "probability": level });
                features.push(feature(GeometryValue::new_polygon([frame.ring(&polygon.0)?]), told));
            }
        }
        let EstimateRecords { centre, maximum_margin, .. } = self.estimates();
        for (kind, line) in [
            ("centre", centre),
            ("maximum_margin", maximum_margin),
            ("most_likely", doubt.map(|doubt| doubt.most_likely)),
        ] {
            if let Some([from, to]) = line.and_then(|line| self.ends(&line)) {
                let ends = [frame.degrees(from)?, frame.degrees(to)?];
                let told = json!({ "kind": kind });
                features.push(feature(GeometryValue::new_line_string(ends), told));
            }
        }
        features.extend(self.file.points(doubt.map(|it| &*it.disagreeing))?);
        Ok(collection(features))
    }

    /// The verdict on the fit, if the line is not to be relied on.
    fn warning(&self) -> Option<String> {
        let Words { says, advice } = self.verdict();
        self.answer.fit.is_bad().then(|| format!("{says} {advice}"))
    }
}

impl LineInFile {
    fn in_words(self) -> String {
        let from_to = self.ends.map(|[[a, b], [c, d]]| format!("from ({a}, {b}) to ({c}, {d})"));
        let from_to = from_to.unwrap_or_default();
        match (self.slope, self.intercept) {
            (Some(slope), Some(intercept)) => format!("z = {slope} x {intercept:+}, {from_to}"),
            _ => from_to,
        }
    }
}
