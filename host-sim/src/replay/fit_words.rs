//! What a verdict on a fit says, and what to do, in words.

use crate::replay::fit::stretch::Fault;
use crate::replay::fit::{Fit, Run, Verdict};
use crate::replay::sample_file::SampleFile;

/// Fewer labels than this show gross faults alone.
const FEW: usize = 30;

/// A verdict in words.
pub(crate) struct Words {
    /// What is so.
    pub(crate) says: String,
    /// What to do; empty if there is nothing to do.
    pub(crate) advice: String,
}

/// A number with two digits that count.
fn rounded(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let digits = 1 - libm::log10(value.abs()).floor() as i32;
    if digits > 0 {
        format!("{value:.0$}", digits as usize)
    } else {
        let unit = libm::pow(10.0, f64::from(-digits));
        format!("{:.0}", (value / unit).round() * unit)
    }
}

/// A reliability, rounded so that it is below 1.
fn reliability(p: f64) -> String {
    if p < 0.99 { format!("{p:.2}") } else { format!("{:.4}", p.min(0.9999)) }
}

impl Words {
    /// The verdict on a fit to the samples of a file, and what to do. `p` is what was said of the labels.
    pub(crate) fn of(file: &SampleFile, fit: &Fit, p: Option<f64>) -> Self {
        let Fit { labels, disagreeing, expected: [low, high], suggested_p, .. } = *fit;
        let unit = file.unit.name();
        let rows = |ends: [usize; 2]| {
            let [first, last] = ends.map(|end| file.line(end));
            format!("{unit}s {first} to {last}")
        };
        let counts = format!("{disagreeing} of {labels} labels disagree with it");
        let none = "No straight line explains these labels:";
        let suggested = reliability(suggested_p);
        let told = p.map_or("1".to_owned(), |p| p.to_string());
        let best = format!("{disagreeing} with the most likely line");
        let (says, advice) = match fit.verdict {
            Verdict::Fits => {
                let says = match p {
                    Some(_) => {
                        format!("A straight line fits: {counts}, {low} to {high} expected.")
                    }
                    None => format!("A straight line fits: all {labels} labels agree with it."),
                };
                let few = format!("Fewer than {FEW} labels show gross faults only.");
                (says, if labels < FEW { few } else { String::new() })
            }
            Verdict::TooHigh => (
                format!(
                    "More labels disagree with the line than p = {told} explains: {disagreeing} of {labels}, {low} to \
                     {high} expected. The file suggests p = {suggested}."
                ),
                if suggested_p < 0.6 {
                    "The labels hardly depend on the side of any line. Check the column of the labels and the sensor."
                        .to_owned()
                } else {
                    format!(
                        "Say --p {suggested}. If labels disagree near the line only, give a larger --tolerance instead."
                    )
                },
            ),
            Verdict::TooLow => (
                format!(
                    "A straight line fits. Fewer labels disagree with it than p = {told} makes likely: {disagreeing} of \
                     {labels}, {low} to {high} expected. The file suggests p = {suggested}."
                ),
                format!("The result is safe, but its intervals are too wide. Try --p {suggested}."),
            ),
            Verdict::Row(Run { count, ends }) => (
                format!(
                    "{none} {count} labels in a row disagree with the best one ({}).",
                    rows(ends)
                ),
                "Was the sensor fouled there? Leave these rows out and replay the rest.".to_owned(),
            ),
            Verdict::Stretch { ends, fault, counts: [count, against], p } => {
                let rows = rows(ends);
                let what = match fault {
                    Fault::Coin | Fault::Inverted => {
                        format!(
                            "{against} of {count} labels in a row disagree with the best one ({rows})."
                        )
                    }
                    Fault::Stuck(label) => {
                        let label = if label { "+1" } else { "-1" };
                        format!(
                            "{count} labels in a row are almost all {label}, on either side of the best one ({rows})."
                        )
                    }
                };
                let ask = match fault {
                    Fault::Coin => "Was the sensor fouled there?",
                    Fault::Inverted => "Was the sensor fouled there, or its label inverted?",
                    Fault::Stuck(_) => "Was the sensor fouled or stuck there?",
                };
                (
                    format!("{none} {what}"),
                    format!(
                        "{ask} Leave these rows out and replay the rest, which suggests p = {}.",
                        reliability(p)
                    ),
                )
            }
            Verdict::Bend { radius, sagitta, disagreeing } => (
                format!(
                    "{none} the boundary bends. With an arc of radius {} m {disagreeing} of {} labels disagree, {best}.",
                    rounded(radius),
                    file.samples.len()
                ),
                format!(
                    "Take a shorter stretch, or a tolerance that covers the bend. The arc is {} m from its chord.",
                    rounded(sagitta)
                ),
            ),
            Verdict::Drift { metres, disagreeing } => (
                format!(
                    "{none} the boundary moved. With a line that moves {} m from the first row to the last, {disagreeing} of \
                     {} labels disagree, {best}.",
                    rounded(metres),
                    file.samples.len()
                ),
                "Take fewer rows at a time, or a tolerance that covers the motion.".to_owned(),
            ),
            Verdict::TwoLines { disagreeing } => (
                format!(
                    "{none} there are two boundaries, or one with a corner. With two lines {disagreeing} of {} labels \
                     disagree, {best}.",
                    file.samples.len()
                ),
                "Split the area so that each part has one straight boundary, and replay each part."
                    .to_owned(),
            ),
        };
        Self { says, advice }
    }

    /// What explains labels that no line separates, if `fit` is that of the most likely line.
    pub(crate) fn explanation(file: &SampleFile, fit: &Fit) -> String {
        match fit.verdict {
            Verdict::Fits | Verdict::TooHigh | Verdict::TooLow => format!(
                "{} of {} labels disagree with the most likely line, as --p {} explains",
                fit.disagreeing,
                fit.labels,
                reliability(fit.suggested_p)
            ),
            _ => Self::of(file, fit, None).says.trim_end_matches('.').to_owned(),
        }
    }
}
