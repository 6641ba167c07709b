//! Intervals of single-precision numbers, such as the part of a line that half-planes leave.
//!
//! By comparisons, not by `f32::min` and `f32::max`: chips without these instructions call a function for each.

/// The numbers from `low` to `high`; none if `low` is above `high`. What is no number changes nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub(crate) low: f32,
    pub(crate) high: f32,
}

impl Span {
    /// All numbers.
    pub(crate) const ALL: Self = Self { low: f32::NEG_INFINITY, high: f32::INFINITY };
    /// No number.
    pub(crate) const NONE: Self = Self { low: f32::INFINITY, high: f32::NEG_INFINITY };

    /// The part of the line `base + t way` inside a rectangle, as numbers `t`.
    pub(crate) fn inside(base: [f32; 2], way: [f32; 2], from: [f32; 2], to: [f32; 2]) -> Self {
        let mut span = Self::ALL;
        for (((base, way), from), to) in base.into_iter().zip(way).zip(from).zip(to) {
            let (a, b) = ((from - base) / way, (to - base) / way);
            let (a, b) = if a < b { (a, b) } else { (b, a) };
            span.keep_above(a);
            span.keep_below(b);
        }
        span
    }

    /// The least span that has these numbers in it.
    pub(crate) fn of(numbers: impl Iterator<Item = f32>) -> Self {
        let mut span = Self::NONE;
        numbers.for_each(|number| span.add(number));
        span
    }

    /// Widens it to a number.
    pub(crate) fn add(&mut self, number: f32) {
        if number < self.low {
            self.low = number;
        }
        if number > self.high {
            self.high = number;
        }
    }

    /// Leaves out all below a number.
    pub(crate) fn keep_above(&mut self, number: f32) {
        if number > self.low {
            self.low = number;
        }
    }

    /// Leaves out all above a number.
    pub(crate) fn keep_below(&mut self, number: f32) {
        if number < self.high {
            self.high = number;
        }
    }

    /// Whether there is no number in it.
    pub(crate) fn is_empty(self) -> bool {
        self.low > self.high
    }

    pub(crate) fn contains(self, number: f32) -> bool {
        self.low <= number && number <= self.high
    }

    /// The number in it that is nearest to one.
    pub(crate) fn nearest(self, number: f32) -> f32 {
        match () {
            () if number < self.low => self.low,
            () if number > self.high => self.high,
            () => number,
        }
    }

    pub(crate) fn width(self) -> f32 {
        self.high - self.low
    }
}
