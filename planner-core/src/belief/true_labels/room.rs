//! Which sample can go when the buffer is full, so that what is known stays the same.
//!
//! The lines left follow from the samples that bound them. Every other sample lies in certain ground. The given samples
//! stay as well: what was learnt is measured from them, and snapshots begin with them.
//!
//! Of the others, the paper's bisector needs the two shortest pairs of opposite labels. A further label can shorten
//! these. A new pair that ends at some sample is no longer than the second pair is now, and its other end has the
//! opposite label. So a sample that lies deeper in certain ground than the second pair is long is in no later pair. The
//! one that lies deepest goes.

use crate::belief::cells::{CellView, Certainty};
use crate::belief::estimate::shortest_pairs;
use crate::belief::sample::Sample;

/// What can go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spare {
    /// The sample at this index.
    Stored(usize),
    /// The new one, with which all lines agree.
    New,
    /// No line agrees with the new one.
    Contradiction,
    /// Nothing.
    None,
}

/// The sample that matters least, of those in the buffer of some lines and a new one. The first ones are `given`.
#[inline(never)] // one for all capacities
pub(super) fn spare(lines: CellView<'_>, given: usize, new: Sample) -> Spare {
    let certainty = lines.certainty(new.site);
    let is_certain = certainty != Certainty::Uncertain;
    if is_certain && certainty != Certainty::Certain(new.label) {
        return Spare::Contradiction;
    }
    let pairs = shortest_pairs(lines.samples, Some(new));
    let is_in_a_pair =
        |sample: &Sample| pairs.iter().flatten().flatten().any(|it| *it == sample.site);
    let worth = |sample: &Sample| {
        let depth = lines.certain_within(sample.site);
        if is_in_a_pair(sample) { depth - f32::MAX } else { depth }
    };
    let bounds = |index: usize| lines.edges.iter().any(|edge| edge.index() == index);
    let stored = lines.samples.iter().enumerate().skip(given).filter(|(index, _)| !bounds(*index));
    let new = is_certain.then(|| (Spare::New, worth(&new)));
    let all = stored.map(|(index, sample)| (Spare::Stored(index), worth(sample)));
    let mut deepest = (Spare::None, f32::NEG_INFINITY);
    for (which, depth) in all.chain(new) {
        if depth > deepest.1 {
            deepest = (which, depth);
        }
    }
    deepest.0
}
