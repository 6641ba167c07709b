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

    /// The number whose logarithm this is.
    pub fn exp(self) -> f64 {
        libm::exp(f64::from(self.0) / f64::from(Self::ONE))
    }

    /// This weight as seen from another: their quotient.
    #[must_use]
    pub const fn relative_to(self, other: Self) -> Self {
        Self::clamped(self.0.saturating_sub(other.0))
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
