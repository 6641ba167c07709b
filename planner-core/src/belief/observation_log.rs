//! What a belief has taken in, to be kept over a sleep: its samples in order, and the reliability of each label.
//!
//! A belief follows from these alone, the same on every machine. So they are stored instead of cells and weights. That
//! takes the fewest bytes, and the stored data cannot contradict each other when they are read again.

use heapless::Vec;

use crate::belief::ObservationError;
use crate::belief::reliability::Reliability;
use crate::belief::sample::Sample;
use crate::belief::tolerance::Tolerance;
use crate::belief::true_labels::{GivenError, VersionSpace};
use crate::geometry::mark::Mark;

/// Up to `N` samples, the given ones first. `24 N` bytes and some 16.
///
/// Encoded by postcard, a sample takes some 10 bytes, or 16 where labels may be wrong. A tolerance of its own adds up
/// to 4.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ObservationLog<const N: usize> {
    given: u8,
    samples: Vec<Sample, N, u8>,
    /// The reliabilities of the labels taken in since. Empty if all labels are true.
    reliabilities: Vec<Reliability, N, u8>,
    /// How far the position of each of these labels may be off. Empty if all have the configured tolerance. If labels
    /// are true, only the last is kept: it says how far the next may be off.
    tolerances: Vec<Tolerance, N, u8>,
}

impl<const N: usize> ObservationLog<N> {
    /// The given samples, all samples, and the reliabilities of the labels among them, if these may be wrong.
    pub(crate) fn new(
        given: &[Sample],
        all: &[Sample],
        believed: impl Iterator<Item = Reliability>,
    ) -> Self {
        Self {
            given: given.len() as u8,
            samples: all.iter().copied().collect(),
            reliabilities: believed.collect(),
            tolerances: Vec::new(),
        }
    }

    /// Adds the tolerances of the positions, unless all equal the configured one.
    pub(crate) fn within(
        mut self,
        tolerances: impl Iterator<Item = Tolerance> + Clone,
        configured: Tolerance,
    ) -> Self {
        if tolerances.clone().any(|it| it != configured) {
            self.tolerances = tolerances.collect();
        }
        self
    }

    /// How far the next position is expected to be off where labels are true, if not by the tolerance configured.
    pub(crate) fn expected(&self) -> Option<Tolerance> {
        self.tolerances.last().copied()
    }

    /// Whether it has as many samples as it says were given.
    fn check(&self) -> Result<(), ReplayError> {
        let is_whole = usize::from(self.given) <= self.samples.len();
        is_whole.then_some(()).ok_or(ReplayError::Spoilt)
    }

    /// The samples that were given.
    pub fn given(&self) -> &[Sample] {
        self.samples.get(..usize::from(self.given)).unwrap_or(&self.samples)
    }

    /// The labels taken in since.
    pub fn labels(&self) -> &[Sample] {
        self.samples.get(usize::from(self.given)..).unwrap_or(&[])
    }

    /// The labels where all are true.
    pub(crate) fn true_labels(&self) -> Result<&[Sample], ReplayError> {
        self.check()?;
        let are_true = self.reliabilities.is_empty();
        are_true.then_some(self.labels()).ok_or(ReplayError::Kind)
    }

    /// The labels where they may be wrong.
    pub(crate) fn doubtful_labels(
        &self,
        configured: Tolerance,
    ) -> Result<impl Iterator<Item = (Sample, Reliability, Tolerance)>, ReplayError> {
        self.check()?;
        let labels = self.labels();
        let are_alike = self.tolerances.is_empty() || self.tolerances.len() == labels.len();
        if self.reliabilities.len() != labels.len() || !are_alike {
            return Err(ReplayError::Kind);
        }
        let within = self.tolerances.iter().copied().chain(core::iter::repeat(configured));
        let labels = labels.iter().copied().zip(self.reliabilities.iter().copied()).zip(within);
        Ok(labels.map(|((sample, reliability), tolerance)| (sample, reliability, tolerance)))
    }
}

/// A belief that can export what it has taken in, and take it in again.
pub trait FromLog {
    /// The log of what it takes in.
    type ObservationLog;

    /// The log of all that it has taken in so far.
    fn log(&self) -> Self::ObservationLog;

    /// What it was told before the first label, as far as that tells a mission from others.
    fn mark(&self) -> Mark;

    /// Begins again and takes in what was exported, with this belief's own noise and tolerance. It costs as much as the
    /// labels did when they came.
    ///
    /// # Errors
    /// [`ReplayError`]. The belief may then contain only a part of the log.
    fn replay(&mut self, log: &Self::ObservationLog) -> Result<(), ReplayError>;
}

/// Why a belief did not take in an export: another belief made it, or it was spoilt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ReplayError {
    /// It comes from a belief of the other kind: one for true labels, the other for labels that may be wrong.
    Kind,
    /// What it holds goes together in no mission: it says that more samples were given than it has, or the like.
    Spoilt,
    /// The given samples make no belief.
    Given(GivenError),
    /// A label was refused.
    Label(ObservationError),
}

impl core::fmt::Display for ReplayError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Kind => f.write_str("the log is of labels of the other kind"),
            Self::Spoilt => f.write_str("what it holds goes together in no mission"),
            Self::Given(why) => why.fmt(f),
            Self::Label(why) => why.fmt(f),
        }
    }
}

impl core::error::Error for ReplayError {}

impl From<GivenError> for ReplayError {
    fn from(why: GivenError) -> Self {
        Self::Given(why)
    }
}

impl From<ObservationError> for ReplayError {
    fn from(why: ObservationError) -> Self {
        Self::Label(why)
    }
}

/// Samples are stored at the places where they were taken in. Under a tolerance these are not the places where they
/// were read. So replaying inserts them as they are, without their tolerances. Only the last tolerance is stored: the
/// next label is expected to be shifted by it.
impl<const N: usize> FromLog for VersionSpace<N> {
    type ObservationLog = ObservationLog<N>;

    fn log(&self) -> ObservationLog<N> {
        let log = ObservationLog::new(self.given(), self.samples(), core::iter::empty());
        log.within(core::iter::once(self.expected()), self.tolerance())
    }

    fn mark(&self) -> Mark {
        Mark::NONE.and([self.tolerance().units()])
    }

    fn replay(&mut self, log: &ObservationLog<N>) -> Result<(), ReplayError> {
        let labels = log.true_labels()?;
        *self = Self::new(log.given())?.with_tolerance(self.tolerance())?;
        for &sample in labels {
            self.insert(sample)?;
        }
        self.expect(log.expected().unwrap_or(self.tolerance()))?;
        Ok(())
    }
}
