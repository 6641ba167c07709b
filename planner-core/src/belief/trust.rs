//! How far the labels of a mission can be believed: with a probability that is known, or with one that is not.
//!
//! A type of its own for each, so that a program carries the code of no other.

use crate::belief::reliability::Reliability;
use crate::belief::unknown_reliability::{Counts, UnknownReliability};

/// How far doubtful labels can be believed. Implemented for [`Reliability`], [`UnknownReliability`], and
/// [`AnyReliability`], which is either of the two.
pub trait Trust: Copy + core::fmt::Debug + PartialEq + Count {
    /// The reliability that stands for a doubtful label, for example in an observation log: the number, or the mean of
    /// the prior.
    fn nominal(self) -> Reliability;

    /// The prior, if nobody knows the reliability.
    fn unknown(self) -> Option<UnknownReliability>;
}

/// What has to be counted. Private, so that no other crate implements it.
pub trait Count {
    /// Bits of a hypothesis's weight that hold the number of labels that disagree with it.
    const BITS: u32;

    /// Memory for one. All zeros.
    const NONE: Self;

    /// What a table counts.
    type Tally: Tallies;

    /// The mean of an unknown reliability, for predictions.
    type Mean: Mean;
}

/// The mean of an unknown reliability, or nothing where it is known.
pub trait Mean: Copy + core::fmt::Debug {
    /// Computes it, if it is kept.
    fn of(mean: impl FnOnce() -> f32) -> Self;

    /// The number.
    fn value(self) -> f32;
}

impl Mean for () {
    fn of(_: impl FnOnce() -> f32) -> Self {}

    fn value(self) -> f32 {
        1.0
    }
}

impl Mean for f32 {
    fn of(mean: impl FnOnce() -> f32) -> Self {
        mean()
    }

    fn value(self) -> f32 {
        self
    }
}

/// The labels that a table has counted.
pub trait Tallies: Copy + core::fmt::Debug {
    /// Of no label.
    const NONE: Self;

    /// One more doubtful label.
    fn count(&mut self);

    /// The number of doubtful labels.
    fn labels(&self) -> u8;

    /// A hypothesis was dropped with which so many of these disagree.
    fn drop_with(&mut self, disagree: u8);

    /// The fewest labels that agree with a dropped hypothesis, and that disagree with one.
    fn fewest(&self) -> [u8; 2];
}

/// Nothing, as weights add up from label to label.
impl Tallies for () {
    const NONE: Self = ();

    fn count(&mut self) {}

    fn labels(&self) -> u8 {
        0
    }

    fn drop_with(&mut self, _: u8) {}

    fn fewest(&self) -> [u8; 2] {
        [0; 2]
    }
}

/// The number of doubtful labels, and bounds on the counts of what was dropped.
#[derive(Clone, Copy, Debug)]
pub struct Tally {
    labels: u8,
    /// 255 less the fewest labels that agree, and that disagree. So memory for one is all zeros.
    complements: [u8; 2],
}

impl Tallies for Tally {
    const NONE: Self = Self { labels: 0, complements: [0; 2] };

    fn count(&mut self) {
        self.labels = self.labels.saturating_add(1);
    }

    fn labels(&self) -> u8 {
        self.labels
    }

    fn drop_with(&mut self, disagree: u8) {
        let [by_agree, by_disagree] = self.complements;
        let agree = self.labels.saturating_sub(disagree);
        self.complements = [by_agree.max(!agree), by_disagree.max(!disagree)];
    }

    fn fewest(&self) -> [u8; 2] {
        self.complements.map(|it| self.labels.min(!it))
    }
}

impl Count for Reliability {
    const BITS: u32 = 0;
    const NONE: Self = Self::NONE;
    type Tally = ();
    type Mean = ();
}

impl Trust for Reliability {
    #[inline]
    fn nominal(self) -> Reliability {
        self
    }

    #[inline]
    fn unknown(self) -> Option<UnknownReliability> {
        None
    }
}

impl Count for UnknownReliability {
    const BITS: u32 = u8::BITS;
    const NONE: Self = Self::NONE;
    type Tally = Tally;
    type Mean = f32;
}

impl Trust for UnknownReliability {
    fn nominal(self) -> Reliability {
        Reliability::new(self.mean()).unwrap_or(Reliability::NONE)
    }

    #[inline]
    fn unknown(self) -> Option<UnknownReliability> {
        Some(self)
    }
}

/// A reliability that is known or not, for programs that choose while they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AnyReliability {
    /// Labels are true with a probability that is known.
    Known(Reliability),
    /// Labels are true with a probability that nobody knows.
    Unknown(UnknownReliability),
}

impl Count for AnyReliability {
    const BITS: u32 = u8::BITS;
    const NONE: Self = Self::Known(Reliability::NONE);
    type Tally = Tally;
    type Mean = f32;
}

impl Trust for AnyReliability {
    fn nominal(self) -> Reliability {
        match self {
            Self::Known(reliability) => reliability,
            Self::Unknown(prior) => prior.nominal(),
        }
    }

    fn unknown(self) -> Option<UnknownReliability> {
        if let Self::Unknown(prior) = self { Some(prior) } else { None }
    }
}

impl From<Reliability> for AnyReliability {
    fn from(reliability: Reliability) -> Self {
        Self::Known(reliability)
    }
}

impl From<UnknownReliability> for AnyReliability {
    fn from(prior: UnknownReliability) -> Self {
        Self::Unknown(prior)
    }
}

/// The counts of a hypothesis with which so many labels disagree.
pub(crate) fn counts(tally: &impl Tallies, disagree: u8) -> Counts {
    Counts { labels: tally.labels(), disagree }
}
