//! What a verdict on a fit says, and what to do, in words.

use crate::fitting::explanation::{Explanation, Fault, Found};
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

/// How a verdict against all straight lines begins.
const NONE: &str = "No straight line explains these labels:";

impl Words {
    /// The verdict on a fit to the samples of a file, and what to do. `p` is what was said of the labels.
    pub(crate) fn of(file: &SampleFile, fit: &Explanation, p: Option<f64>) -> Self {
        let (says, advice) = match fit.found {
            None => of_line(fit, p),
            Some(found) => {
                let (what, advice) = of_found(file, fit.disagreeing, found);
                (format!("{NONE} {what}"), advice)
            }
        };
        Self { says, advice }
    }

    /// What explains labels that no line separates, if `fit` is that of the most likely line.
    pub(crate) fn explanation(file: &SampleFile, fit: &Explanation) -> String {
        let says = Self::of(file, fit, None).says;
        match fit.found {
            None => format!(
                "{} of {} labels disagree with the most likely line, as --p {} explains",
                fit.disagreeing,
                fit.labels,
                reliability(fit.suggested_p())
            ),
            Some(Found::Bend { radius, .. }) => {
                format!("{says} Map it with --front {}", rounded(radius))
            }
            Some(_) => says.trim_end_matches('.').to_owned(),
        }
    }
}

/// Of a straight line.
fn of_line(fit: &Explanation, p: Option<f64>) -> (String, String) {
    let Explanation { labels, disagreeing, expected: [low, high], .. } = *fit;
    let Some(p) = p else {
        let says = format!("A straight line fits: all {labels} labels agree with it.");
        return (says, String::new());
    };
    let suggested = reliability(fit.suggested_p());
    let counts = format!("{disagreeing} of {labels}, {low} to {high} expected");
    if disagreeing > high {
        let advice = if fit.suggested_p() < 0.6 {
            "The labels hardly depend on the side of any line. Check the column of the labels and the sensor."
                .to_owned()
        } else {
            format!(
                "Say --p {suggested}. If labels disagree near the line only, give a larger --tolerance instead."
            )
        };
        return (
            format!(
                "More labels disagree with the line than p = {p} explains: {counts}. The file suggests p = {suggested}."
            ),
            advice,
        );
    }
    if disagreeing < low {
        return (
            format!(
                "A straight line fits. Fewer labels disagree with it than p = {p} makes likely: {counts}. The file \
                 suggests p = {suggested}."
            ),
            format!("The result is safe, but its intervals are too wide. Try --p {suggested}."),
        );
    }
    let few = format!("Fewer than {FEW} labels show gross faults only.");
    (
        format!(
            "A straight line fits: {disagreeing} of {labels} labels disagree with it, {low} to {high} expected."
        ),
        if labels < FEW { few } else { String::new() },
    )
}

/// Of another boundary, or of a sensor at fault: what it is, and what to do. With the most likely line so many labels
/// disagree.
fn of_found(file: &SampleFile, disagree: usize, found: Found) -> (String, String) {
    let all = file.samples.len();
    let with = |count: usize| {
        format!("with {count} of {all} labels, the most likely line with {disagree}.")
    };
    match found {
        Found::Stretch { times, fault, counts: [count, against], p } => {
            let [first, last] = times.map(|row| file.line(row as usize));
            let rows = format!("({}s {first} to {last})", file.unit.name());
            let what = match fault {
                Fault::Coin | Fault::Inverted => {
                    format!(
                        "{against} of {count} labels in a row disagree with the best one {rows}."
                    )
                }
                Fault::Stuck(label) => format!(
                    "{count} labels in a row are almost all {}, on either side of the best one {rows}.",
                    if label { "+1" } else { "-1" }
                ),
            };
            let ask = match fault {
                Fault::Coin => "Was the sensor fouled there?",
                Fault::Inverted => "Was the sensor fouled there, or its label inverted?",
                Fault::Stuck(_) => "Was the sensor fouled or stuck there?",
            };
            let p = reliability(p);
            let advice =
                format!("{ask} Leave these rows out and replay the rest, which suggests p = {p}.");
            (what, advice)
        }
        Found::Bend { radius, sagitta, disagreeing } => (
            format!(
                "the boundary bends. An arc of radius {} m disagrees {}",
                rounded(radius),
                with(disagreeing)
            ),
            format!(
                "Map it with --front {}. For a straight line take a shorter stretch, or a tolerance that covers the bend. \
                 The arc is {} m from its chord.",
                rounded(radius),
                rounded(sagitta)
            ),
        ),
        Found::Drift { metres, disagreeing } => (
            format!(
                "the boundary moved. A line that moves {} m from the first row to the last disagrees {}",
                rounded(metres),
                with(disagreeing)
            ),
            "Take fewer rows at a time, or a tolerance that covers the motion.".to_owned(),
        ),
        Found::TwoBoundaries { disagreeing } => (
            format!(
                "there are two boundaries, or one with a corner. Two lines disagree {}",
                with(disagreeing)
            ),
            "Split the area so that each part has one straight boundary, and replay each part."
                .to_owned(),
        ),
    }
}
