//! What the labels of an audit's places come to: whether each is on the side of which the belief is sure.

use core::fmt::Debug;

use crate::belief::evidence::Evidence;
use crate::belief::reliability::Reliability;
use crate::belief::sample::Label;
use crate::belief::weight::LogWeight;

/// How many places an audit has.
pub(crate) const PLACES: usize = 6;

/// What the labels of a place come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The place is on the side of which the belief is sure.
    Agrees,
    /// More labels are needed.
    Open,
    /// No line that is likely enough explains the labels of the audit.
    Refutes,
}

/// A label of an audit.
#[derive(Clone, Copy, Debug)]
pub struct AuditLabel {
    /// The number of its place.
    pub(crate) place: usize,
    /// All other places are settled.
    pub(crate) is_last: bool,
    /// The label is the one of which the belief is sure.
    pub(crate) agrees: bool,
    pub(crate) reliability: Reliability,
    /// The level of the goal, in millionths.
    pub(crate) level: u32,
}

/// What the labels of an audit have come to so far.
pub trait Verdicts: Copy + Debug + PartialEq {
    /// Nothing has been read.
    const NONE: Self;

    /// Whether any label of a mission counts, and not only those of audits.
    const HEARS: bool = false;

    /// Takes in a label, and says what the labels of its place come to.
    fn observe(&mut self, heard: AuditLabel) -> Verdict;

    /// Whether labels of a place were read that do not decide.
    fn is_open(&self, place: usize) -> bool;

    /// Takes in any label of the mission and how likely it was before it was read. Whether all labels so far refute the
    /// model.
    fn hear(&mut self, _: Label, _: f32) -> bool {
        false
    }
}

/// Labels that are true: one decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Decisive;

impl Verdicts for Decisive {
    const NONE: Self = Self;

    fn observe(&mut self, heard: AuditLabel) -> Verdict {
        if heard.agrees { Verdict::Agrees } else { Verdict::Refutes }
    }

    fn is_open(&self, _: usize) -> bool {
        false
    }
}

/// The odds from which on a place, or all labels together, refute the model: 900, as a logarithm in units of 2^-32. On
/// the model one of these seven comes to them with a probability of `7 / 900` at most.
const AGAINST: i64 = 29_215_921_873;

/// Labels that may be wrong: sequential tests (Wald 1945).
///
/// One for each place asks whether it lies on the other side. Each label multiplies the odds of that by `p / (1 - p)` or
/// divides them. The place agrees when the odds are down to `(1 - level) / level`, where `level` is that of the goal. So a
/// place on the other side passes with no more than that as its probability. One test more asks whether all labels are
/// those of a coin. No place is settled while they are likelier to be that, nor the last until these odds are down as
/// well. The model is refuted when any odds have come to 900.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Odds {
    /// As logarithms in units of 2^-32.
    other_side: [i64; PLACES],
    coin: i64,
    /// What all labels of the mission say against the model.
    evidence: Evidence,
}

impl Verdicts for Odds {
    const NONE: Self = Self { other_side: [0; PLACES], coin: 0, evidence: Evidence::NONE };
    const HEARS: bool = true;

    fn observe(&mut self, heard: AuditLabel) -> Verdict {
        let AuditLabel { place, is_last, agrees, reliability, level } = heard;
        let Some(odds) = self.other_side.get_mut(place) else { return Verdict::Open };
        let (sure, p) = (i64::from(reliability), reliability.single());
        let (gain, chance) = if agrees { (-sure, p) } else { (sure, 1.0 - p) };
        *odds = odds.saturating_add(gain);
        if chance > 0.0 {
            let gain = (LogWeight::of(0.5 / chance) * LogWeight::ONE as f32) as i64;
            self.coin = self.coin.saturating_add(gain);
        }
        if *odds >= AGAINST || self.coin >= AGAINST {
            return Verdict::Refutes;
        }
        let enough = LogWeight::of(level as f32 / (1_000_001 - level.min(1_000_000)) as f32);
        let passes = |odds: i64| odds < 0 && odds as f32 <= -enough * LogWeight::ONE as f32;
        let is_no_coin = if is_last { passes(self.coin) } else { self.coin < 0 };
        if passes(*odds) && (is_no_coin || p >= 1.0) { Verdict::Agrees } else { Verdict::Open }
    }

    fn is_open(&self, place: usize) -> bool {
        self.other_side.get(place).is_some_and(|odds| *odds != 0)
    }

    fn hear(&mut self, label: Label, chance: f32) -> bool {
        self.evidence.observe(label, chance);
        self.evidence.alarm().is_some_and(|alarm| alarm.is_grave())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The verdict on labels of one place, by their agreement.
    fn verdict(p: f64, level: u32, labels: impl IntoIterator<Item = bool>) -> Verdict {
        let (mut odds, reliability) = (Odds::NONE, Reliability::new(p).unwrap());
        let mut last = Verdict::Open;
        for agrees in labels {
            last =
                odds.observe(AuditLabel { place: 0, is_last: false, agrees, reliability, level });
        }
        last
    }

    #[test]
    fn as_many_labels_as_the_level_needs() {
        for (p, level, labels) in [
            (0.9, 900_000, 2), // 9 against 1 once is as much as the level, but for rounding
            (0.9, 899_000, 1),
            (0.9, 990_000, 3),
            (0.7, 900_000, 3),
            (0.7, 990_000, 6),
            (0.55, 900_000, 11),
        ] {
            let agree = |count| verdict(p, level, [true].into_iter().cycle().take(count));
            let first = (1..100).find(|count| agree(*count) == Verdict::Agrees);
            assert!(first == Some(labels) || first == Some(labels - 1), "{p}, {level}: {first:?}");
            assert_ne!(verdict(p, level, [false, true]), Verdict::Agrees);
        }
        // 9^3 is 729.
        assert_eq!(verdict(0.9, 900_000, [false; 3]), Verdict::Open);
        assert_eq!(verdict(0.9, 900_000, [false; 4]), Verdict::Refutes);
        assert_eq!(verdict(1.0, 900_000, [true]), Verdict::Agrees);
        assert_eq!(verdict(1.0, 900_000, [false]), Verdict::Refutes);
    }

    /// Over all sequences of labels of one place: how often the model is refuted while it is true.
    #[test]
    fn the_model_is_rarely_refuted_while_it_is_true() {
        for p in [0.6_f64, 0.75, 0.9] {
            const LABELS: u32 = 14;
            let (reliability, mut refuted) = (Reliability::new(p).unwrap(), 0.0);
            for sequence in 0..1_u32 << LABELS {
                let (mut odds, mut weight, mut refutes) = (Odds::NONE, 1.0, false);
                for n in 0..LABELS {
                    let agrees = sequence >> n & 1 == 1;
                    weight *= if agrees { p } else { 1.0 - p };
                    let heard = AuditLabel {
                        place: 0,
                        is_last: false,
                        agrees,
                        reliability,
                        level: 900_000,
                    };
                    refutes |= odds.observe(heard) == Verdict::Refutes;
                }
                refuted += if refutes { weight } else { 0.0 };
            }
            assert!(refuted <= 2.0 / 900.0, "{p}: {refuted}");
        }
    }
}
