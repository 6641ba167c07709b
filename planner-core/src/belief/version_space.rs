//! The version space: all lines that agree with every sample, and what can be read off it.

use crate::belief::candidates::{Candidates, Certainty};
use crate::belief::cell::{Cell, Cut, CutError, Edge};
use crate::belief::sample::{Label, Reading, Sample, SampleBuffer};
use crate::geometry::direction::Arc;
use crate::geometry::lattice::Site;
use crate::geometry::line::Bound;

/// Why samples do not make a version space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum NoVersionSpace {
    /// All samples lie on one line (or there are fewer than three): any line may pass.
    Collinear,
    /// All samples have the same label: the boundary may be anywhere beyond them.
    OneLabel,
    /// No line separates the samples up to and including the one at this index, which is the first
    /// such index.
    NotSeparable(usize),
    /// There are more samples than the buffer holds.
    TooMany,
}

impl core::fmt::Display for NoVersionSpace {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Collinear => f.write_str("the samples are collinear"),
            Self::OneLabel => f.write_str("the samples share one label"),
            Self::NotSeparable(i) => write!(f, "no line separates the samples 0 to {i}"),
            Self::TooMany => f.write_str("there are more samples than the buffer holds"),
        }
    }
}

impl core::error::Error for NoVersionSpace {}

/// Why a sample was not taken. The version space is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Refused {
    /// The sample lies in the region of certainty of the other label: a label was wrong, or the
    /// boundary is not straight.
    Contradiction(Sample),
    /// The buffer is full.
    Full(Sample),
}

impl core::fmt::Display for Refused {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Contradiction(s) => write!(
                f,
                "label {} at lattice site ({}, {}) contradicts the region of certainty it lies in",
                s.label.sign(),
                s.site.x(),
                s.site.z()
            ),
            Self::Full(_) => f.write_str("the sample buffer is full"),
        }
    }
}

impl core::error::Error for Refused {}

/// All lines that agree with up to `N` samples (the field's name for the paper's "bounds").
///
/// Each sample is kept; the [`Cell`] names those that still matter.
#[derive(Clone, Debug)]
pub struct VersionSpace<const N: usize> {
    samples: SampleBuffer<N>,
    cell: Cell<N>,
}

impl<const N: usize> VersionSpace<N> {
    /// The version space of samples of both labels that are not collinear: the oracle's points, or
    /// a record. `O(n^2)` orientations.
    ///
    /// # Errors
    /// [`NoVersionSpace`].
    pub fn new(samples: &[Sample]) -> Result<Self, NoVersionSpace> {
        let mut buffer = SampleBuffer::new();
        for &sample in samples {
            buffer.push(sample).map_err(|_| NoVersionSpace::TooMany)?;
        }
        let Some(first) = samples.first() else {
            return Err(NoVersionSpace::Collinear);
        };
        let edges = || (0u8..).zip(samples).map(|(i, sample)| Edge::new(i, sample.label));
        let a = Edge::new(0, first.label);
        let apart = edges().zip(samples).find(|(_, sample)| sample.site != first.site);
        let mut cell = apart
            .and_then(|(b, _)| edges().find_map(|c| Cell::triangle(&buffer, [a, b, c])))
            .ok_or_else(|| {
                crossed(samples).map_or(NoVersionSpace::Collinear, NoVersionSpace::NotSeparable)
            })?;
        for (i, edge) in edges().enumerate() {
            cell.cut(&buffer, edge).map_err(|_| NoVersionSpace::NotSeparable(i))?;
        }
        if samples.iter().all(|s| s.label == first.label) {
            return Err(NoVersionSpace::OneLabel);
        }
        Ok(Self { samples: buffer, cell })
    }

    /// The samples, in the order in which they came.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    pub(crate) fn into_samples(self) -> SampleBuffer<N> {
        self.samples
    }

    /// Whether another sample would be refused for want of room.
    pub fn is_full(&self) -> bool {
        self.samples.is_full()
    }

    /// The polygon of candidate lines.
    pub fn cell(&self) -> &Cell<N> {
        &self.cell
    }

    /// Takes a sample. One orientation an edge.
    ///
    /// # Errors
    /// [`Refused`], with the version space as it was.
    pub fn insert(&mut self, sample: Sample) -> Result<Cut, Refused> {
        let index = self.samples.push(sample).map_err(|full| Refused::Full(full.0))?;
        self.cell.cut(&self.samples, Edge::new(index, sample.label)).map_err(|error| {
            self.samples.pop();
            match error {
                CutError::Contradiction => Refused::Contradiction(sample),
                CutError::Full => Refused::Full(sample),
            }
        })
    }

    /// Takes a reading, and returns the label that the site has from now on.
    ///
    /// A reading on the boundary says that the line passes here, so both labels are true of the closed
    /// half-planes. On uncertain ground the sample gets `either` of them, whichever the caller likes;
    /// where all lines agree it tells nothing and is passed over, and is true as long as one of them
    /// passes here.
    ///
    /// # Errors
    /// As [`insert`](Self::insert), never for a true reading.
    pub fn observe(
        &mut self,
        site: Site,
        reading: Reading,
        either: Label,
    ) -> Result<Label, Refused> {
        let label = match reading {
            Reading::Side(label) => label,
            Reading::Boundary => match self.certainty(site) {
                Certainty::Uncertain => either,
                Certainty::Certain(label) if self.bounds().any(|bound| bound.at(site) == 0) => {
                    return Ok(label);
                }
                Certainty::Certain(label) => -label,
            },
        };
        self.insert(Sample { site, label }).map(|_| label)
    }

    /// The candidate lines, to be read off.
    pub fn candidates(&self) -> Candidates<'_> {
        self.cell.candidates(&self.samples)
    }

    /// The vertices of the version space, in cyclic order.
    pub fn bounds(&self) -> impl Iterator<Item = Bound> + '_ {
        self.candidates().bounds()
    }

    /// Whether all candidate lines give a position the same label, and which.
    pub fn certainty(&self, q: Site) -> Certainty {
        self.candidates().certainty(q)
    }

    /// The directions of the candidate lines: the paper's `E_rho,t`.
    pub fn slope_arc(&self) -> Arc {
        self.candidates().slope_arc()
    }

    /// The range of the candidate lines' intercepts in metres, the paper's `I_c,t`; `None` when it
    /// is unbounded, as a vertical line is among them.
    pub fn intercepts(&self) -> Option<[f64; 2]> {
        self.candidates().intercepts()
    }

    /// The samples that still matter: the others follow from these.
    pub fn support(&self) -> impl Iterator<Item = Sample> + Clone + '_ {
        self.candidates().support()
    }

    /// The first sample's label: where Algorithm 1 starts.
    pub fn first_label(&self) -> Label {
        self.samples.first().map_or(Label::Negative, |s| s.label)
    }
}

/// The first of these collinear samples that lies between two of the other label, or has one of the
/// other label between itself and another: no line separates the samples up to it.
fn crossed(samples: &[Sample]) -> Option<usize> {
    let between = |a: &Sample, b: &Sample, c: &Sample| {
        a.label == c.label && a.label != b.label && (a.site - b.site).dot(c.site - b.site) <= 0
    };
    (1..=samples.len()).find_map(|n| {
        let (last, earlier) = samples.get(..n)?.split_last()?;
        let pairs = || earlier.iter().flat_map(|a| earlier.iter().map(move |b| (a, b)));
        pairs()
            .any(|(a, b)| between(a, last, b) || between(last, a, b) || between(last, a, last))
            .then_some(n - 1)
    })
}
