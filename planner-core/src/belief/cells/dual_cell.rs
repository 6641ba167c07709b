//! A cell of lines, stored as a cyclic list of signed sample indices of one byte each.
//!
//! The *dual* space is that of homogeneous lines `(A, B, C)`. There a sample `(x, z)` with label `y` admits the
//! half-space `y (A x + B z + C) >= 0`. So the lines that agree with a set of samples form a convex cone. Seen as a
//! polygon, each *edge* of the cone belongs to a sample that still matters; [`Constraint`] is the type of an edge. Each
//! *vertex*, between two edges, is the line through their two samples: a [`Bound`](crate::geometry::line::Bound). The
//! list of samples therefore describes the whole cell, and one predicate,
//! [`Bound::at`](crate::geometry::line::Bound::at), decides every question about it.
//!
//! A cell does not contain the samples, so several cells can share one buffer of them.

use crate::belief::cells::cell_view::{CellView, Kept, run_length};
use crate::belief::cells::constraint::Constraint;
use crate::belief::sample::Sample;
use crate::geometry::lattice::{Vector, orient};

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

impl core::fmt::Display for CutError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Contradiction => "no line of the cell agrees with the sample",
            Self::Full => "the cell cannot hold another edge",
        })
    }
}

impl core::error::Error for CutError {}

/// A convex cell of lines with up to `E` edges. `E + 1` bytes.
///
/// `samples` in every method is the buffer of samples to which the indices of the edges refer.
#[derive(Clone, Copy)]
pub struct DualCell<const E: usize> {
    /// In cyclic order, from the first on.
    edges: [Constraint; E],
    len: u8,
}

impl<const E: usize> DualCell<E> {
    /// No line at all: a cell without edges.
    pub(crate) const NONE: Self = Self { edges: [Constraint::NONE; E], len: 0 };

    /// The lines that agree with three samples; `None` when these are collinear.
    pub fn triangle(samples: &[Sample], [i, j, k]: [Constraint; 3]) -> Option<Self> {
        const { assert!(E >= 3, "a cell has at least three edges") };
        let site = |edge: Constraint| samples.get(edge.index()).map(|s| s.site);
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
    fn of(edges: &[Constraint]) -> Option<Self> {
        let mut cell = Self { len: u8::try_from(edges.len()).ok()?, ..Self::NONE };
        cell.edges.get_mut(..edges.len())?.copy_from_slice(edges);
        Some(cell)
    }

    /// Follows a buffer from which the sample at `index` is removed, which is none of the edges.
    pub(crate) fn forget(&mut self, index: usize) {
        for edge in &mut self.edges {
            *edge = edge.without(index);
        }
    }

    /// The same cell with another capacity; `None` when its edges do not fit.
    pub(crate) fn resized<const F: usize>(&self) -> Option<DualCell<F>> {
        DualCell::of(self.edges())
    }

    /// The samples that still matter, in cyclic order.
    pub fn edges(&self) -> &[Constraint] {
        self.edges.get(..usize::from(self.len)).unwrap_or(&[])
    }

    /// The lines, beside the samples that the edges name.
    pub fn lines<'a>(&'a self, samples: &'a [Sample]) -> CellView<'a> {
        CellView { edges: self.edges(), samples, shift: Vector::default(), is_loose: false }
    }

    /// Keeps the lines that agree with the edge's sample. Exact; it costs one orientation for each edge of the cell.
    ///
    /// # Errors
    /// [`CutError`], with the cell as it was.
    pub fn cut(&mut self, samples: &[Sample], edge: Constraint) -> Result<Cut, CutError> {
        let site = samples.get(edge.index()).ok_or(CutError::Full)?.site;
        let (first, last) = match self.lines(samples).kept(site, edge.label()) {
            Kept::All => return Ok(Cut::Unchanged),
            Kept::None => return Err(CutError::Contradiction),
            Kept::Between { first, last } => (first, last),
        };
        let n = self.edges().len();
        let kept = run_length(first, last, n);
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

impl<const E: usize> PartialEq for DualCell<E> {
    fn eq(&self, other: &Self) -> bool {
        self.edges() == other.edges()
    }
}

impl<const E: usize> Eq for DualCell<E> {}

impl<const E: usize> core::fmt::Debug for DualCell<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list().entries(self.edges()).finish()
    }
}
