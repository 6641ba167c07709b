//! A mass for each direction and offset of a line, in a frame that is laid anew as the mass narrows.
//!
//! Column `k` is a direction, and cell `m` of it an offset to the left of the pivot. Lengths are metres from the pivot, and
//! angles are radians from the frame's heading. So digits are lost neither far from the origin nor where little is left.
//!
//! The cells span the mass but for a tail on either side, and the pivot goes to the *waist*, where offset and direction are
//! uncorrelated. What lies beyond stays in the cells at the edges.

use crate::belief::front::{Unit, angle, limited, metres, radians};
use crate::geometry::approximate::{heading, sqrt};
use crate::geometry::heading::Heading;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};

/// The mass on either side that may lie beyond the cells.
const TAIL: f32 = 1e-3;

/// Cells that are smaller or larger than wanted by less than this stay.
const SIZES: [f32; 2] = [0.65, 1.6];

/// A mean that is off the middle by less than this share of the range stays.
const OFF: f32 = 0.1;

/// Cells and turns are no smaller, metres and radians.
const LEAST: [f32; 2] = [2e-5, 1e-6];

/// An edge cell heavier than its neighbour by this holds a tail that wants out.
const HEAVY: f32 = 1.25;

/// So much is added where a tail wants out, as a share of the range.
const GROWTH: f32 = 0.3;

/// A grid that spans more than this share of a turn goes all around.
const WIDE: f32 = 0.8;

/// A correlation of offset and direction above this moves the pivot: its square.
const CORRELATED: f32 = 0.35 * 0.35;

/// The pivot moves no further at once, metres.
const FAR: f32 = 2_048.0;

/// Where the cells lie.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Lay {
    pub(crate) pivot: Site,
    /// The direction in the middle of all columns.
    pub(crate) heading: Heading,
    /// From one column to the next, radians.
    pub(crate) turn: f32,
    /// The offset at the lower edge of the first cell, metres.
    pub(crate) low: f32,
    /// The height of a cell, metres.
    pub(crate) step: f32,
}

impl Lay {
    /// Whether its columns go all around.
    pub(crate) fn is_whole<const K: usize>(self) -> bool {
        self.turn * K as f32 > 6.2
    }

    /// The direction at a place on its columns, counted in columns from the first one's edge.
    fn heading_at<const K: usize>(self, columns: f32) -> Heading {
        self.heading.turned(angle((columns - 0.5 * K as f32) * self.turn))
    }
}

/// The masses of lines.
#[derive(Clone, Debug)]
pub(crate) struct Grid<const K: usize, const M: usize> {
    pub(crate) lay: Lay,
    pub(crate) along: [Unit; K],
    pub(crate) mass: [[f32; M]; K],
}

/// Sums of the masses, and moments about the middle of the cells, in columns and cells.
pub(crate) struct GridMoments<const K: usize, const M: usize> {
    pub(crate) total: f32,
    columns: [f32; K],
    rows: [f32; M],
    /// The mean column and the mean row.
    pub(crate) mean: [f32; 2],
    /// Their variances, the width of a cell included, and their covariance.
    pub(crate) variance: [f32; 2],
    pub(crate) covariance: f32,
}

impl<const K: usize, const M: usize> Grid<K, M> {
    /// No mass.
    pub(crate) const NONE: Self = {
        assert!(K >= 4 && M >= 4, "a grid has 4 directions and 4 offsets at least");
        let (pivot, heading) = (Site::ORIGIN, Heading(0));
        let lay = Lay { pivot, heading, turn: 0.0, low: 0.0, step: 1.0 };
        Self { lay, along: [Unit::ZERO; K], mass: [[0.0; M]; K] }
    };

    /// Takes another frame. The masses stay in their cells.
    pub(crate) fn set(&mut self, lay: Lay) {
        self.lay = lay;
        for (k, along) in self.along.iter_mut().enumerate() {
            *along = Unit::of(lay.heading_at::<K>(k as f32 + 0.5));
        }
    }

    /// The share of the lines in a column's first cell that have a place on their +1 side, if that errs by `blur` either
    /// way, metres; and by how much it is less in each cell that follows. Below 0 it is 0, and above 1 it is 1.
    fn ramp(&self, along: Unit, place: [f32; 2], blur: f32) -> [f32; 2] {
        let [ahead, left] = along.seen(place);
        let per_cell = 1.0 / self.lay.step;
        let tilt = ahead * self.lay.turn * per_cell;
        let width = sqrt(1.0 + tilt * tilt) + 2.0 * blur * per_cell;
        [((left - self.lay.low) * per_cell - 0.5) / width + 0.5, 1.0 / width]
    }

    /// The mass of the lines that have a site on their +1 side. `O(K M)`.
    #[inline(never)]
    pub(crate) fn above(&self, site: Site, blur: f32) -> f32 {
        let place = metres(site - self.lay.pivot);
        let mut sum = 0.0;
        for (column, along) in self.mass.iter().zip(&self.along) {
            let [mut share, less] = self.ramp(*along, place, blur);
            for mass in column {
                if share <= 0.0 {
                    break;
                }
                sum += if share < 1.0 { share * mass } else { *mass };
                share -= less;
            }
        }
        sum
    }

    /// Multiplies the mass of the lines that have a site on their +1 side by one number, and that of the others by
    /// another. Returns the mass that is left.
    #[inline(never)]
    pub(crate) fn weigh(&mut self, site: Site, blur: f32, [plus, minus]: [f32; 2]) -> f32 {
        let place = metres(site - self.lay.pivot);
        let mut sum = 0.0;
        for k in 0..K {
            let Some(along) = self.along.get(k) else { break };
            let [mut share, less] = self.ramp(*along, place, blur);
            for mass in self.mass.get_mut(k).into_iter().flatten() {
                *mass *= minus + (plus - minus) * share.clamp(0.0, 1.0);
                sum += *mass;
                share -= less;
            }
        }
        sum
    }

    /// Multiplies all masses by a number, and adds another one.
    pub(crate) fn scale(&mut self, by: f32, more: f32) {
        self.cells().for_each(|mass| *mass = *mass * by + more);
    }

    pub(crate) fn cells(&mut self) -> impl Iterator<Item = &mut f32> {
        self.mass.as_flattened_mut().iter_mut()
    }

    #[inline(never)]
    pub(crate) fn moments(&self) -> GridMoments<K, M> {
        let (mut columns, mut rows, mut products) = ([0.0; K], [0.0; M], 0.0);
        let mut k = -0.5 * (K as f32 - 1.0);
        for (column, sum) in self.mass.iter().zip(&mut columns) {
            let mut m = -0.5 * (M as f32 - 1.0);
            for (mass, row) in column.iter().zip(&mut rows) {
                *sum += mass;
                *row += mass;
                products += k * m * mass;
                m += 1.0;
            }
            k += 1.0;
        }
        let total: f32 = columns.iter().sum();
        let each = if total > 0.0 { 1.0 / total } else { 0.0 };
        let [by_column, by_row] = [spread(&columns, each), spread(&rows, each)];
        let covariance = products * each - by_column[0] * by_row[0];
        let (mean, variance) = ([by_column[0], by_row[0]], [by_column[1], by_row[1]]);
        GridMoments { total, columns, rows, mean, variance, covariance }
    }

    /// The mean direction: where columns go all around, that of the mean vector.
    pub(crate) fn heading(&self, moments: &GridMoments<K, M>) -> Heading {
        let lay = self.lay;
        if !lay.is_whole::<K>() {
            return lay.heading.turned(angle(moments.mean[0] * lay.turn));
        }
        let columns = moments.columns.iter().zip(&self.along);
        let sum = columns.fold(Unit::ZERO, |sum, (mass, it)| Unit {
            x: sum.x + mass * it.x,
            z: sum.z + mass * it.z,
        });
        let has_one = sum.x.abs() + sum.z.abs() > 1e-6 * moments.total;
        if has_one { heading(sum.x, sum.z) } else { lay.heading }
    }

    /// The waist: the place on the mean line where offset and direction are uncorrelated.
    pub(crate) fn waist(&self, moments: &GridMoments<K, M>) -> Site {
        let lay = self.lay;
        let slope = moments.covariance / moments.variance[0];
        let ahead = limited(-slope * lay.step / lay.turn, FAR);
        let left = limited(lay.low + lay.step * (moments.mean[1] + 0.5 * M as f32), FAR);
        let Unit { x, z } = Unit::of(self.heading(moments));
        let by = [x * ahead - z * left, z * ahead + x * left];
        let [x, z] = by.map(|it| (it * UNITS_PER_METRE as f32) as i32);
        Vector::new(x, z).and_then(|by| lay.pivot.step(by).ok()).unwrap_or(lay.pivot)
    }

    /// Lays the cells anew if they are of another size than the mass wants, or lie elsewhere.
    pub(crate) fn settle(&mut self) {
        let moments = self.moments();
        if moments.total <= 0.0 {
            return;
        }
        let [columns, rows] = moments.variance;
        let is_whole = self.lay.is_whole::<K>();
        if !is_whole && moments.covariance * moments.covariance > CORRELATED * columns * rows {
            let low = -0.5 * self.lay.step * M as f32;
            self.lay_anew(Lay { pivot: self.waist(&moments), low, ..self.lay });
        }
        if let Some(lay) = self.wanted() {
            self.lay_anew(lay);
        }
    }

    /// Where the cells should lie; `None` if they lie well enough.
    fn wanted(&self) -> Option<Lay> {
        let (lay, moments) = (self.lay, self.moments());
        let (columns, from) = self.columns_in_order(&moments);
        let [first, last] = range(&columns);
        let turn = at_least(LEAST[1], (last - first) * lay.turn / K as f32);
        let is_whole = turn * K as f32 > WIDE * core::f32::consts::TAU;
        let (turn, heading) = if is_whole {
            (core::f32::consts::TAU / K as f32, lay.heading)
        } else {
            (turn, from.turned(angle(0.5 * (first + last) * lay.turn)))
        };
        let turns = is_whole != lay.is_whole::<K>()
            || !is_whole && (is_other(lay.turn, turn) || is_off([first, last], K));
        let [low, high] = range(&moments.rows);
        let step = at_least(LEAST[0], (high - low) * lay.step / M as f32);
        let shifts = is_other(lay.step, step) || is_off([low, high], M);
        let low = lay.low + 0.5 * (low + high) * lay.step - 0.5 * step * M as f32;
        (turns || shifts).then_some(Lay { heading, turn, low, step, ..lay })
    }

    /// The masses of the columns, and the direction at which the first begins. Columns that go all around begin opposite to
    /// the mean direction.
    fn columns_in_order(&self, moments: &GridMoments<K, M>) -> ([f32; K], Heading) {
        let (mut columns, from) = (moments.columns, self.lay.heading_at::<K>(0.0));
        if !self.lay.is_whole::<K>() {
            return (columns, from);
        }
        let mean = radians(self.heading(moments).since(from)) / self.lay.turn;
        let first = (mean + 1.5 * K as f32) as usize % K;
        let after = moments.columns.iter().skip(first);
        let turned = after.chain(moments.columns.iter().take(first));
        columns.iter_mut().zip(turned).for_each(|(column, mass)| *column = *mass);
        (columns, self.lay.heading_at::<K>(first as f32))
    }

    /// Puts the mass into other cells: what lies beyond goes into those at the edges.
    ///
    /// Each column is shifted as its middle is. Then it is shared out among the new columns. Within a cell the density is
    /// even.
    #[inline(never)]
    fn lay_anew(&mut self, lay: Lay) {
        let old = self.lay;
        let by = metres(lay.pivot - old.pivot);
        for (column, along) in self.mass.iter_mut().zip(&self.along) {
            let [_, left] = along.seen(by);
            take(column, [lay.low - old.low + left, lay.step].map(|it| it / old.step));
        }
        let turned = radians(lay.heading.since(old.heading)) - 0.5 * K as f32 * lay.turn;
        let places = [turned / old.turn + 0.5 * K as f32, lay.turn / old.turn];
        let before = self.mass;
        share(&before, &mut self.mass, places, [old, lay].map(Lay::is_whole::<K>));
        self.set(lay);
    }
}

/// Shares out a column among other cells, by where the first of these begins and how high each is, counted in the old ones.
fn take<const M: usize>(column: &mut [f32; M], [mut place, each]: [f32; 2]) {
    let (old, mut before, mut total) = (*column, [0.0; M], 0.0);
    for (before, mass) in before.iter_mut().zip(&old) {
        *before = total;
        total += mass;
    }
    let until = |place: f32| match (before.get(place as usize), old.get(place as usize)) {
        (Some(before), Some(mass)) if place > 0.0 => {
            before + (place - (place as usize) as f32) * mass
        }
        (Some(_), _) => 0.0,
        _ => total,
    };
    let (mut last, mut left) = (0.0, M);
    for mass in column {
        (place, left) = (place + each, left.saturating_sub(1));
        let next = if left == 0 { total } else { until(place) };
        // Rounding may leave a little less than nothing.
        *mass = (next - last).abs();
        last = next;
    }
}

/// Shares out columns among others, by where the first of these begins and how wide each is, counted in the old ones.
/// Whether these went all around, and those do. Others have ends, which take what lies beyond.
#[inline(never)]
fn share<const K: usize, const M: usize>(
    old: &[[f32; M]; K],
    new: &mut [[f32; M]; K],
    [from, each]: [f32; 2],
    round: [bool; 2],
) {
    let all = K as f32;
    // What goes all around is cut opposite to the middle.
    let middle = from + 0.5 * each * all;
    let [mut place, end] = match round {
        [false, _] => [0.0, all],
        [true, false] => [middle - 0.5 * all, middle + 0.5 * all],
        [true, true] => [from, from + each * all],
    };
    let (mut next, mut left) = (from, K);
    for column in new {
        (next, left) = (next + each, left.saturating_sub(1));
        let until = if left == 0 || next > end { end } else { next };
        column.fill(0.0);
        while place < until {
            let cell = floor(place);
            let edge = cell.wrapping_add(1) as f32;
            let edge = if edge < until { edge } else { until };
            let masses = old.get(cell.rem_euclid(K as i32) as usize);
            for (to, mass) in column.iter_mut().zip(masses.into_iter().flatten()) {
                *to += (edge - place) * mass;
            }
            place = edge;
        }
    }
}

/// The greatest integer that is no greater.
fn floor(value: f32) -> i32 {
    let near = value as i32;
    if near as f32 > value { near.wrapping_sub(1) } else { near }
}

/// The mean and the variance of some masses, numbered from the middle.
fn spread(masses: &[f32], each: f32) -> [f32; 2] {
    let (mut first, mut second, mut at) = (0.0, 0.0, -0.5 * (masses.len() as f32 - 1.0));
    for mass in masses {
        first += mass * at;
        second += mass * at * at;
        at += 1.0;
    }
    let mean = first * each;
    let variance = second * each - mean * mean;
    // A cell's own width.
    [mean, (if variance > 0.0 { variance } else { 0.0 }) + 1.0 / 12.0]
}

/// From where to where the mass lies but for a tail on either side, in cells from the first one's edge.
fn range(masses: &[f32]) -> [f32; 2] {
    let (total, cells): (f32, _) = (masses.iter().sum(), masses.len() as f32);
    let tail = TAIL * total;
    let end = |edge: Option<&f32>, next: Option<&f32>, masses: &mut dyn Iterator<Item = &f32>| {
        let [edge, next] = [edge, next].map(|it| it.copied().unwrap_or(0.0));
        let wants_out = edge > HEAVY * next && edge > 2.0 * tail;
        if wants_out { -GROWTH * cells } else { place_of(masses, tail) }
    };
    let low = end(masses.first(), masses.get(1), &mut masses.iter());
    let high = end(masses.last(), masses.iter().rev().nth(1), &mut masses.iter().rev());
    [low, cells - high]
}

/// Up to where so much mass lies, counted in cells.
fn place_of(masses: &mut dyn Iterator<Item = &f32>, mass: f32) -> f32 {
    let (mut before, mut cell) = (0.0, 0.0);
    for it in masses {
        let until = before + it;
        if until >= mass && until > before {
            return cell + (mass - before) / (until - before);
        }
        (before, cell) = (until, cell + 1.0);
    }
    cell
}

fn is_other(size: f32, wanted: f32) -> bool {
    size < SIZES[0] * wanted || size > SIZES[1] * wanted
}

/// Whether the middle of a range of cells is off the middle of all.
fn is_off([first, last]: [f32; 2], cells: usize) -> bool {
    (0.5 * (first + last) - 0.5 * cells as f32).abs() > OFF * (last - first)
}

fn at_least(least: f32, it: f32) -> f32 {
    if it > least { it } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;

    fn grid() -> Grid<8, 12> {
        let mut grid = Grid::NONE;
        let pivot = Site::new(3 << 16, -(5 << 16)).unwrap();
        grid.set(Lay { pivot, heading: Heading(700_000_000), turn: 0.05, low: -1.5, step: 0.25 });
        for (k, column) in grid.mass.iter_mut().enumerate() {
            for (m, mass) in column.iter_mut().enumerate() {
                let (x, y) = (k as f32 - 3.5, m as f32 - 5.5);
                *mass = libm::expf(-0.25 * x * x - 0.15 * y * y);
            }
        }
        grid
    }

    fn total<const K: usize, const M: usize>(grid: &Grid<K, M>) -> f32 {
        grid.mass.as_flattened().iter().sum()
    }

    #[test]
    fn a_label_cuts_what_lies_above_and_below() {
        let (grid, mut draws) = (grid(), Draws::new(7));
        for _ in 0..200 {
            let by = Vector::new(draws.below(200_000) as i32, draws.below(163_840) as i32).unwrap();
            let site = grid.lay.pivot.step(by).unwrap();
            let (above, whole, mut weighed) = (grid.above(site, 0.02), total(&grid), grid.clone());
            let left = weighed.weigh(site, 0.02, [0.9, 0.2]);
            let expected = 0.9 * above + 0.2 * (whole - above);
            assert!((left / expected - 1.0).abs() < 1e-5, "{site:?}: {left} for {expected}");
        }
    }

    /// The share above a place hardly changes as cells are laid anew, with the pivot or without it.
    #[test]
    fn laying_anew_keeps_what_is_known() {
        let (grid, by) = (grid(), Vector::new(1 << 15, 1 << 14).unwrap());
        let (old, whole) = (grid.lay, total(&grid));
        let moved = old.pivot.step(by).unwrap();
        for lay in [
            Lay { turn: 0.06, ..old },
            Lay { step: 0.3, low: -1.9, ..old },
            Lay { heading: old.heading.turned(angle(0.04)), turn: 0.07, ..old },
            Lay { pivot: moved, low: -2.0, step: 0.3, turn: 0.06, ..old },
        ] {
            let mut laid = grid.clone();
            laid.lay_anew(lay);
            assert!((total(&laid) / whole - 1.0).abs() < 1e-4, "{lay:?}");
            for (x, z) in [(0, 0), (1, 1), (-1, 2), (2, -1), (-2, -1)] {
                let at = Vector::new(x << 15, z << 15).unwrap();
                let site = old.pivot.step(at).unwrap();
                let off = (laid.above(site, 0.0) - grid.above(site, 0.0)) / whole;
                assert!(off.abs() < 0.03, "{lay:?} at {at:?}: {off}");
            }
        }
    }

    /// Columns that go all around, seen from other directions.
    #[test]
    fn a_whole_turn_is_laid_as_a_part_of_one() {
        let mut grid = Grid::<16, 16>::NONE;
        for first in 0..16 {
            let heading = Heading(first << 28);
            let turn = core::f32::consts::TAU / 16.0;
            grid.set(Lay { pivot: Site::ORIGIN, turn, heading, low: -8.0, step: 1.0 });
            let middle = Heading(1 << 30);
            // Directions within a quarter turn of the middle.
            for (k, column) in grid.mass.iter_mut().enumerate() {
                let off = radians(grid.lay.heading_at::<16>(k as f32 + 0.5).since(middle));
                *column = [if off.abs() < 1.6 { 1.0 } else { 0.0 }; 16];
            }
            let before = total(&grid);
            grid.settle();
            assert!((total(&grid) / before - 1.0).abs() < 1e-5, "{first}");
            let off = radians(grid.lay.heading.since(middle));
            let is_part = !grid.lay.is_whole::<16>() && grid.lay.turn * 16.0 < 4.0;
            assert!(is_part && off.abs() < 0.21, "{first}: {off}, {:?}", grid.lay);
        }
    }
}
