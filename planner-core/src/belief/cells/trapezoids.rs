//! A cell of lines as trapezoids, by direction.
//!
//! The offsets of all lines of a cell with the same direction fill an interval. Each end of it is the line through a
//! sample. The sample labelled +1 lies above all these lines, and the one labelled -1 lies below. The direction turns
//! from the first of the cell to the last. Meanwhile the sample above runs through those labelled +1 in the cell's
//! cyclic order, and the sample below runs through the others against that order. Between two directions where either
//! sample changes lies a trapezoid of lines: it has the same two samples throughout.
//!
//! So a sum over a cell has only positive terms. The terms are made from the widths at a trapezoid's ends, and these
//! are exact integers over lengths. No digits cancel, however thin the cell is.

use crate::belief::cells::cell_view::CellView;
use crate::belief::sample::{Label, Sample};
use crate::geometry::approximate::{METRE, UnitVector, cross};
use crate::geometry::lattice::{Site, Vector};

/// The lines of a cell between two directions, whose offsets lie between those of two samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trapezoid {
    /// Where it begins: the direction of a vertex of the cell.
    pub(crate) from: Vector,
    /// Where it ends: that of the next, less than half a turn to the left.
    pub(crate) to: Vector,
    /// The sample above all its lines.
    pub(crate) above: Site,
    /// The sample below all its lines.
    pub(crate) below: Site,
}

impl Trapezoid {
    /// From the sample below to the one above.
    pub(crate) fn across(&self) -> Vector {
        self.above - self.below
    }

    /// The width of the interval of offsets at the trapezoid's end, lattice units; `to` is the unit vector there.
    pub(crate) fn width_at_end(&self, to: UnitVector) -> f32 {
        cross(self.to, self.across()) * to.per_length
    }
}

/// The trapezoids of a cell, from the first direction to the last. The cell's samples in cyclic order are a
/// function of their place.
#[derive(Clone)]
pub(crate) struct Trapezoids<F> {
    sample: F,
    len: usize,
    above: (usize, Site),
    below: (usize, Site),
    /// Where the next begins; `None` after the last.
    from: Option<Vector>,
}

impl<F: Fn(usize) -> Option<Sample>> Trapezoids<F> {
    /// Of a cell of so many samples; `None` if not both labels are among them, so that there is no cell.
    pub(crate) fn of(len: usize, sample: F) -> Option<Self> {
        let is = |k, label| sample(k).filter(|s| s.label == label).map(|s| (k, s.site));
        let ends = |k| is(k, Label::Negative).zip(is(after(k, len), Label::Positive));
        let (below, above) = (0..len).find_map(ends)?;
        Some(Self { sample, len, above, below, from: Some(below.1 - above.1) })
    }

    /// The samples of the cell.
    pub(crate) fn sites(&self) -> impl Iterator<Item = Site> + '_ {
        (0..self.len).filter_map(|k| (self.sample)(k)).map(|s| s.site)
    }

    fn labelled(&self, k: usize, label: Label) -> Option<(usize, Site)> {
        (self.sample)(k).filter(|s| s.label == label).map(|s| (k, s.site))
    }

    /// As `next`, compiled into its caller: for where speed counts.
    #[inline]
    fn step(&mut self) -> Option<Trapezoid> {
        let from = self.from?;
        let (above, below) = (self.above.1, self.below.1);
        let next_above = self.labelled(after(self.above.0, self.len), Label::Positive);
        let next_below = self.labelled(before(self.below.0, self.len), Label::Negative);
        // The vertices at which the one or the other sample changes.
        let left_of_above = next_above.map(|(_, next)| next - above);
        let left_of_below = next_below.map(|(_, next)| below - next);
        let above_changes = match (left_of_above, left_of_below) {
            (Some(one), Some(other)) => one.cross(other) > 0,
            (one, _) => one.is_some(),
        };
        self.from = if above_changes { left_of_above } else { left_of_below };
        if above_changes {
            self.above = next_above.unwrap_or(self.above);
        } else {
            self.below = next_below.unwrap_or(self.below);
        }
        Some(Trapezoid { from, to: self.from.unwrap_or(above - below), above, below })
    }
}

impl<F: Fn(usize) -> Option<Sample>> Iterator for Trapezoids<F> {
    type Item = Trapezoid;

    #[inline(never)] // in several places of the estimates
    fn next(&mut self) -> Option<Trapezoid> {
        self.step()
    }
}

/// The next place in a cycle of so many.
const fn after(k: usize, len: usize) -> usize {
    if k + 1 == len { 0 } else { k + 1 }
}

/// The place before.
const fn before(k: usize, len: usize) -> usize {
    if k == 0 { len - 1 } else { k - 1 }
}

impl<'a> CellView<'a> {
    /// The trapezoids of these lines.
    pub(crate) fn trapezoids(
        self,
    ) -> Option<Trapezoids<impl Fn(usize) -> Option<Sample> + Clone + 'a>> {
        Trapezoids::of(self.edges.len(), move |k| self.sample(k))
    }
}

/// The measure of a cell, d(angle) d(offset): radian metres, to 10^-6 of itself. No motion of the plane
/// changes it.
///
/// In a trapezoid the width of the interval of offsets is a sinusoid of the direction. If the direction turns by `t`,
/// its integral is `tan(t/2)` times the sum of the widths at both ends.
pub(crate) fn measure<F: Fn(usize) -> Option<Sample>>(mut trapezoids: Trapezoids<F>) -> f32 {
    let Some(first) = trapezoids.from else { return 0.0 };
    let (mut begins, mut width, mut sum) = (UnitVector::of(first), 0.0, 0.0);
    while let Some(trapezoid) = trapezoids.step() {
        let ends = UnitVector::of(trapezoid.to);
        let sin = cross(trapezoid.from, trapezoid.to) * (begins.per_length * ends.per_length);
        let cos = begins.dot(ends);
        let tan_half = if cos >= 0.0 { sin / (1.0 + cos) } else { (1.0 - cos) / sin };
        let width_at_end = trapezoid.width_at_end(ends);
        sum += tan_half * (width + width_at_end);
        (begins, width) = (ends, width_at_end);
    }
    sum * METRE
}
