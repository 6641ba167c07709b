//! Labels, readings, samples, and the bounded buffer that holds them.

use core::ops::{Deref, Neg};

use heapless::Vec;
use nalgebra::Point2;

use crate::geometry::lattice::{LatticeError, Site};

/// The side of the boundary on which a position lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Label {
    /// The paper's -1.
    Negative,
    /// The paper's +1.
    Positive,
}

impl Label {
    /// -1 or 1.
    pub const fn sign(self) -> i8 {
        match self {
            Self::Negative => -1,
            Self::Positive => 1,
        }
    }
}

impl Neg for Label {
    type Output = Self;

    fn neg(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Positive => Self::Negative,
        }
    }
}

/// What a sensor reports: a label, or that it stands on the boundary itself (the paper's 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Reading {
    /// A side of the boundary.
    Side(Label),
    /// Exactly on the boundary. Algorithm 1 does not count it as a change of label (Section IV).
    Boundary,
}

impl Reading {
    /// -1, 0 or 1.
    pub const fn sign(self) -> i8 {
        match self {
            Self::Side(label) => label.sign(),
            Self::Boundary => 0,
        }
    }
}

impl From<Label> for Reading {
    fn from(label: Label) -> Self {
        Self::Side(label)
    }
}

/// A labelled position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// Where.
    pub site: Site,
    /// On which side.
    pub label: Label,
}

impl Sample {
    /// A label at a place in metres, `[x, z]` or a point of `nalgebra`.
    ///
    /// # Errors
    /// [`LatticeError`] unless both coordinates are smaller than 8,192 m in size.
    pub fn at(place: impl Into<Point2<f64>>, label: Label) -> Result<Self, LatticeError> {
        Ok(Self { site: Site::metres(place)?, label })
    }
}

/// The buffer is full; the sample that did not fit is handed back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct BufferFullError(pub Sample);

impl core::fmt::Display for BufferFullError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the sample buffer is full")
    }
}

impl core::error::Error for BufferFullError {}

/// Up to `N` samples, at most 128, in the order in which they came. 12 bytes each.
///
/// Reads as a slice of [`Sample`].
#[derive(Clone, Debug)]
pub(crate) struct SampleBuffer<const N: usize> {
    samples: Vec<Sample, N, u8>,
}

impl<const N: usize> SampleBuffer<N> {
    /// An empty buffer.
    pub(crate) const fn new() -> Self {
        const {
            assert!(N >= 3, "three samples are the fewest that bound a line");
            assert!(N <= 128, "a cell names its samples by seven bits");
        }
        Self { samples: Vec::new() }
    }

    /// Appends a sample and returns its index.
    ///
    /// # Errors
    /// [`BufferFullError`] with the sample when `N` are held already.
    pub(crate) fn push(&mut self, sample: Sample) -> Result<u8, BufferFullError> {
        let index = self.samples.len() as u8;
        self.samples.push(sample).map_err(BufferFullError)?;
        Ok(index)
    }

    pub(crate) fn pop(&mut self) {
        let _ = self.samples.pop();
    }

    /// Removes a sample. Those after it move up, so their indices fall by one.
    pub(crate) fn remove(&mut self, index: usize) {
        for after in index + 1..self.samples.len() {
            // Hidden, so that a program does not carry a `memmove` for this alone: 1.6 KB.
            let after = core::hint::black_box(after);
            if let Some(&sample) = self.samples.get(after)
                && let Some(place) = self.samples.get_mut(after - 1)
            {
                *place = sample;
            }
        }
        self.pop();
    }

    /// Whether another sample would be refused.
    pub(crate) fn is_full(&self) -> bool {
        self.samples.is_full()
    }
}

impl<const N: usize> Default for SampleBuffer<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Deref for SampleBuffer<N> {
    type Target = [Sample];

    fn deref(&self) -> &[Sample] {
        &self.samples
    }
}
