//! What a belief was told, to be kept over a sleep: its samples in their order, and how far each label was
//! believed.
//!
//! A belief follows from these and from nothing else, the same on every machine. So it is not its cells and
//! weights that are kept but what made them: as few bytes as there are, and none that could contradict each
//! other when they are read again.

use heapless::Vec;

use crate::belief::Refused;
use crate::belief::noise::Reliability;
use crate::belief::sample::Sample;
use crate::belief::tolerance::Tolerance;
use crate::belief::version_space::{NoVersionSpace, VersionSpace};

/// Up to `N` samples, the given ones first. `24 N` bytes and some 16; in postcard's form some 10 bytes a sample, 16 where
/// labels may be wrong, and up to 4 more where each brings a tolerance of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Told<const N: usize> {
    given: u8,
    samples: Vec<Sample, N, u8>,
    /// Of the labels taken in since; of none where all are true.
    reliabilities: Vec<Reliability, N, u8>,
    /// How far the position of each of these labels may be off; of none where all may be by as much as is configured.
    /// Where labels are true, only the last is kept: it says how far the next may be off.
    tolerances: Vec<Tolerance, N, u8>,
}

impl<const N: usize> Told<N> {
    /// What was given, all that was told, and how far the labels among it are believed, if they may be wrong.
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

    /// The same, of positions that may be off by so much, unless all may be by the tolerance configured.
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

    /// The samples that were given.
    pub fn given(&self) -> &[Sample] {
        self.samples.get(..usize::from(self.given)).unwrap_or(&self.samples)
    }

    /// The labels taken in since.
    pub fn labels(&self) -> &[Sample] {
        self.samples.get(usize::from(self.given)..).unwrap_or(&[])
    }

    /// The labels where all are true.
    pub(crate) fn true_labels(&self) -> Result<&[Sample], NotReplayed> {
        let are_true = self.reliabilities.is_empty();
        are_true.then_some(self.labels()).ok_or(NotReplayed::Kind)
    }

    /// The labels where they may be wrong.
    pub(crate) fn doubtful_labels(
        &self,
        configured: Tolerance,
    ) -> Result<impl Iterator<Item = (Sample, Reliability, Tolerance)>, NotReplayed> {
        let labels = self.labels();
        let are_alike = self.tolerances.is_empty() || self.tolerances.len() == labels.len();
        if self.reliabilities.len() != labels.len() || !are_alike {
            return Err(NotReplayed::Kind);
        }
        let within = self.tolerances.iter().copied().chain(core::iter::repeat(configured));
        let labels = labels.iter().copied().zip(self.reliabilities.iter().copied()).zip(within);
        Ok(labels.map(|((sample, reliability), tolerance)| (sample, reliability, tolerance)))
    }
}

/// A belief that can tell what it was told, and be told it again.
pub trait Replay {
    /// All that it can be told.
    type Told;

    /// What it was told.
    fn told(&self) -> Self::Told;

    /// Begins again and takes in what was told, by the noise and the tolerance that it has. It costs what the labels
    /// cost when they came.
    ///
    /// # Errors
    /// [`NotReplayed`]. The belief knows then no more than what came before.
    fn replay(&mut self, told: &Self::Told) -> Result<(), NotReplayed>;
}

/// Why a belief did not take in what it was to be told again: it is not what this belief has told, or was spoilt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NotReplayed {
    /// It was told to a belief of the other kind, as to whether labels may be wrong.
    Kind,
    /// The given samples.
    Given(NoVersionSpace),
    /// A label.
    Label(Refused),
}

impl core::fmt::Display for NotReplayed {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Kind => f.write_str("what was told is for labels of the other kind"),
            Self::Given(why) => why.fmt(f),
            Self::Label(why) => why.fmt(f),
        }
    }
}

impl core::error::Error for NotReplayed {}

impl From<NoVersionSpace> for NotReplayed {
    fn from(why: NoVersionSpace) -> Self {
        Self::Given(why)
    }
}

impl From<Refused> for NotReplayed {
    fn from(why: Refused) -> Self {
        Self::Label(why)
    }
}

/// Samples are told where they were taken in, which under a tolerance is not where they were read. So they are taken in
/// as they are, and their tolerances are not told; only the last is, by which the next label is expected to be shifted.
impl<const N: usize> Replay for VersionSpace<N> {
    type Told = Told<N>;

    fn told(&self) -> Told<N> {
        let told = Told::new(self.given(), self.samples(), core::iter::empty());
        told.within(core::iter::once(self.expected()), self.tolerance())
    }

    fn replay(&mut self, told: &Told<N>) -> Result<(), NotReplayed> {
        *self = Self::new(told.given())?.within(self.tolerance())?;
        for &sample in told.true_labels()? {
            self.insert(sample)?;
        }
        self.expect(told.expected().unwrap_or(self.tolerance()))?;
        Ok(())
    }
}
