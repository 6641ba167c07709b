//! What a mission says when no straight, still line explains its labels: what was seen, the best line all the same, what
//! explains the labels, and the tolerance that would cover them.

use nalgebra::Point2;
use planner_core::belief::evidence::Suspect;
use planner_core::{Label, Line, Reading, Reliability, Sample, Step, StopReason};

use crate::fitting::explanation::{Cause, Explanation, Family, Told};
use crate::fitting::fewest::Fewest;
use crate::fitting::fit::{Fault, Fit, Question, Verdict};
use crate::mission::definition::Mission;
use crate::mission::diagnosis::{DiagnosisRecord, RefutingRecord, Shares};
use crate::mission::read_out::ReadOut;
use crate::mission::results::{AlarmRecord, Ending, StepResult};

/// With what probability a tolerance is to cover a bend or a drift.
const COVERING: f64 = 0.9;

/// A bend or a drift may be the cause if the two have this share.
const POSSIBLE: f64 = 0.1;

impl Shares {
    fn of(explanation: &Explanation) -> Self {
        let share = |family| (1e3 * explanation.share(family)).round() / 1e3;
        Self {
            line: share(Family::Line),
            bend: share(Family::Bend),
            drift: share(Family::Drift),
            stuck: share(Family::Stuck),
            inverted: share(Family::Inverted),
            late: share(Family::Late),
            random: share(Family::Random),
        }
    }
}

/// A label of a mission, and the step that read it.
#[derive(Clone, Copy)]
struct Taken {
    step: usize,
    sample: Sample,
    /// It lies in a trusted ball, where labels are certain.
    is_trusted: bool,
}

impl DiagnosisRecord {
    /// Of a mission that ended so, with this alarm, by which it may be refuted. `None` if nothing speaks against a straight, still line.
    pub fn of(
        mission: &Mission,
        (steps, results): (&[Step], &[StepResult]),
        (ending, alarm, is_by_alarm): (Ending, Option<&AlarmRecord>, bool),
        belief: &dyn ReadOut,
    ) -> Option<Self> {
        let is_refuted = ending == Ending::Stopped(StopReason::NoLine);
        if !is_refuted && alarm.is_none() {
            return None;
        }
        let given = mission.given.samples();
        let read = steps.iter().zip(results).flat_map(|(step, result)| {
            let taken = |site, reading| {
                let Reading::Side(label) = reading else { return None };
                let trusted = belief.hypotheses().map(|table| table.reliability(site));
                let is_trusted = trusted == Some(Reliability::CERTAIN);
                Some(Taken { step: result.step, sample: Sample { site, label }, is_trusted })
            };
            let passed = result.passed().filter_map(move |(site, reading)| taken(site, reading));
            passed.chain(step.reading.and_then(|reading| taken(step.pose.site, reading)))
        });
        let read: Vec<_> = read.collect();
        let all: Vec<_> = given
            .iter()
            .map(|it| (0, *it))
            .chain(read.iter().map(|it| (it.step, it.sample)))
            .collect();
        let samples: Vec<_> = all.iter().map(|(_, sample)| *sample).collect();
        let fewest = Fewest::of(&samples)?;
        let last = read.last().filter(|_| is_refuted && !is_by_alarm);
        let refuting = last.map(|Taken { step, sample, .. }| {
            let (at, label) = (Point2::<f64>::from(sample.site), sample.label);
            let (label, expected) = (label.sign(), (-label).sign());
            RefutingRecord { step: *step, x: at.x, z: at.y, label, expected }
        });
        let steps = fewest.disagreeing.iter().map(|k| all[*k].0).filter(|step| *step > 0);
        let near = belief.centre().map_or(fewest.line, Line::from);
        let (cause, shares, tolerance) = if mission.is_noisy() {
            let (cause, metres) = of_doubtful(mission, &read, &fewest.line, alarm);
            (cause, None, metres)
        } else {
            let explanation = of_true(mission, &read, &near);
            let shares = Shares::of(&explanation);
            let is_possible = shares.bend + shares.drift >= POSSIBLE;
            let covering = explanation.covering(COVERING).filter(|_| is_possible);
            (explanation.cause(), Some(shares), covering)
        };
        Some(Self {
            refuting,
            line: fewest.line.into(),
            labels: samples.len(),
            disagreeing: fewest.disagreeing.len(),
            share: fewest.disagreeing.len() as f64 / samples.len() as f64,
            steps: steps.collect(),
            cause,
            shares,
            tolerance: tolerance.filter(|metres| *metres > 0.0).map(rounded_up),
        })
    }
}

/// What explains labels that are said to be true.
fn of_true(mission: &Mission, read: &[Taken], near: &Line) -> Explanation {
    let read: Vec<_> = read.iter().map(|it| (it.sample, it.step as u32)).collect();
    let tolerance = mission.config.tolerance;
    Explanation::of(&Told { given: mission.given.samples(), read: &read, tolerance, near })
}

/// What explains labels that may be wrong, by the tests for recordings; else by what the evidence suspects. Also the
/// tolerance that covers a bend or a drift: half of its extent.
fn of_doubtful(
    mission: &Mission,
    read: &[Taken],
    line: &Line,
    alarm: Option<&AlarmRecord>,
) -> (Cause, Option<f64>) {
    let doubtful = read.iter().filter(|it| !it.is_trusted);
    let (at, is_positive): (Vec<_>, Vec<_>) = doubtful
        .map(|it| (Point2::<f64>::from(it.sample.site), it.sample.label == Label::Positive))
        .unzip();
    let p = mission.noise.map_or(1.0, |noise| noise.p);
    let tolerance = mission.config.tolerance.metres();
    let question = Question { at: &at, is_positive: &is_positive, line, p, tolerance };
    match Fit::of(&question).verdict {
        Verdict::Bend { sagitta, .. } => (Cause::Bend, Some(0.5 * sagitta)),
        Verdict::TwoLines { .. } => (Cause::Bend, None),
        Verdict::Drift { metres, .. } => (Cause::Drift, Some(0.5 * metres)),
        Verdict::Stretch { fault: Fault::Stuck(_), .. } => (Cause::Stuck, None),
        Verdict::Stretch { fault: Fault::Inverted, .. } => (Cause::Inverted, None),
        Verdict::Stretch { fault: Fault::Coin, .. } | Verdict::Row(_) | Verdict::TooHigh => {
            (Cause::Random, None)
        }
        Verdict::Fits | Verdict::TooLow => match alarm.map(|alarm| alarm.suspect) {
            Some(Suspect::Stuck) => (Cause::Stuck, None),
            Some(Suspect::Inverted) => (Cause::Inverted, None),
            _ => (Cause::Unclear, None),
        },
    }
}

/// Rounded up to two digits that count, so that it covers what it covered.
fn rounded_up(metres: f64) -> f64 {
    let digits = 1 - libm::floor(libm::log10(metres)) as i32;
    let per = libm::pow(10.0, f64::from(digits));
    // A quotient of two short decimals is a short decimal.
    (metres * per - 1e-9).ceil() / per
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metres_are_rounded_up() {
        for (metres, to) in [
            (0.1234, 0.13),
            (0.12, 0.12),
            (4.0, 4.0),
            (4.01, 4.1),
            (123.0, 130.0),
            (0.000_56, 0.000_56),
        ] {
            assert!((rounded_up(metres) - to).abs() < 1e-12, "{metres}: {}", rounded_up(metres));
        }
    }
}
