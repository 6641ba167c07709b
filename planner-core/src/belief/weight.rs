//! Probabilities as logarithms in fixed point, so that weights add exactly and compare alike on
//! every machine.

use core::ops::{Add, Sub};

/// A natural logarithm in units of 2^-32. It is far from overflow: 128 labels of the least probability that a double
/// can hold add up to 2^49.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LogWeight(pub(crate) i64);

impl LogWeight {
    pub(crate) const ONE: i64 = 1 << 32;

    /// The logarithm of 1.
    pub const ZERO: Self = Self(0);

    pub(crate) fn from_log(log: f64) -> Self {
        Self(libm::round(log * Self::ONE as f64) as i64)
    }

    /// The logarithm of a positive number, as one.
    pub(crate) fn of(value: f32) -> f32 {
        Coarse::of(value).0 as f32 / Coarse::ONE as f32
    }

    /// The number whose logarithm this is, rounded to single precision and never below 2^-125.
    pub fn exp(self) -> f64 {
        f64::from(self.exp_single())
    }

    /// The logarithm as a number.
    pub fn value(self) -> f64 {
        self.0 as f64 / Self::ONE as f64
    }

    /// As [`exp`](Self::exp).
    #[inline(never)] // called from many places
    pub(crate) fn exp_single(self) -> f32 {
        Coarse::near(self).exp()
    }

    /// A bound of the number above, in single precision: infinite where that ends.
    pub(crate) fn exp_bound(self) -> f32 {
        if self > LogWeight::from(Coarse(Coarse::MOST)) {
            return f32::INFINITY;
        }
        self.exp_single() * (1.0 + 8.0 * f32::EPSILON)
    }

    /// The votes of a weight, if the largest weight has all 2^20 votes.
    pub(crate) fn votes(self, largest: Self) -> u32 {
        const WHOLE: f32 = (1 << 20) as f32;
        ((self - largest).exp_single() * WHOLE + 0.5) as u32
    }
}

/// The product of the two numbers.
impl Add for LogWeight {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

/// Their quotient.
impl Sub for LogWeight {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

/// A logarithm in units of 2^-24 (relative precision 6e-8), from -96 to 88: the range of single precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Coarse(i32);

impl Coarse {
    const BITS: u32 = 24;
    const ONE: i32 = 1 << Self::BITS;
    const LEAST: i32 = -96 * Self::ONE;
    const MOST: i32 = 88 * Self::ONE;

    fn near(weight: LogWeight) -> Self {
        const SHIFT: u32 = 32 - Coarse::BITS;
        let units = (weight.0 + (1 << (SHIFT - 1))) >> SHIFT;
        Self(units.clamp(Self::LEAST.into(), Self::MOST.into()) as i32)
    }

    /// The logarithm of a positive number, off by less than 3 units. Below 2^-126 it is the least value, -96.
    pub(crate) fn of(value: f32) -> Self {
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
        let units = Self::of_power(k) + (log * Self::ONE as f32) as i32;
        Self(units.clamp(Self::LEAST, Self::MOST))
    }

    /// The number whose logarithm this is, but not less than about 2^-125.
    fn exp(self) -> f32 {
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
}

impl From<Coarse> for LogWeight {
    fn from(coarse: Coarse) -> Self {
        Self(i64::from(coarse.0) << (32 - Coarse::BITS))
    }
}

/// How hypotheses are weighed before any label is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Prior {
    /// By the measure of their lines, d(angle) d(offset): uniform over lines.
    #[default]
    Area,
    /// All alike: the paper's, uniform over separable sequences.
    Sequences,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_precision_is_as_good_as_the_units() {
        for n in 0..400_000 {
            let units = Coarse::LEAST + 5_003 * n;
            let exact = libm::exp(f64::from(units) / f64::from(Coarse::ONE));
            let got = LogWeight::from(Coarse(units)).exp();
            let least = libm::exp2(-125.0);
            assert!((got / exact.max(least / 1.5) - 1.0).abs() < 3e-7 || exact < least, "{units}");
            let value = exact as f32;
            if value >= f32::MIN_POSITIVE {
                let log = libm::log(f64::from(value)) * f64::from(Coarse::ONE);
                assert!((log - f64::from(Coarse::of(value).0)).abs() < 3.5, "{value}");
            }
        }
        for value in [0.0, -1.0, 1e-39] {
            assert_eq!(Coarse::of(value).0, Coarse::LEAST);
        }
        assert_eq!((Coarse::of(1.0), LogWeight::ZERO.exp()), (Coarse(0), 1.0));
        assert_eq!(LogWeight::ZERO.votes(LogWeight::ZERO), 1 << 20);
        let thin = LogWeight::from_log(-86.0).exp() / libm::exp(-86.0);
        assert!((thin - 1.0).abs() < 3e-7, "{thin}");
        // Beyond what single precision can tell.
        assert_eq!(Coarse::near(LogWeight(i64::MIN / 2)).0, Coarse::LEAST);
        assert_eq!(Coarse::near(LogWeight(i64::MAX / 2)).0, Coarse::MOST);
    }
}
