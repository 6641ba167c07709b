//! How much of a column lies below a place: whole cells, and a part of those that the place cuts.

use crate::belief::front::lay::{Lay, Unit};
use crate::geometry::approximate::sqrt;

impl Lay {
    /// The ramp of a column for a place that errs by `blur` either way, metres.
    pub(crate) fn ramp(self, along: Unit, bend: f32, place: [f32; 2], blur: f32) -> Ramp {
        let [ahead, left] = along.seen(place);
        let per_cell = 1.0 / self.step;
        let off = (left - self.bulge(bend, ahead) - self.low) * per_cell;
        let tilt = ahead * self.turn * per_cell;
        let width = sqrt(1.0 + tilt * tilt) + 2.0 * blur * per_cell;
        // A cell's number is that of its lower edge, and its curves lie about its middle.
        Ramp { place: off - 0.5 + 0.5 * width, width, per_width: 1.0 / width }
    }
}

/// The share of a cell's curves that have a place on their +1 side, by the number of the cell.
#[derive(Clone, Copy)]
pub(crate) struct Ramp {
    place: f32,
    width: f32,
    per_width: f32,
}

impl Ramp {
    /// The same for a place that lies so many cells lower.
    pub(crate) fn lower(self, cells: f32) -> Self {
        Self { place: self.place - cells, ..self }
    }

    /// The share of a cell that counts in part.
    fn at(self, cell: f32) -> f32 {
        (self.place - cell) * self.per_width
    }

    /// So many of a column's first cells lie below in full, and so many more in part.
    fn counts(self, cells: usize) -> [usize; 2] {
        // Conversions are saturating.
        let until = |place: f32| if place >= 0.0 { (place as usize).saturating_add(1) } else { 0 };
        let whole = until(self.place - self.width).min(cells);
        [whole, until(self.place).min(cells).saturating_sub(whole)]
    }

    /// As [`below`](Self::below), of a column's [`slopes`].
    pub(crate) fn below_slopes(self, slopes: &[f32]) -> f32 {
        let end = slopes.len().saturating_sub(1);
        let at = |number: usize| slopes.get(number).copied().unwrap_or(0.0);
        // Before the first cell's end there is nothing.
        let before = |cell: usize| cell.checked_sub(1).map_or(0.0, at);
        let until = |place: f32| {
            let cell = (place as usize).min(end);
            let low = before(cell);
            if place > 0.0 { low + (place - cell as f32) * (at(cell) - low) } else { 0.0 }
        };
        let first = self.place - self.width;
        if first >= end as f32 {
            return at(end) - before(end);
        }
        (until(self.place) - until(first)) * self.per_width
    }

    /// Multiplies the mass of a column that lies below by one number, and the rest by another. Returns what is left.
    #[inline(never)]
    pub(crate) fn weigh(self, column: &mut [f32], [plus, minus]: [f32; 2]) -> f32 {
        let [whole, part] = self.counts(column.len());
        let (whole, rest) = column.split_at_mut_checked(whole).unwrap_or_default();
        let (part, rest) = rest.split_at_mut_checked(part).unwrap_or_default();
        let (mut sum, mut cell) = (0.0, whole.len() as f32);
        for mass in whole {
            *mass *= plus;
            sum += *mass;
        }
        for mass in part {
            *mass *= minus + (plus - minus) * self.at(cell);
            sum += *mass;
            cell += 1.0;
        }
        for mass in rest {
            *mass *= minus;
            sum += *mass;
        }
        sum
    }

    /// The mass of a column that lies below: that of each cell, by its share.
    ///
    /// A plan asks it some 4,000 times. By [`counts`](Self::counts) it would take 6 % more instructions.
    pub(crate) fn below(self, column: &[f32]) -> f32 {
        if self.place <= 0.0 {
            return 0.0;
        }
        // The first cells count in full, and those up to the last in part. Conversions are saturating.
        let first = self.place - self.width;
        let whole = if first >= 0.0 { (first as usize).saturating_add(1) } else { 0 };
        let whole = whole.min(column.len());
        let last = self.place as usize;
        let (whole, rest) = column.split_at_checked(whole).unwrap_or((column, &[]));
        let mut sum = 0.0;
        let (fours, others) = whole.as_chunks::<4>();
        for [a, b, c, d] in fours {
            sum += (a + b) + (c + d);
        }
        for mass in others {
            sum += mass;
        }
        // A cell counts once more for each cell that follows it.
        let (mut until, mut more) = (0.0, 0.0);
        let count = last.saturating_add(1).saturating_sub(whole.len()).min(rest.len());
        let (fours, others) = rest.get(..count).unwrap_or_default().as_chunks::<4>();
        for [a, b, c, d] in fours {
            let two = a + b;
            let three = two + c;
            more += 4.0 * until + (a + two + three);
            until += three + d;
        }
        for mass in others {
            more += until;
            until += mass;
        }
        let end = whole.len() as f32 + count as f32 - 1.0;
        sum + ((self.place - end) * until + more) * self.per_width
    }

    /// The mass of a column that lies below, and the sum of it times the number of its cell.
    pub(crate) fn moments(self, column: &[f32]) -> [f32; 2] {
        let [whole, part] = self.counts(column.len());
        let (whole, rest) = column.split_at_checked(whole).unwrap_or((column, &[]));
        let (mut sum, mut first, mut cell) = (0.0, 0.0, 0.0);
        let (fours, others) = whole.as_chunks::<4>();
        for [a, b, c, d] in fours {
            let (two, three) = (a + b, c + d);
            sum += two + three;
            first += cell * (two + three) + (b + d + (three + three));
            cell += 4.0;
        }
        for mass in others {
            sum += mass;
            first += mass * cell;
            cell += 1.0;
        }
        for mass in rest.get(..part).unwrap_or_default() {
            let mass = mass * self.at(cell);
            sum += mass;
            first += mass * cell;
            cell += 1.0;
        }
        [sum, first]
    }
}

/// Each cell's mass times its distance below a place, summed up: for a place at the end of each cell.
pub(crate) fn slopes<const M: usize>(column: &[f32; M]) -> [f32; M] {
    let (mut until, mut more) = (0.0, 0.0);
    column.map(|mass| {
        until += mass;
        more += until;
        more
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against each cell by its share, at places before, in and beyond a column.
    #[test]
    fn moments_below_are_those_of_the_cells() {
        let column: [f32; 11] = core::array::from_fn(|m| 1.0 + (m * m % 7) as f32);
        for n in -30..160 {
            for width in [1.0, 1.3, 4.6, 20.0] {
                let ramp = Ramp { place: n as f32 * 0.1, width, per_width: 1.0 / width };
                let parts = column
                    .iter()
                    .enumerate()
                    .map(|(m, mass)| (m, mass * ramp.at(m as f32).clamp(0.0, 1.0)));
                let (sum, first) = parts.fold((0.0, 0.0), |(sum, first), (m, part)| {
                    (sum + part, first + part * m as f32)
                });
                let got = ramp.moments(&column);
                assert!((got[0] - sum).abs() < 1e-4, "{n}, {width}: {got:?}, {sum}");
                assert!((got[1] - first).abs() < 1e-3, "{n}, {width}: {got:?}, {first}");
            }
        }
    }
}
