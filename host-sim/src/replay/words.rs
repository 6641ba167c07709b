//! What recorded samples determine, in words.

use std::fmt::Write as _;

use planner_core::Line;

use crate::replay::answer::{Answer, Doubted};
use crate::replay::fit_words::Words;
use crate::replay::record::{LineInFile, Replay};
use crate::replay::rows::Skipped;
use crate::replay::sample_file::SampleFile;
use crate::report::text;

/// Lines of a file that are named in words; the record has all.
const MOST_NAMED: usize = 20;

impl Replay {
    /// What the samples determine, in words.
    pub fn report(&self) -> String {
        let skipped = self.file.skipped_in_words() + &self.file.odd_in_words();
        let about = self.file.about();
        let mut text = format!("{}: {}.\n{skipped}{about}\n", self.file.name, self.headline());
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
        text += &self.verdict_in_words();
        text
    }

    /// What the file is called.
    pub fn name(&self) -> &str {
        &self.file.name
    }

    /// The verdict on the fit, if the line is not to be relied on.
    pub fn warning(&self) -> Option<String> {
        let Words { says, advice } = self.verdict();
        self.answer.fit.verdict.is_bad().then(|| format!("{says} {advice}"))
    }

    fn verdict(&self) -> Words {
        let p = self.answer.doubt.as_ref().map(|doubt| doubt.p);
        Words::of(&self.file, &self.answer.fit, p)
    }

    /// The verdict, and what to do, a line each.
    fn verdict_in_words(&self) -> String {
        let Words { says, advice } = self.verdict();
        let advice = if advice.is_empty() { advice } else { advice + "\n" };
        format!("\n{says}\n{advice}")
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

    /// The lines to report, the recommended one first.
    pub(crate) fn named(&self) -> Vec<(&'static str, Option<Line>)> {
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
        let where_they_are = if count == 0 {
            String::new()
        } else {
            format!(": {}s {}{more}", self.file.unit.name(), lines.join(", "))
        };
        let _ = writeln!(
            text,
            "Disagree with the most likely line: {count} of {} samples{where_they_are}.",
            self.file.samples.len()
        );
        text
    }
}

impl SampleFile {
    /// Rows that are no samples, in words: a line, if there are any.
    pub(crate) fn skipped_in_words(&self) -> String {
        let (Skipped { count, first }, unit) = (&self.skipped, self.unit);
        let Some((line, lacks)) = first else { return String::new() };
        let (row, name) = (unit.row(), unit.name());
        let s = if *count == 1 { "" } else { "s" };
        format!("Skipped {count} {row}{s} without a value, the first on {name} {line} ({lacks}).\n")
    }

    /// A value far outside all others, and rows out of the order of their times, in words: a line each, if there are such.
    pub(crate) fn odd_in_words(&self) -> String {
        let name = self.unit.name();
        let odd = self.odd.map(|(line, value, [least, most])| {
            format!(
                "On {name} {line} stands {value}, all other values are from {least} to {most}: leave such rows out if that is no value.\n"
            )
        });
        let backwards = self.backwards.map(|(count, line)| {
            let rows = if count == 1 { "row is" } else { "rows are" };
            format!(
                "{count} {rows} of an earlier time than the row before, the first on {name} {line}: rows count in the order of \
                 the file. Sort them by time if it matters.\n"
            )
        });
        odd.unwrap_or_default() + &backwards.unwrap_or_default()
    }

    /// The origin of positions, in words: a line, if there is one.
    pub(crate) fn about(&self) -> String {
        match self.frame.origin() {
            None => String::new(),
            Some([lat, lon]) if self.frame.is_geographic() => format!(
                "Metres to the east (x) and the north (z) of latitude {lat}, longitude {lon}.\n"
            ),
            Some([x, z]) => {
                let of = self.frame.crs().map_or(String::new(), |crs| format!(" of {crs}"));
                format!("Metres{of} about the origin ({x}, {z}).\n")
            }
        }
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
