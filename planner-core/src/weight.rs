//! Probabilities as logarithms in fixed point, so that weights add exactly and compare alike on
//! every machine.

use core::ops::Add;

/// A natural logarithm in units of 2^-24 (relative precision 6e-8), from -96 to 31.
///
/// What is less likely than `e^-96` is held to be that likely.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "wire", serde(try_from = "i32", into = "i32"))]
pub struct LogWeight(pub(crate) i32);

impl LogWeight {
    const ONE: i32 = 1 << 24;
    pub(crate) const LEAST: i32 = -96 * Self::ONE;
    pub(crate) const MOST: i32 = 31 * Self::ONE;

    /// The logarithm of 1.
    pub const ZERO: Self = Self(0);

    /// The logarithm of a positive number; the least weight for 0 and below.
    pub fn of(value: f64) -> Self {
        let units = libm::log(value.max(f64::MIN_POSITIVE)) * f64::from(Self::ONE);
        Self(libm::round(units).clamp(f64::from(Self::LEAST), f64::from(Self::MOST)) as i32)
    }

    /// The logarithm of a positive number in single precision; the least weight below 2^-126. Off by
    /// less than 3 units.
    pub(crate) fn of_single(value: f32) -> Self {
        const SQRT_HALF: u32 = core::f32::consts::FRAC_1_SQRT_2.to_bits();
        if value < f32::MIN_POSITIVE {
            return Self(Self::LEAST);
        }
        // value = m 2^k with m about 1, and log(m) = 2 artanh(s).
        let k = (value.to_bits() as i32 - SQRT_HALF as i32) >> 23;
        let m = f32::from_bits((value.to_bits() as i32 - (k << 23)) as u32);
        let s = (m - 1.0) / (m + 1.0);
        let ss = s * s;
        let log =
            2.0 * s + 2.0 * s * ss * (1.0 / 3.0 + ss * (1.0 / 5.0 + ss * (1.0 / 7.0 + ss / 9.0)));
        Self::clamped(Self::of_power(k) + (log * Self::ONE as f32) as i32)
    }

    /// The number whose logarithm this is, rounded to single precision: the weight is no finer.
    pub fn exp(self) -> f64 {
        f64::from(self.exp_single())
    }

    /// The number whose logarithm this is; what is less than 2^-125 is held to be about that.
    #[inline(never)] // called from many places
    pub(crate) fn exp_single(self) -> f32 {
        const LOG2_E_IN_2_30: i64 = 1_549_082_005;
        const SERIES: [f32; 7] =
            [1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 1.0 / 2.0, 1.0];
        // It is 2^k e^r with r at most half of log(2), but for rounding.
        let k = ((i64::from(self.0) * LOG2_E_IN_2_30 + (1 << 53)) >> 54) as i32;
        let r = (self.0 - Self::of_power(k)) as f32 / Self::ONE as f32;
        let e_r = 1.0 + SERIES.iter().fold(0.0, |sum, factor| r * (sum + factor));
        e_r * f32::from_bits(((k.max(-125) + 127) as u32) << 23)
    }

    /// The logarithm of `2^k` in units, rounded down.
    fn of_power(k: i32) -> i32 {
        const LN_2_IN_2_31: i64 = 1_488_522_236;
        ((i64::from(k) * LN_2_IN_2_31) >> 7) as i32
    }

    /// Of a whole of 2^20 votes, how many go to a weight when the largest has all.
    pub(crate) fn votes(self, largest: Self) -> u32 {
        const WHOLE: f32 = (1 << 20) as f32;
        (self.relative_to(largest).exp_single() * WHOLE + 0.5) as u32
    }

    /// This weight as seen from another: their quotient.
    #[must_use]
    pub const fn relative_to(self, other: Self) -> Self {
        Self::clamped(self.0 - other.0) // at most 127 times 2^24 in size
    }

    const fn clamped(units: i32) -> Self {
        Self(if units < Self::LEAST {
            Self::LEAST
        } else if units > Self::MOST {
            Self::MOST
        } else {
            units
        })
    }
}

/// The product of the two numbers.
impl Add for LogWeight {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::clamped(self.0.saturating_add(other.0))
    }
}

/// How far a label can be believed: it is true with probability `p`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Reliability {
    /// The weight of what agrees with the label; `None` when nothing can.
    pub(crate) agree: Option<LogWeight>,
    /// The weight of what does not; `None` when all must agree.
    pub(crate) disagree: Option<LogWeight>,
}

impl Reliability {
    /// The label is true for certain, as within a trusted ball.
    pub const CERTAIN: Self = Self { agree: Some(LogWeight::ZERO), disagree: None };

    /// A label that is true with probability `p`: 1 is certain, 0 certainly wrong, and 1/2 says
    /// nothing. `None` outside [0, 1].
    pub fn new(p: f64) -> Option<Self> {
        let weight = |p: f64| (p > 0.0).then(|| LogWeight::of(p));
        (0.0..=1.0).contains(&p).then(|| Self { agree: weight(p), disagree: weight(1.0 - p) })
    }

    /// The larger of the two weights.
    pub(crate) fn most(self) -> LogWeight {
        self.agree.max(self.disagree).unwrap_or(LogWeight::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_precision_is_as_good_as_the_units() {
        for n in 0..400_000 {
            let units = LogWeight::LEAST + 5_003 * n;
            let exact = libm::exp(f64::from(units) / f64::from(LogWeight::ONE));
            let got = LogWeight(units).exp();
            let least = libm::exp2(-125.0);
            assert!((got / exact.max(least / 1.5) - 1.0).abs() < 3e-7 || exact < least, "{units}");
            let value = exact as f32;
            if value >= f32::MIN_POSITIVE {
                let of = LogWeight::of(f64::from(value));
                assert!((of.0 - LogWeight::of_single(value).0).abs() < 3, "{value}");
            }
        }
        for value in [0.0, -1.0, 1e-39] {
            assert_eq!(LogWeight::of_single(value).0, LogWeight::LEAST);
        }
        assert_eq!((LogWeight::of_single(1.0), LogWeight::ZERO.exp()), (LogWeight::ZERO, 1.0));
        assert_eq!(LogWeight::ZERO.votes(LogWeight::ZERO), 1 << 20);
    }
}
