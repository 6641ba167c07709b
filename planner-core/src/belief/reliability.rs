//! How far a label can be believed, as a number.

use crate::belief::weight::LogWeight;
use crate::geometry::value::ValueError;

/// How far a label can be believed: it is true with probability `p`.
///
/// Stored as the logarithm of the odds `p / (1 - p)`, to 10^-10. A posterior needs nothing else: lines that agree with
/// a label gain this much on those that do not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "i64", into = "i64"))]
pub struct Reliability {
    log_odds: LogWeight,
}

const RANGE: ValueError = ValueError("a reliability is a probability from 0 to 1");

const ODDS: ValueError = ValueError("odds are those of a probability");

impl Reliability {
    /// The log odds of a certain label. Those of any double between 0 and 1 are below 746 in size.
    const BEYOND: LogWeight = LogWeight(1_000 * LogWeight::ONE);

    /// The label is true for certain, as within a trusted ball.
    pub const CERTAIN: Self = Self { log_odds: Self::BEYOND };

    /// The label says nothing: `p` = 1/2. All zeros in memory.
    pub const NONE: Self = Self { log_odds: LogWeight::ZERO };

    /// A label that is true with probability `p`: 1 is certain, 0 certainly wrong, and 1/2 says nothing.
    ///
    /// # Errors
    /// [`ValueError`] outside [0, 1].
    pub fn new(p: f64) -> Result<Self, ValueError> {
        let beyond = Self::BEYOND.value();
        let inside = (0.0..=1.0).contains(&p);
        let reliability = inside.then(|| {
            let log_odds = libm::log(p) - libm::log1p(-p); // infinite for 0 and 1
            Self { log_odds: LogWeight::from_log(log_odds.clamp(-beyond, beyond)) }
        });
        reliability.ok_or(RANGE)
    }

    /// All that it is, as numbers.
    pub(crate) const fn words(self) -> [u32; 2] {
        let LogWeight(units) = self.log_odds;
        [units as u32, (units >> 32) as u32]
    }

    /// The probability that the label is true.
    pub fn probability(self) -> f64 {
        1.0 / (1.0 + libm::exp(-self.log_odds.value()))
    }

    /// As [`probability`](Self::probability), in single precision.
    pub(crate) fn single(self) -> f32 {
        let [agree, disagree] = self.weights();
        agree / (agree + disagree)
    }

    /// The weights of lines that agree with the label and of those that do not, relative to the likelier side.
    pub(crate) fn weights(self) -> [f32; 2] {
        let weight = |it: Option<LogWeight>| it.map_or(0.0, LogWeight::exp_single);
        [weight(self.agree()), weight(self.disagree())]
    }

    /// The weight of lines that agree with the label, relative to the likelier side; `None` when no line can agree.
    pub(crate) fn agree(self) -> Option<LogWeight> {
        (self.log_odds.0 > -Self::BEYOND.0).then_some(LogWeight(self.log_odds.0.min(0)))
    }

    /// The weight of lines that do not agree; `None` when all must agree.
    pub(crate) fn disagree(self) -> Option<LogWeight> {
        (self.log_odds < Self::BEYOND).then_some(LogWeight(self.log_odds.0.saturating_neg().min(0)))
    }
}

/// The logarithm of the odds, in units of 2^-32.
impl From<Reliability> for i64 {
    fn from(reliability: Reliability) -> Self {
        reliability.log_odds.0
    }
}

impl TryFrom<i64> for Reliability {
    type Error = ValueError;

    fn try_from(units: i64) -> Result<Self, ValueError> {
        let inside = units.unsigned_abs() <= Self::BEYOND.0.unsigned_abs();
        inside.then_some(Self { log_odds: LogWeight(units) }).ok_or(ODDS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odds_are_those_of_the_probability() {
        for p in [5e-324, 1e-300, 1e-9, 0.3, 0.5, 0.7, 0.999, 1.0 - f64::EPSILON] {
            let it = Reliability::new(p).unwrap();
            let exact = libm::log(p) - libm::log1p(-p);
            assert!((it.log_odds.value() - exact).abs() < 2e-10, "{p}");
            let [agree, disagree] = [it.agree(), it.disagree()].map(Option::unwrap);
            assert_eq!((agree - disagree, agree.max(disagree)), (it.log_odds, LogWeight::ZERO));
            assert_eq!(Reliability::try_from(i64::from(it)), Ok(it));
        }
        let sure = Reliability::new(1.0).unwrap();
        assert_eq!(
            (sure, sure.agree(), sure.disagree()),
            (Reliability::CERTAIN, Some(LogWeight::ZERO), None)
        );
        let wrong = Reliability::new(0.0).unwrap();
        assert_eq!((wrong.agree(), wrong.disagree()), (None, Some(LogWeight::ZERO)));
        for units in [i64::MIN, i64::MAX, Reliability::BEYOND.0 + 1] {
            assert_eq!(Reliability::try_from(units), Err(ODDS));
        }
        for p in [-0.1, 1.1, f64::NAN] {
            assert_eq!(Reliability::new(p), Err(RANGE));
        }
    }
}
