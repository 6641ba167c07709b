//! An edge of a cell, in one byte: the constraint that one sample puts on the lines.

use crate::belief::sample::{Label, Sample};
use crate::geometry::lattice::{Site, Vector};

/// An edge of a cell: the index of its sample in the buffer, and the label that the cell gives the sample.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Constraint(u8);

impl Constraint {
    const NEGATIVE: u8 = 0x80;

    /// The edge of the sample at `index` (below 128) when its label is `label`.
    pub const fn new(index: u8, label: Label) -> Self {
        match label {
            Label::Positive => Self(index & !Self::NEGATIVE),
            Label::Negative => Self(index | Self::NEGATIVE),
        }
    }

    /// The sample's place in the buffer.
    pub const fn index(self) -> usize {
        (self.0 & !Self::NEGATIVE) as usize
    }

    /// The sample's label in this cell.
    pub const fn label(self) -> Label {
        if self.0 & Self::NEGATIVE == 0 { Label::Positive } else { Label::Negative }
    }

    /// The same edge after another sample is removed from the buffer, at `index`.
    pub(crate) const fn without(self, index: usize) -> Self {
        Self(if self.index() > index { self.0 - 1 } else { self.0 })
    }

    /// What memory is filled with where there is no edge: all zeros.
    pub(crate) const NONE: Self = Self(0);

    /// The sample as seen from `q`, on the other side of it if its label is negative.
    pub(crate) fn seen(self, samples: &[Sample], q: Site) -> Vector {
        let seen = samples.get(self.index()).map(|s| s.site - q).unwrap_or_default();
        if self.label() == Label::Positive { seen } else { seen.reversed() }
    }
}

impl core::fmt::Debug for Constraint {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let sign = if self.label() == Label::Positive { '+' } else { '-' };
        write!(f, "{sign}{}", self.index())
    }
}
