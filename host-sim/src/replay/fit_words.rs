//! What a verdict on a fit says, and what to do, in words.

use crate::fitting::fit::Fault;
use crate::fitting::fit::{Fit, Run, Verdict};
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
    pub(crate) fn of(file: &SampleFile, fit: &Fit, p: Option<f64>) -> Self {
        let (says, advice) = match fit.verdict {
            Verdict::Fits | Verdict::TooHigh | Verdict::TooLow => of_line(fit, p),
            Verdict::Row(_) | Verdict::Stretch { .. } => of_rows(file, fit),
            Verdict::Bend { .. } | Verdict::Drift { .. } | Verdict::TwoLines { .. } => {
                of_shape(file, fit)
            }
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
            Verdict::Bend { radius, .. } => {
                let says = Self::of(file, fit, None).says;
                format!("{says} Map it with --front {}", rounded(radius))
            }
            _ => Self::of(file, fit, None).says.trim_end_matches('.').to_owned(),
        }
    }
}

/// Of a straight line.
fn of_line(fit: &Fit, p: Option<f64>) -> (String, String) {
    let Fit { labels, disagreeing, expected: [low, high], suggested_p, .. } = *fit;
    let Some(p) = p else {
        let says = format!("A straight line fits: all {labels} labels agree with it.");
        return (says, String::new());
    };
    let suggested = reliability(suggested_p);
    let counts = format!("{disagreeing} of {labels}, {low} to {high} expected");
    match fit.verdict {
        Verdict::TooHigh => (
            format!(
                "More labels disagree with the line than p = {p} explains: {counts}. The file suggests p = {suggested}."
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
                "A straight line fits. Fewer labels disagree with it than p = {p} makes likely: {counts}. The file \
                 suggests p = {suggested}."
            ),
            format!("The result is safe, but its intervals are too wide. Try --p {suggested}."),
        ),
        _ => (
            format!(
                "A straight line fits: {disagreeing} of {labels} labels disagree with it, {low} to {high} expected."
            ),
            if labels < FEW {
                format!("Fewer than {FEW} labels show gross faults only.")
            } else {
                String::new()
            },
        ),
    }
}

/// Of rows that say something else.
fn of_rows(file: &SampleFile, fit: &Fit) -> (String, String) {
    let rows = |ends: [usize; 2]| {
        let [first, last] = ends.map(|end| file.line(end));
        format!("{}s {first} to {last}", file.unit.name())
    };
    match fit.verdict {
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
            let p = reliability(p);
            let advice =
                format!("{ask} Leave these rows out and replay the rest, which suggests p = {p}.");
            (format!("{NONE} {what}"), advice)
        }
        Verdict::Row(Run { count, ends }) => (
            format!("{NONE} {count} labels in a row disagree with the best one ({}).", rows(ends)),
            "Was the sensor fouled there? Leave these rows out and replay the rest.".to_owned(),
        ),
        _ => <(String, String)>::default(),
    }
}

/// Of another boundary than a straight, still line.
fn of_shape(file: &SampleFile, fit: &Fit) -> (String, String) {
    let all = file.samples.len();
    let with = |count: usize| {
        format!("with {count} of {all} labels, the most likely line with {}.", fit.disagreeing)
    };
    match fit.verdict {
        Verdict::Bend { radius, sagitta, disagreeing } => (
            format!(
                "{NONE} the boundary bends. An arc of radius {} m disagrees {}",
                rounded(radius),
                with(disagreeing)
            ),
            format!(
                "Map it with --front {}. For a straight line take a shorter stretch, or \
                 a tolerance that covers the bend. The arc is {} m from its chord.",
                rounded(radius),
                rounded(sagitta)
            ),
        ),
        Verdict::Drift { metres, disagreeing } => (
            format!(
                "{NONE} the boundary moved. A line that moves {} m from the first row to the last disagrees {}",
                rounded(metres),
                with(disagreeing)
            ),
            "Take fewer rows at a time, or a tolerance that covers the motion.".to_owned(),
        ),
        Verdict::TwoLines { disagreeing } => (
            format!(
                "{NONE} there are two boundaries, or one with a corner. Two lines disagree {}",
                with(disagreeing)
            ),
            "Split the area so that each part has one straight boundary, and replay each part."
                .to_owned(),
        ),
        _ => <(String, String)>::default(),
    }
}
