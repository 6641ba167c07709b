//! What a mission says when no straight, still line explains its labels: what was seen, the best line all the same, what
//! explains the labels, and the tolerance that would cover them.

use nalgebra::Point2;
use planner_core::watch::Suspect;
use planner_core::{Line, Reading, Reliability, Sample, Step, StopReason};

use crate::fitting::explanation::{Cause, Explanation, Question};
use crate::fitting::fewest::Fewest;
use crate::mission::definition::Mission;
use crate::mission::diagnosis::{DiagnosisRecord, RefutingRecord};
use crate::mission::read_out::ReadOut;
use crate::mission::results::{AlarmRecord, Ending, StepResult};

/// A bend or a drift may be the cause if the two have this share.
const POSSIBLE: f64 = 0.1;

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
        let is_noisy = mission.is_noisy();
        // Where labels may be wrong, those of a trusted ball count as given.
        let doubtful = read.iter().filter(|it| !is_noisy || !it.is_trusted);
        let doubtful: Vec<_> = doubtful.map(|it| (it.sample, it.step as u32)).collect();
        let explanation = Explanation::of(&Question {
            given,
            read: &doubtful,
            p: is_noisy.then(|| mission.noise.map_or(1.0, |noise| noise.p)),
            tolerance: mission.config.tolerance.metres(),
            line: if is_noisy { &fewest.line } else { &near },
        });
        // What the tests for whole missions leave open the evidence may suspect.
        let cause = match (explanation.cause, alarm.map(|alarm| alarm.suspect)) {
            (Cause::Line, Some(Suspect::Stuck)) if is_noisy => Cause::Stuck,
            (Cause::Line, Some(Suspect::Inverted)) if is_noisy => Cause::Inverted,
            (Cause::Line, _) if is_noisy => Cause::Unclear,
            (cause, _) => cause,
        };
        let of = |cause| explanation.shares.get(&cause).copied().unwrap_or_default();
        let may_be_off = is_noisy || of(Cause::Bend) + of(Cause::Drift) >= POSSIBLE;
        let covering = explanation.tolerance.filter(|metres| may_be_off && *metres > 0.0);
        let rounded = |share: f64| (1e3 * share).round() / 1e3;
        let shares = explanation.shares.into_iter().map(|(cause, it)| (cause, rounded(it)));
        Some(Self {
            refuting,
            line: fewest.line.into(),
            labels: samples.len(),
            disagreeing: fewest.disagreeing.len(),
            share: fewest.disagreeing.len() as f64 / samples.len() as f64,
            steps: steps.collect(),
            cause,
            shares: shares.collect(),
            tolerance: covering.map(rounded_up),
        })
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
