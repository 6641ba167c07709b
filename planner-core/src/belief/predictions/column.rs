//! The lines of one direction, as a distribution over their offsets.
//!
//! Each sample is a threshold: the lines at smaller offsets have it on their +1 side. So the density is constant
//! between neighbouring thresholds. At a threshold it is multiplied by the odds of the label there, or ends if the
//! label is certain.
//!
//! Where nobody knows the reliability of labels, the density is a function of the number of labels that agree ([`CountDensity`]).
//! At a threshold this number changes by one.
//!
//! A column stores knots on the cumulative mass, with straight lines between them. It stores every knot if there is
//! room, and otherwise the knots that separate the most mass.

use core::mem::{swap, take};

use crate::belief::list::List;
use crate::belief::reliability::Reliability;
use crate::belief::sample::Label;
use crate::belief::weight::LogWeight;
use crate::geometry::heading::SinCos;
use crate::geometry::lattice::Vector;

/// The factor by which a label multiplies the density of lines where the offset passes its site. It is a natural
/// logarithm in units of 2^-16. It is limited to the range of single precision, so 128 steps add up without overflow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LogStep(i32);

impl LogStep {
    /// A label that says nothing. All zeros in memory.
    pub(crate) const NONE: Self = Self(0);
    /// Certainly -1: no line at a smaller offset.
    const BEGIN: Self = Self(i32::MAX);
    /// Certainly +1: no line at a larger offset.
    const END: Self = Self(i32::MIN);

    /// That of a label of some reliability.
    pub(crate) fn of(label: Label, reliability: Reliability) -> Self {
        let is_above = label == Label::Positive;
        match (reliability.agree(), reliability.disagree()) {
            (Some(agree), Some(disagree)) if is_above => Self::by(disagree - agree),
            (Some(agree), Some(disagree)) => Self::by(agree - disagree),
            // Certainly true, or certainly false.
            (agree, _) if agree.is_some() == is_above => Self::END,
            _ => Self::BEGIN,
        }
    }

    /// By how much a doubtful label changes the number of labels that agree.
    pub(crate) fn counting(label: Label) -> Self {
        Self(if label == Label::Positive { -1 } else { 1 })
    }

    fn by(LogWeight(units): LogWeight) -> Self {
        const MOST: i64 = 80 << 16;
        Self((units >> 16).clamp(-MOST, MOST) as i32)
    }
}

/// The number whose logarithm is so many units of 2^-16.
pub(crate) fn exp(log: i32) -> f32 {
    LogWeight(i64::from(log) << 16).exp_single()
}

/// A label as the lines of some direction see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Threshold {
    site: Vector,
    step: LogStep,
    factor: f32,
    offset: i32,
}

impl Threshold {
    pub(crate) const NONE: Self =
        Self { site: Vector { x: 0, z: 0 }, step: LogStep::NONE, factor: 1.0, offset: 0 };

    /// That of a label at a place, as yet without an offset.
    pub(crate) fn new(site: Vector, step: LogStep) -> Self {
        let is_certain = step == LogStep::BEGIN || step == LogStep::END;
        let factor = if is_certain { 0.0 } else { exp(step.0) };
        Self { site, step, factor, offset: 0 }
    }

    /// That of a doubtful label at a place where labels are counted. The density has no factor there.
    pub(crate) fn counting(site: Vector, label: Label) -> Self {
        Self { site, step: LogStep::counting(label), factor: 0.0, offset: 0 }
    }
}

/// What the sum of the steps so far says of the density.
pub(crate) trait Density: Copy {
    /// The logarithm of the density, in units of 2^-16.
    fn log(self, sum: i32) -> i32;

    /// A sum and a density from which the steps go on, so that logarithms are less by `peak`.
    fn below(self, sum: i32, peak: i32) -> (i32, Self);
}

/// Steps are logarithms, so their sum is one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SumDensity;

impl Density for SumDensity {
    #[inline]
    fn log(self, sum: i32) -> i32 {
        sum
    }

    #[inline]
    fn below(self, sum: i32, peak: i32) -> (i32, Self) {
        (sum - peak, self)
    }
}

/// Steps count labels: the density is that of the number of labels that agree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CountDensity<'a> {
    /// Logarithms by the number of labels that agree, in units of 2^-16.
    pub(crate) logs: &'a [i32],
    /// The number of labels that agree with the lines at the smallest offsets.
    pub(crate) first: i32,
    pub(crate) peak: i32,
}

impl Density for CountDensity<'_> {
    fn log(self, sum: i32) -> i32 {
        self.logs.get((self.first + sum) as usize).map_or(i32::MIN / 2, |log| log - self.peak)
    }

    fn below(self, sum: i32, peak: i32) -> (i32, Self) {
        (sum, Self { peak: self.peak + peak, ..self })
    }
}

/// An offset, and the mass of the lines at smaller ones.
#[derive(Clone, Copy, Debug)]
struct Knot {
    offset: i32,
    below: f32,
}

impl Knot {
    const NONE: Self = Self { offset: 0, below: 0.0 };
    /// Beyond all offsets, which are upper words of products and below 2^29.5 in size.
    const BEYOND: i32 = 1 << 30;

    /// The knot after a piece of some density.
    fn up_to(self, offset: i32, density: f32) -> Self {
        Self { offset, below: self.below + density * (offset - self.offset) as f32 }
    }
}

/// Knots of a column. A power of two is the fastest to search. With twice as many the error of 16 directions
/// falls from 0.0074 to 0.0073 only.
const KNOTS: usize = 16;

/// The lines of one direction. 8 bytes, and 8 a knot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column {
    /// To the +1 side.
    normal: SinCos,
    /// By rising offset; those that are not needed lie beyond all places. No mass lies outside.
    knots: [Knot; KNOTS],
}

impl Column {
    /// No line. All zeros in memory.
    pub(crate) const NONE: Self = Self { normal: SinCos::ZERO, knots: [Knot::NONE; KNOTS] };

    /// The mass of its lines.
    pub(crate) fn mass(&self) -> f32 {
        self.knots.last().map_or(0.0, |knot| knot.below)
    }

    /// Multiplies the mass of all lines.
    #[inline(never)] // or it is unrolled twice
    pub(crate) fn scale(&mut self, by: f32) {
        self.knots.iter_mut().for_each(|knot| knot.below *= by);
    }

    /// The mass of the lines that have a place on their +1 side. Some 50 instructions.
    #[inline]
    pub(crate) fn mass_above(&self, place: Vector) -> f32 {
        let offset = self.normal.along(place);
        let after = self.knots.partition_point(|knot| knot.offset <= offset);
        let around = (self.knots.get(after.wrapping_sub(1)), self.knots.get(after));
        let (Some(low), Some(high)) = around else { return 0.0 }; // no line is as low
        let part = (offset - low.offset) as f32 / (high.offset - low.offset) as f32;
        low.below + part * (high.below - low.below)
    }

    /// The mass of the lines that have a place on their +1 side, or of all; then the sums of their offsets and of the
    /// squares of these. Offsets count from the middle of a stretch.
    #[inline(never)] // from two places, and not for speed
    pub(crate) fn moments_above(&self, place: Option<Vector>, middle: Vector) -> [f32; 3] {
        let (to, middle) = (place.map(|it| self.normal.along(it)), self.normal.along(middle));
        let mut sums = [0.0; 3];
        for pair in self.knots.windows(2) {
            let [low, high] = *pair else { break };
            let end = to.unwrap_or(high.offset).min(high.offset);
            let breadth = (high.offset - low.offset) as f32;
            if end <= low.offset || high.below <= low.below {
                continue;
            }
            let mass = (end - low.offset) as f32 / breadth * (high.below - low.below);
            let (a, b) = ((low.offset - middle) as f32, (end - middle) as f32);
            let more = [1.0, (a + b) * 0.5, (a * a + a * b + b * b) * (1.0 / 3.0)];
            sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += mass * more);
        }
        sums
    }

    /// By how much its direction is turned to the left of another, about, radians.
    pub(crate) fn turn_from(&self, other: SinCos) -> f32 {
        self.normal.turn_from(other.left())
    }

    /// Computes the column of a direction. The thresholds may come in any order. They are left sorted by offset, which
    /// is nearly the order for a direction close by.
    ///
    /// Returns the logarithm of the unit of its mass, on a scale common to all directions; `None` when there is no
    /// line.
    pub(crate) fn lay<const S: usize>(
        &mut self,
        direction: SinCos,
        thresholds: &mut List<Threshold, S>,
        density: impl Density,
    ) -> Option<i32> {
        *self = Self { normal: direction.left(), ..Self::NONE };
        for it in thresholds.iter_mut() {
            it.offset = self.normal.along(it.site);
        }
        sort(thresholds);
        let LinesBetween { bottom, from, inside, to } = LinesBetween::among(thresholds)?;
        // That of the pieces that have a width: between labels of one place there is no line.
        let (mut sum, mut at, mut peak) = (bottom, from, i32::MIN);
        for (offset, step) in inside.iter().map(|it| (it.offset, it.step.0)).chain([(to, 0)]) {
            if offset > at {
                peak = peak.max(density.log(sum));
            }
            (sum, at) = (sum + step, offset);
        }
        let mut knots: List<Knot, S> = List::filled(Knot::NONE);
        pile_up(&mut knots, density.below(bottom, peak), from, inside, to);
        self.keep(&knots);
        Some(peak)
    }

    /// Keeps as many of these knots as there is room for: all, or those between pieces of more and more mass.
    fn keep(&mut self, knots: &[Knot]) {
        let all = knots.last().map_or(0.0, |last| last.below);
        for parts in [f32::INFINITY, 64.0, 24.0, 12.0, 8.0, 4.0, 2.0, 1.0] {
            self.knots = [Knot { offset: Knot::BEYOND, below: all }; KNOTS];
            if self.keep_between(knots, all / parts) {
                return;
            }
        }
    }

    /// Keeps knots so that the pieces between them hold more than `least` mass each. Returns whether one place was left
    /// for the knot beyond all offsets.
    #[inline(never)] // or it is unrolled for each
    fn keep_between(&mut self, knots: &[Knot], least: f32) -> bool {
        let Some((&first, others)) = knots.split_first() else { return false };
        let (mut kept, mut last) = (first, first);
        let mut places = self.knots.iter_mut();
        let mut keep = |knot| places.next().map(|place| *place = knot).is_some();
        let mut has_room = keep(first);
        for &knot in others {
            if knot.below - kept.below > least && last.offset > kept.offset {
                has_room = keep(last);
                kept = last;
            }
            last = knot;
        }
        has_room && keep(last) && places.next().is_some()
    }
}

/// The lines that certain labels leave, among thresholds by rising offset.
struct LinesBetween<'a> {
    /// The sum of the steps where they begin, by the labels before.
    bottom: i32,
    /// Where they begin.
    from: i32,
    inside: &'a [Threshold],
    /// Where they end.
    to: i32,
}

impl<'a> LinesBetween<'a> {
    /// `None` if there are none.
    fn among(thresholds: &'a [Threshold]) -> Option<Self> {
        let begin = thresholds.iter().rposition(|it| it.step == LogStep::BEGIN)?;
        let end = thresholds.iter().position(|it| it.step == LogStep::END)?;
        let inside = thresholds.get(begin + 1..end)?;
        let [from, to] = [thresholds.get(begin)?.offset, thresholds.get(end)?.offset];
        let before = thresholds.iter().take(begin).filter(|it| it.step != LogStep::BEGIN);
        let bottom = before.map(|it| it.step.0).sum();
        (from < to).then_some(Self { bottom, from, inside, to })
    }
}

/// Adds knots where lines begin, at each threshold inside, and where they end. `sum` is that of the steps at the
/// beginning; the density is 1 at its maximum.
fn pile_up<const S: usize>(
    knots: &mut List<Knot, S>,
    (mut sum, scale): (i32, impl Density),
    from: i32,
    inside: &[Threshold],
    to: i32,
) {
    // There are no more than thresholds: none is refused.
    let mut add = |knot| {
        let _ = knots.push(knot);
    };
    let mut at = Knot { offset: from, below: 0.0 };
    let mut density = density_of(scale.log(sum));
    add(at);
    for it in inside {
        at = at.up_to(it.offset, density);
        add(at);
        sum += it.step.0;
        let next = density * it.factor;
        density = if next > NOTHING { next } else { density_of(scale.log(sum)) };
    }
    add(at.up_to(to, density));
}

/// Next to the highest, a density that is none.
const NOTHING: f32 = 1e-20;

fn density_of(log: i32) -> f32 {
    const LEAST: i32 = -(46 << 16); // about the same
    if log > LEAST { exp(log) } else { 0.0 }
}

/// By rising offset, one after the other, as they are nearly in order.
fn sort(thresholds: &mut [Threshold]) {
    for len in 2..=thresholds.len() {
        let mut head = thresholds.get_mut(..len).unwrap_or_default();
        while let [.., before, last] = head
            && before.offset > last.offset
        {
            swap(before, last);
            let Some((_, shorter)) = take(&mut head).split_last_mut() else { break };
            head = shorter;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::heading::Heading;

    /// Lines are at offsets from 0 to 100 quarters; the direction is that of the x axis.
    fn column(labels: &[(i32, Label, f64)]) -> (Column, i32) {
        let mut thresholds: List<Threshold, 40> = List::filled(Threshold::NONE);
        let ends = [(0, Label::Negative, 1.0), (100, Label::Positive, 1.0)];
        for &(offset, label, p) in labels.iter().chain(&ends) {
            let step = LogStep::of(label, Reliability::new(p).unwrap());
            let _ = thresholds.push(Threshold::new(Vector { x: 7, z: 4 * offset }, step));
        }
        let mut column = Column::NONE;
        let peak = column.lay(Heading(0).unit(), &mut thresholds, SumDensity).unwrap();
        (column, peak)
    }

    /// The density at an offset, from scratch.
    fn density(labels: &[(i32, Label, f64)], at: f64) -> f64 {
        let agrees = |offset: i32, label| (at < f64::from(offset)) == (label == Label::Positive);
        let factor = |&(offset, label, p)| if agrees(offset, label) { p } else { 1.0 - p };
        labels.iter().map(factor).product()
    }

    #[test]
    fn it_is_the_integral_of_the_likelihood() {
        use Label::{Negative, Positive};
        let labels = [
            (30, Positive, 0.7),
            (-5, Positive, 0.9),
            (60, Negative, 0.99),
            (30, Negative, 0.6),
            (105, Negative, 0.8),
            (20, Negative, 0.3),
        ];
        let (column, peak) = column(&labels);
        let below = |offset: i32| -> f64 {
            (0..offset).map(|n| density(&labels, f64::from(n) + 0.5)).sum()
        };
        for offset in -10..=110 {
            let exact = below(offset.clamp(0, 100)) / below(100);
            let got = column.mass_above(Vector { x: -3, z: 4 * offset }) / column.mass();
            assert!((f64::from(got) - exact).abs() < 1e-4, "{offset}: {got} for {exact}");
        }
        // Its unit is the likelihood at the smallest offsets, whatever label that violates.
        let scale = f64::from(column.mass() * exp(peak)) * density(&labels, -1e9) / below(100);
        assert!((scale - 1.0).abs() < 1e-3, "{scale}");
    }

    #[test]
    fn no_line_has_no_mass() {
        let mut thresholds: List<Threshold, 4> = List::filled(Threshold::NONE);
        for (z, label) in [(4, Label::Negative), (0, Label::Positive)] {
            let step = LogStep::of(label, Reliability::CERTAIN);
            let _ = thresholds.push(Threshold::new(Vector { x: 0, z }, step));
        }
        let mut column = Column::NONE;
        assert_eq!(column.lay(Heading(0).unit(), &mut thresholds, SumDensity), None);
        for z in [-9, 0, 9] {
            assert!(column.mass_above(Vector { x: 0, z }) <= 0.0);
        }
        assert!(column.mass() <= 0.0);
    }

    #[test]
    fn many_labels_are_told_by_few_knots() {
        let label = |n: i32| if n % 3 == 0 { Label::Positive } else { Label::Negative };
        let labels: [_; 36] = core::array::from_fn(|n| (3 * n as i32 - 4, label(n as i32), 0.6));
        let (column, _) = column(&labels);
        let below = |offset: i32| -> f64 {
            (0..offset).map(|n| density(&labels, f64::from(n) + 0.5)).sum()
        };
        for offset in 0..=100 {
            let got = f64::from(column.mass_above(Vector { x: 0, z: 4 * offset }) / column.mass());
            let off = got - below(offset) / below(100);
            assert!(off.abs() < 0.03, "{offset}: {off}");
        }
    }

    #[test]
    fn what_is_next_to_impossible_is_crossed() {
        // The line is below the one half of the labels or above the other; between it is hardly ever.
        let labels: [_; 36] = core::array::from_fn(|n| match n as i32 {
            n @ ..18 => (20 + n, Label::Positive, 0.999),
            n => (60 + n - 18, Label::Negative, 0.999),
        });
        let (column, _) = column(&labels);
        let above = |offset: i32| column.mass_above(Vector { x: 0, z: 4 * offset }) / column.mass();
        let exact = 20.0 / (20.0 + 23.0);
        for (offset, exact) in [(10, exact / 2.0), (40, exact), (89, exact + 12.0 / 43.0)] {
            assert!((above(offset) - exact).abs() < 0.01, "{offset}: {}", above(offset));
        }
    }
}
