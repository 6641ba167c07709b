//! A cell of candidate lines: a cyclic list of signed sample indices, one byte each.
//!
//! In the space of homogeneous lines `(A, B, C)` a sample `(x, z)` with label `y` admits the
//! half-space `y (A x + B z + C) >= 0`. The lines that agree with a set of samples are a convex
//! cone; seen as a polygon, each *edge* belongs to a sample that still matters and each *vertex*,
//! between two edges, is the line through their two samples: a [`Bound`](crate::geometry::line::Bound). So a list of samples says
//! it all, and one predicate, [`Bound::at`](crate::geometry::line::Bound::at), decides every question about it.
//!
//! A cell does not hold the samples: several cells can share one buffer of sites.

use crate::belief::candidates::Candidates;
use crate::belief::sample::{Label, Sample};
use crate::geometry::lattice::{Site, Vector, orient};

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

    /// The sample as seen from `q`, on the other side of it if its label is negative.
    pub(crate) fn seen(self, samples: &[Sample], q: Site) -> Vector {
        let seen = samples.get(self.index()).map(|s| s.site - q).unwrap_or_default();
        if self.label() == Label::Positive { seen } else { seen.reversed() }
    }
}

impl core::fmt::Debug for Edge {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let sign = if self.label() == Label::Positive { '+' } else { '-' };
        write!(f, "{sign}{}", self.index())
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
#[derive(Clone, Copy)]
pub struct Cell<const E: usize> {
    /// In cyclic order, from the first on.
    edges: [Edge; E],
    len: u8,
}

impl<const E: usize> Cell<E> {
    /// No line at all: a cell without edges.
    pub(crate) const NONE: Self = Self { edges: [Edge(0); E], len: 0 };

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
        Self::of(&ordered)
    }

    /// The cell with these edges; `None` when they do not fit.
    fn of(edges: &[Edge]) -> Option<Self> {
        let mut cell = Self { len: u8::try_from(edges.len()).ok()?, ..Self::NONE };
        cell.edges.get_mut(..edges.len())?.copy_from_slice(edges);
        Some(cell)
    }

    /// The same cell with another capacity; `None` when its edges do not fit.
    pub(crate) fn resized<const F: usize>(&self) -> Option<Cell<F>> {
        Cell::of(self.edges())
    }

    /// The samples that still matter, in cyclic order.
    pub fn edges(&self) -> &[Edge] {
        self.edges.get(..usize::from(self.len)).unwrap_or(&[])
    }

    /// The lines, beside the samples that the edges name.
    pub fn candidates<'a>(&'a self, samples: &'a [Sample]) -> Candidates<'a> {
        Candidates { edges: self.edges(), samples }
    }

    /// Keeps the lines that agree with the edge's sample. One orientation an edge, exact.
    ///
    /// # Errors
    /// [`CutError`], with the cell as it was.
    pub fn cut(&mut self, samples: &[Sample], edge: Edge) -> Result<Cut, CutError> {
        let Some([first, last]) = agreeing(self.candidates(samples), edge)? else {
            return Ok(Cut::Unchanged);
        };
        let n = self.edges().len();
        let kept = if first <= last { last - first + 1 } else { last + n - first + 1 };
        let mut cell = Self { len: kept as u8 + 1, ..Self::NONE };
        *cell.edges.get_mut(kept).ok_or(CutError::Full)? = edge;
        let mut k = first;
        for place in cell.edges.iter_mut().take(kept) {
            *place = self.edges.get(k).copied().unwrap_or(edge);
            k = if k + 1 == n { 0 } else { k + 1 };
        }
        *self = cell;
        Ok(Cut::Smaller)
    }
}

/// The first and the last edge that stay when a cell keeps the lines that agree with an edge's
/// sample; `None` when all do.
fn agreeing(whole: Candidates<'_>, edge: Edge) -> Result<Option<[usize; 2]>, CutError> {
    let Some(q) = whole.samples.get(edge.index()).map(|s| s.site) else {
        return Err(CutError::Full);
    };
    let mut disagrees = false;
    let mut agreements = whole.turns(q).map(|turn| {
        let turn = if edge.label() == Label::Positive { turn } else { -turn };
        disagrees |= turn < 0;
        turn > 0
    });
    let Some(start) = agreements.next() else {
        return Err(CutError::Contradiction);
    };
    // The vertices that agree are consecutive, and an edge with one of them at an end stays: from
    // the edge that ends in the first of them to the edge that begins with the last.
    let (mut first, mut last) = (None, None);
    let mut before = start;
    for k in 0..whole.edges.len() {
        let after = agreements.next().unwrap_or(start);
        if !before && after {
            first = Some(k);
        }
        if before && !after {
            last = Some(k);
        }
        before = after;
    }
    match (first, last) {
        _ if !disagrees => Ok(None),
        (Some(first), Some(last)) => Ok(Some([first, last])),
        _ => Err(CutError::Contradiction),
    }
}

impl<const E: usize> PartialEq for Cell<E> {
    fn eq(&self, other: &Self) -> bool {
        self.edges() == other.edges()
    }
}

impl<const E: usize> Eq for Cell<E> {}

impl<const E: usize> core::fmt::Debug for Cell<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list().entries(self.edges()).finish()
    }
}
