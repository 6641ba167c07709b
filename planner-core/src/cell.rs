//! A cell of candidate lines: a cyclic list of signed sample indices, one byte each.
//!
//! In the space of homogeneous lines `(A, B, C)` a sample `(x, z)` with label `y` admits the
//! half-space `y (A x + B z + C) >= 0`. The lines that agree with a set of samples are a convex
//! cone; seen as a polygon, each *edge* belongs to a sample that still matters and each *vertex*,
//! between two edges, is the line through their two samples: a [`Bound`]. So a list of samples says
//! it all, and one predicate, [`Bound::at`], decides every question about it.
//!
//! A cell does not hold the samples: several cells can share one buffer of sites.

use heapless::Vec;

use crate::lattice::{Site, orient};
use crate::line::Bound;
use crate::sample::{Label, Sample};

/// A sample's part in a cell: its index in the buffer and the label the cell gives it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Edge(u8);

impl Edge {
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
}

impl core::fmt::Debug for Edge {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let sign = if self.label() == Label::Positive { '+' } else { '-' };
        write!(f, "{sign}{}", self.index())
    }
}

/// What the lines of a cell say about a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Certainty {
    /// All give it this label: it lies in a region of certainty (the paper's `X_t` or `X^c_t`).
    Certain(Label),
    /// They disagree: a sample here cuts the cell.
    Uncertain,
}

impl Certainty {
    /// What lines on both sides, given as signs, say together.
    pub(crate) fn of_signs(signs: impl Iterator<Item = i64>) -> Self {
        let (mut below, mut above) = (false, false);
        for sign in signs {
            below |= sign < 0;
            above |= sign > 0;
            if below && above {
                return Self::Uncertain;
            }
        }
        Self::Certain(if below { Label::Negative } else { Label::Positive })
    }
}

/// What a sample did to a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cut {
    /// It removed some of the lines.
    Smaller,
    /// All lines agreed with it already.
    Unchanged,
}

/// Why a cell could not be cut. It is left as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CutError {
    /// No line of the cell agrees with the sample.
    Contradiction,
    /// The result has more edges than the cell can hold.
    Full,
}

/// A convex cell of candidate lines with up to `E` edges. `E + 1` bytes.
///
/// `samples` in every method is the one buffer whose indices the edges are.
#[derive(Clone, PartialEq, Eq)]
pub struct Cell<const E: usize> {
    edges: Vec<Edge, E, u8>,
}

impl<const E: usize> Cell<E> {
    /// No line at all: a cell without edges.
    pub(crate) const NONE: Self = Self { edges: Vec::new() };

    /// The lines that agree with three samples; `None` when these are collinear.
    pub fn triangle(samples: &[Sample], [i, j, k]: [Edge; 3]) -> Option<Self> {
        const { assert!(E >= 3, "a cell has at least three edges") };
        let site = |edge: Edge| samples.get(edge.index()).map(|s| s.site);
        let turn = orient(site(i)?, site(j)?, site(k)?);
        let labels = i.label().sign() * j.label().sign() * k.label().sign();
        let ordered = match turn.signum() * i64::from(labels) {
            0 => return None,
            1 => [i, j, k],
            _ => [i, k, j],
        };
        Vec::from_slice(&ordered).ok().map(|edges| Self { edges })
    }

    /// The same cell with another capacity; `None` when its edges do not fit.
    pub(crate) fn resized<const F: usize>(&self) -> Option<Cell<F>> {
        Vec::from_slice(&self.edges).ok().map(|edges| Cell { edges })
    }

    /// The samples that still matter, in cyclic order.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The vertex after the `k`-th edge.
    fn bound(&self, samples: &[Sample], k: usize) -> Option<Bound> {
        let i = *self.edges.get(k)?;
        let j = *self.edges.get(k + 1).or(self.edges.first())?;
        let (p, q) = (samples.get(i.index())?.site, samples.get(j.index())?.site);
        let along = if i.label() == j.label() { q - p } else { p - q };
        Some(Bound { through: p, along })
    }

    /// The vertices: the lines through two samples that bound the cell, in cyclic order.
    pub fn bounds<'a>(&'a self, samples: &'a [Sample]) -> impl Iterator<Item = Bound> + 'a {
        (0..self.edges.len()).filter_map(|k| self.bound(samples, k))
    }

    /// Each edge with the vertices at its two ends, in cyclic order.
    pub fn sides<'a>(
        &'a self,
        samples: &'a [Sample],
    ) -> impl Iterator<Item = (Edge, [Bound; 2])> + 'a {
        let n = self.edges.len();
        self.edges.iter().enumerate().filter_map(move |(k, &edge)| {
            let before = if k == 0 { n - 1 } else { k - 1 };
            Some((edge, [self.bound(samples, before)?, self.bound(samples, k)?]))
        })
    }

    /// What the lines of the cell say about a position. One orientation an edge, at most.
    pub fn certainty(&self, samples: &[Sample], q: Site) -> Certainty {
        Certainty::of_signs(self.bounds(samples).map(|bound| bound.at(q)))
    }

    /// Keeps the lines that agree with the edge's sample. One orientation an edge, exact.
    ///
    /// # Errors
    /// [`CutError`], with the cell as it was.
    pub fn cut(&mut self, samples: &[Sample], edge: Edge) -> Result<Cut, CutError> {
        let Some(q) = samples.get(edge.index()).map(|s| s.site) else {
            return Err(CutError::Full);
        };
        let sign = i64::from(edge.label().sign());
        let agreement = |bound: Bound| sign * bound.at(q).signum();
        let n = self.edges.len();
        if n == 0 {
            return Err(CutError::Contradiction);
        }
        let mut before = self.bound(samples, n - 1).map_or(0, agreement);
        // The vertices that agree are consecutive, and an edge with one of them at an end stays:
        // from the edge that ends in the first of them to the edge that begins with the last.
        let (mut first, mut last, mut disagrees) = (None, None, false);
        for (k, bound) in self.bounds(samples).enumerate() {
            let after = agreement(bound);
            if before <= 0 && after > 0 {
                first = Some(k);
            }
            if before > 0 && after <= 0 {
                last = Some(k);
            }
            disagrees |= after < 0;
            before = after;
        }
        match (first, last) {
            _ if !disagrees => Ok(Cut::Unchanged),
            (Some(first), Some(last)) => {
                let kept = if first <= last { last - first + 1 } else { last + n - first + 1 };
                let around = self.edges.iter().cycle().skip(first).take(kept);
                let mut edges = Vec::new();
                for &edge in around.chain(core::iter::once(&edge)) {
                    edges.push(edge).map_err(|_| CutError::Full)?;
                }
                self.edges = edges;
                Ok(Cut::Smaller)
            }
            _ => Err(CutError::Contradiction),
        }
    }
}

impl<const E: usize> core::fmt::Debug for Cell<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list().entries(&self.edges).finish()
    }
}
