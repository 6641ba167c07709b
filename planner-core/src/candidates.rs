//! Candidate lines: a cell beside the samples it names, and what can be read off the two.

use crate::cell::{Cell, Certainty};
use crate::direction::Arc;
use crate::lattice::Site;
use crate::line::Bound;
use crate::sample::Sample;

/// A view of a cell and its samples. The version space is one; so is each hypothesis.
#[derive(Clone, Copy, Debug)]
pub struct Candidates<'a, const E: usize> {
    /// The polygon of lines.
    pub cell: &'a Cell<E>,
    /// The buffer whose indices its edges are.
    pub samples: &'a [Sample],
}

impl<'a, const E: usize> Candidates<'a, E> {
    /// The vertices, in cyclic order.
    pub fn bounds(self) -> impl Iterator<Item = Bound> + 'a {
        self.cell.bounds(self.samples)
    }

    /// Whether all candidate lines give a position the same label, and which.
    pub fn certainty(self, q: Site) -> Certainty {
        self.cell.certainty(self.samples, q)
    }

    /// The directions of the candidate lines: the paper's `E_rho,t`.
    pub fn slope_arc(self) -> Arc {
        Arc::spanning(self.bounds().map(|bound| bound.along)).unwrap_or_default()
    }

    /// The range of the candidate lines' intercepts in metres, the paper's `I_c,t`; `None` when it
    /// is unbounded, as a vertical line is among them.
    pub fn intercepts(self) -> Option<[f64; 2]> {
        intercepts(self.bounds())
    }

    /// The samples that still matter, with the labels that the cell gives them: the others follow
    /// from these.
    pub fn support(self) -> impl Iterator<Item = Sample> + Clone + 'a {
        self.cell.edges().iter().filter_map(move |edge| {
            let site = self.samples.get(edge.index())?.site;
            Some(Sample { site, label: edge.label() })
        })
    }
}

/// The range of intercepts between vertices of candidates, metres; `None` when a vertical line lies
/// among them, or there are none.
pub(crate) fn intercepts(bounds: impl IntoIterator<Item = Bound>) -> Option<[f64; 2]> {
    let mut bounds = bounds.into_iter().peekable();
    let rightward = bounds.peek()?.along.x.signum();
    bounds.try_fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], bound| {
        let c = bound.intercept()?;
        (bound.along.x.signum() == rightward).then(|| [low.min(c), high.max(c)])
    })
}
