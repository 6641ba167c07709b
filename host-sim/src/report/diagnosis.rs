//! Why no straight, still line explains the labels of a mission, and what to do, in words.

use crate::fitting::explanation::Cause;
use crate::mission::diagnosis::{DiagnosisRecord, RefutingRecord};

/// A cause is named beside others from this share on.
const NAMED: f64 = 0.1;

/// Steps that are listed at most.
const LISTED: usize = 8;

/// The headings of what is said.
pub(crate) const HEADINGS: [&str; 4] = ["Seen", "Best line", "Explanation", "To do"];

/// What is said, each sentence with its heading. `line` is the best line in words.
pub(crate) fn told(record: &DiagnosisRecord, line: &str) -> Vec<(&'static str, String)> {
    let rest = [best_line(record, line), explanation(record), advice(record)].map(Some);
    let all = [record.refuting.as_ref().map(seen)].into_iter().chain(rest);
    HEADINGS.into_iter().zip(all).filter_map(|(of, words)| Some((of, words?))).collect()
}

fn seen(&RefutingRecord { step, x, z, label, expected }: &RefutingRecord) -> String {
    format!(
        "step {step} read {label:+} at ({x:.3}, {z:.3}), where all lines left have {expected:+}."
    )
}

fn best_line(record: &DiagnosisRecord, line: &str) -> String {
    let DiagnosisRecord { labels, disagreeing, share, steps, .. } = record;
    let line = line.split_whitespace().collect::<Vec<_>>().join(" ");
    let percent = 100.0 * share;
    let verb = if *disagreeing == 1 { "disagrees" } else { "disagree" };
    let listed: Vec<_> = steps.iter().take(LISTED).map(ToString::to_string).collect();
    let more = if steps.len() > LISTED { ", ..." } else { "" };
    let which = match steps.len() {
        0 if *disagreeing > 0 => ": given samples".to_owned(),
        0 => String::new(),
        1 => format!(": step {}", listed[0]),
        _ => format!(": steps {}{more}", listed.join(", ")),
    };
    format!("{line}. {disagreeing} of {labels} labels {verb} with it ({percent:.1} %){which}.")
}

/// A cause in words, and what to do.
fn words(cause: Cause) -> [&'static str; 2] {
    const SENSOR: &str = "check the sensor at a place of either label, and fly again";
    match cause {
        Cause::Line => [
            "a straight, still line",
            "fly again. While a line is true, 1 mission in 20 has a warning and 1 in 100 an alarm",
        ],
        Cause::Bend => {
            ["the boundary bends", "take a shorter stretch (half of it bends a quarter as much)"]
        }
        Cause::Drift => ["the boundary moves", "take less time"],
        Cause::TwoBoundaries => [
            "there are two boundaries, or one with a corner",
            "split the area so that each part has one straight boundary",
        ],
        Cause::Stuck => ["the sensor is stuck on a label", SENSOR],
        Cause::Inverted => ["the sensor reads the other label", SENSOR],
        Cause::StuckOrInverted => [
            "the sensor is stuck on a label, or reads the other one (both read the same here)",
            SENSOR,
        ],
        Cause::Late => [
            "labels come some samples late",
            "let the sensor settle before it reads, or check its clock",
        ],
        Cause::Random => [
            "labels are wrong at random",
            "check the sensor. If some labels are wrong, say how often they are right: noise = { p = 0.9 }",
        ],
        Cause::Unclear => ["the labels cannot tell", "check the sensor, take a shorter stretch"],
    }
}

fn explanation(record: &DiagnosisRecord) -> String {
    // The causes that are worth a word, the likeliest first.
    let mut likely: Vec<_> = record.shares.iter().filter(|(_, share)| **share >= NAMED).collect();
    likely.sort_by(|p, q| q.1.total_cmp(p.1));
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    if record.cause == Cause::Unclear {
        let each = likely
            .iter()
            .map(|(cause, share)| format!("{} ({})", words(**cause)[0], percent(**share)));
        let each: Vec<_> = each.collect();
        return match each.split_last() {
            None => "the labels cannot tell.".to_owned(),
            Some((last, [])) => format!("the labels cannot tell. Most likely {last}."),
            Some((last, before)) => {
                format!("the labels cannot tell. Perhaps {}, or {last}.", before.join(", "))
            }
        };
    }
    let of = |cause| record.shares.get(&cause).copied().unwrap_or_default();
    let share = match record.cause {
        Cause::StuckOrInverted => of(Cause::Stuck) + of(Cause::Inverted),
        cause => of(cause),
    };
    let share = if record.shares.is_empty() {
        String::new()
    } else {
        format!(", with a probability of {}", percent(share))
    };
    format!("{}{share}.", words(record.cause)[0])
}

/// What to do.
fn advice(record: &DiagnosisRecord) -> String {
    let [_, what] = words(record.cause);
    match record.tolerance {
        Some(metres) if matches!(record.cause, Cause::Bend | Cause::Drift | Cause::Unclear) => {
            format!(
                "{what}, or a tolerance of {metres} m, which covers a bend or a drift as these labels have it."
            )
        }
        _ => format!("{what}."),
    }
}
