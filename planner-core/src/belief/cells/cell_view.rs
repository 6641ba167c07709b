//! The lines that agree with some samples, and what can be read off them.
//!
//! A cell stores its edges only. A [`CellView`] is a cell together with the samples that its edges name.

use crate::belief::cells::constraint::Constraint;
use crate::belief::sample::{Label, Sample};
use crate::geometry::approximate::{single, sqrt};
use crate::geometry::arc::SlopeArc;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::line::Bound;

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
    /// The certainty at a position, from the value of each line there ([`Bound::at`]).
    pub(crate) fn of_values(values: impl Iterator<Item = i64>) -> Self {
        // Their sign bits, and those of their opposites: to compare 64-bit numbers costs more.
        let (mut below, mut above) = (0, 0);
        for value in values {
            below |= upper_half(value);
            above |= upper_half(value.wrapping_neg());
            if (below & above) < 0 {
                return Self::Uncertain;
            }
        }
        Self::Certain(if below < 0 { Label::Negative } else { Label::Positive })
    }
}

/// The number of edges from one to another in cyclic order, both included; `all` is the number of edges.
pub(crate) const fn run_length(first: usize, last: usize, all: usize) -> usize {
    if first <= last { last - first + 1 } else { last + all - first + 1 }
}

const fn upper_half(value: i64) -> i32 {
    (value >> 32) as i32
}

/// The edges that stay when a cell keeps the lines that label a site in one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    /// All: all lines do already.
    All,
    /// Those from one edge to another in cyclic order; the site's own edge comes after the last.
    Between {
        /// Where they begin.
        first: usize,
        /// Where they end, itself included.
        last: usize,
    },
    /// None: no line does.
    None,
}

/// The lines that agree with some samples, each with the label that its edge gives it. The version
/// space is such a set; so is each hypothesis.
#[derive(Clone, Copy, Debug)]
pub struct CellView<'a> {
    /// The samples that matter, in cyclic order.
    pub edges: &'a [Constraint],
    /// The buffer whose indices the edges are.
    pub samples: &'a [Sample],
    /// The displacement by which a further sample of label +1 is shifted when it is taken in. A sample of label -1 is
    /// shifted the opposite way: see [`Tolerance`](crate::belief::tolerance::Tolerance).
    pub shift: Vector,
    /// Whether a place is worth a label as soon as one of the two labels could cut there. If not set, both must.
    pub is_loose: bool,
}

impl<'a> CellView<'a> {
    /// The vertex after the `k`-th edge.
    fn bound(self, k: usize) -> Option<Bound> {
        let i = *self.edges.get(k)?;
        let j = *self.edges.get(k + 1).or(self.edges.first())?;
        let (p, q) = (self.samples.get(i.index())?.site, self.samples.get(j.index())?.site);
        Some(Bound { through: p, along: if i.label() == j.label() { q - p } else { p - q } })
    }

    /// The vertices: the lines through two samples that bound the set, in cyclic order.
    pub fn bounds(self) -> impl Iterator<Item = Bound> + Clone + 'a {
        (0..self.edges.len()).filter_map(move |k| self.bound(k))
    }

    /// Whether all these lines give a position the same label, and which. One orientation an
    /// edge, at most.
    pub fn certainty(self, q: Site) -> Certainty {
        certainty(self.edges, self.samples, q)
    }

    /// The same lines with [`is_loose`](Self::is_loose) set.
    pub(crate) const fn loosely(self) -> Self {
        Self { is_loose: true, ..self }
    }

    /// Whether a label read at a position is worth it: the lines disagree there, and also at the places where a label
    /// of either sign would be taken in. If [`is_loose`](Self::is_loose) is set, one of these places is enough.
    pub fn can_cut(self, q: Site) -> bool {
        let is_uncertain =
            |by| q.step(by).is_ok_and(|place| self.certainty(place) == Certainty::Uncertain);
        let mut shifts = [self.shift, self.shift.reversed()].into_iter();
        is_uncertain(Vector::default())
            && match self {
                Self { shift: Vector { x: 0, z: 0 }, .. } => true,
                Self { is_loose: true, .. } => shifts.any(is_uncertain),
                _ => shifts.all(is_uncertain),
            }
    }

    /// Whether a label read at a position may tell something new. Where positions err, it is enough that a label of one
    /// sign could cut, and no label nearby may have told the same.
    pub(crate) fn may_tell(self, q: Site) -> bool {
        self.loosely().can_cut(q)
            && (self.shift == Vector::default()
                || !self.samples.iter().any(|it| self.is_told(q, it)))
    }

    /// Whether a sample already says what its label would say at a position. It does if it was taken in within the
    /// position error of the place where that label would be taken in.
    fn is_told(self, q: Site, sample: &Sample) -> bool {
        self.place(q, sample.label).is_some_and(|place| {
            let off = place - sample.site;
            off.dot(off) < self.shift.dot(self.shift)
        })
    }

    /// From a position where [no label is worth it](Self::can_cut), a distance within which this holds everywhere;
    /// lattice units. It is computed in single precision and never too large.
    pub(crate) fn dull_within(self, q: Site) -> f32 {
        let certain_within = |by: Vector| {
            let place = q.step(by).ok();
            place.map_or(0.0, |place| self.certain_within(place))
        };
        let here = certain_within(Vector::default());
        if self.shift == Vector::default() {
            return here;
        }
        let [a, b] = [self.shift, self.shift.reversed()].map(certain_within);
        let shifted = if (a < b) == self.is_loose { a } else { b };
        if here > shifted { here } else { shifted }
    }

    /// Within this distance of a position all lines agree as they do there; 0 where they do not.
    pub(crate) fn certain_within(self, q: Site) -> f32 {
        let (mut least, mut signs) = (f32::INFINITY, [false; 2]);
        for bound in self.bounds() {
            let value = bound.at(q);
            let [below, above] = &mut signs;
            *below |= value < 0;
            *above |= value > 0;
            let distance = single(value).abs() / sqrt(single(bound.along.dot(bound.along)));
            least = if distance < least { distance } else { least };
        }
        let least = 0.999 * least - 2.0;
        if signs == [true; 2] || least < 0.0 { 0.0 } else { least }
    }

    /// Where a label read at a position is taken in; `None` off the lattice, where it tells nothing.
    pub(crate) fn place(self, q: Site, label: Label) -> Option<Site> {
        let towards = label == Label::Positive;
        q.step(if towards { self.shift } else { self.shift.reversed() }).ok()
    }

    /// On which side of the vertex before each edge a position lies: [`Bound::at`], by the turn from
    /// one sample to the next as they are seen from there.
    pub(crate) fn turns(self, q: Site) -> impl Iterator<Item = i64> + 'a {
        let seen = move |edge: &Constraint| edge.seen(self.samples, q);
        let mut before = self.edges.last().map(seen).unwrap_or_default();
        self.edges.iter().map(move |edge| {
            let after = seen(edge);
            core::mem::replace(&mut before, after).cross(after)
        })
    }

    /// Which edges stay when those lines are kept that give a site this label. The vertices that agree
    /// are consecutive, and an edge stays if the vertex at one of its ends does.
    pub(crate) fn kept(self, site: Site, label: Label) -> Kept {
        let mut one_disagrees = false;
        let mut agreements = self.turns(site).map(|turn| {
            let turn = if label == Label::Positive { turn } else { -turn };
            one_disagrees |= turn < 0;
            turn > 0
        });
        let Some(start) = agreements.next() else { return Kept::None };
        let (mut first, mut last, mut before) = (None, None, start);
        for k in 0..self.edges.len() {
            let after = agreements.next().unwrap_or(start);
            if after != before {
                *(if after { &mut first } else { &mut last }) = Some(k);
            }
            before = after;
        }
        match (first, last) {
            _ if !one_disagrees => Kept::All,
            (Some(first), Some(last)) => Kept::Between { first, last },
            _ => Kept::None,
        }
    }

    /// The directions of the lines left: the paper's `E_rho,t`.
    #[inline(never)] // in several places, and not for speed
    pub fn slope_arc(self) -> SlopeArc {
        SlopeArc::spanning(self.bounds().map(|bound| bound.along)).unwrap_or_default()
    }

    /// The range of the intercepts of the lines left, metres: the paper's `I_c,t`. `None` when a vertical line is among
    /// them, so that the range is unbounded.
    pub fn intercepts(self) -> Option<[f64; 2]> {
        intercepts(self.bounds())
    }

    /// The samples that still matter, with the labels that the cell gives them: the others follow
    /// from these.
    pub fn support(self) -> impl Iterator<Item = Sample> + Clone + 'a {
        (0..self.edges.len()).filter_map(move |k| self.sample(k))
    }

    /// The `k`-th of them.
    pub(crate) fn sample(self, k: usize) -> Option<Sample> {
        let edge = self.edges.get(k)?;
        let site = self.samples.get(edge.index())?.site;
        Some(Sample { site, label: edge.label() })
    }
}

/// [`CellView::certainty`], in one place and with its arguments in registers.
#[inline(never)]
fn certainty(edges: &[Constraint], samples: &[Sample], q: Site) -> Certainty {
    let lines = CellView { edges, samples, shift: Vector::default(), is_loose: false };
    Certainty::of_values(lines.turns(q))
}

/// The range of intercepts between the vertices of a set of lines, metres; `None` when a vertical line lies
/// among them, or there are none.
pub(crate) fn intercepts(bounds: impl IntoIterator<Item = Bound>) -> Option<[f64; 2]> {
    let mut bounds = bounds.into_iter().peekable();
    let rightward = bounds.peek()?.along.x.signum();
    bounds.try_fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], bound| {
        let c = bound.intercept()?;
        (bound.along.x.signum() == rightward).then(|| [low.min(c), high.max(c)])
    })
}
