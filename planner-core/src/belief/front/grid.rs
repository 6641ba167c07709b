//! A distribution over curves: a mass for each direction, offset and curvature, in a frame that can be laid anew.
//!
//! Column `k` is a direction, cell `m` of it an offset to the left of the pivot, and layer `l` a curvature. Within a
//! cell the density is even. Where cells of a front that bends are laid anew, it has a slope. At the distance `s` along
//! its direction a curve lies `offset + curvature s^2 / 2` to the left.
//!
//! Lengths are metres from the pivot and angles are radians from the frame's heading, all in single precision. So
//! digits are lost neither far from the origin nor where the distribution is narrow.

use crate::belief::front::walk;
use crate::geometry::approximate::{METRE, sqrt};
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{Site, Vector};

/// A direction as a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    pub(crate) x: f32,
    pub(crate) z: f32,
}

impl Unit {
    pub(crate) const ZERO: Self = Self { x: 0.0, z: 0.0 };

    pub(crate) fn of(heading: Heading) -> Self {
        const ONE: i32 = (1 << 30) - 1;
        let Vector { x, z } = heading.unit().scaled(ONE);
        Self { x: x as f32 / ONE as f32, z: z as f32 / ONE as f32 }
    }

    /// How far a place lies ahead, and how far to the left.
    pub(crate) fn seen(self, [x, z]: [f32; 2]) -> [f32; 2] {
        [self.x * x + self.z * z, self.x * z - self.z * x]
    }
}

/// A vector in metres.
pub(crate) fn metres(v: Vector) -> [f32; 2] {
    [v.x as f32 * METRE, v.z as f32 * METRE]
}

/// An angle of so many radians, less than a turn in size.
pub(crate) fn angle(radians: f32) -> Angle {
    const UNITS: f32 = (1_u32 << 31) as f32 / core::f32::consts::PI;
    Angle((radians * UNITS) as i64 as u32)
}

/// An angle in radians, from -pi to below pi.
pub(crate) fn radians(Angle(units): Angle) -> f32 {
    const UNIT: f32 = core::f32::consts::PI / (1_u32 << 31) as f32;
    units as i32 as f32 * UNIT
}

/// A number, or the nearest that is no larger than `most` in size. Unlike `clamp` it cannot panic.
pub(crate) fn limited(value: f32, most: f32) -> f32 {
    match () {
        () if value > most => most,
        () if value < -most => -most,
        () => value,
    }
}

/// Where the cells of a grid lie.
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
    /// The curvature of the last layer, 1/m. The first has the opposite.
    pub(crate) bend: f32,
}

impl Lay {
    pub(crate) const NONE: Self = Self {
        pivot: Site::ORIGIN,
        heading: Heading(0),
        turn: 0.0,
        low: 0.0,
        step: 1.0,
        bend: 0.0,
    };

    /// The curvatures of the layers.
    pub(crate) fn bends<const L: usize>(self) -> impl Iterator<Item = f32> {
        let last = L.saturating_sub(1);
        let each = if last > 0 { 2.0 / last as f32 } else { 0.0 };
        (0..L).map(move |l| if last > 0 { self.bend * (l as f32 * each - 1.0) } else { 0.0 })
    }

    /// Whether its columns go all around.
    pub(crate) fn is_whole<const K: usize>(self) -> bool {
        self.turn * K as f32 > 6.2
    }

    /// The angle from its heading to a place on its columns, counted in columns from the first one's edge.
    pub(crate) fn angle_at<const K: usize>(self, columns: f32) -> f32 {
        (columns - 0.5 * K as f32) * self.turn
    }

    /// How far a curve of some curvature bulges at a distance along its direction. Beyond the radius it bulges no more:
    /// a front does not go round for ever.
    pub(crate) fn bulge(self, bend: f32, ahead: f32) -> f32 {
        let far = if self.bend > 0.0 { 1.0 / (self.bend * self.bend) } else { f32::MAX };
        let square = ahead * ahead;
        0.5 * bend * (if square < far { square } else { far })
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
    fn below_slopes(self, slopes: &[f32]) -> f32 {
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
    fn weigh(self, column: &mut [f32], [plus, minus]: [f32; 2]) -> f32 {
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
    fn below(self, column: &[f32]) -> f32 {
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
fn slopes<const M: usize>(column: &[f32; M]) -> [f32; M] {
    let (mut until, mut more) = (0.0, 0.0);
    column.map(|mass| {
        until += mass;
        more += until;
        more
    })
}

/// The masses of curves.
#[derive(Clone, Debug)]
pub(crate) struct Grid<const K: usize, const M: usize, const L: usize> {
    pub(crate) lay: Lay,
    pub(crate) along: [Unit; K],
    pub(crate) mass: [[[f32; M]; K]; L],
}

impl<const K: usize, const M: usize, const L: usize> Grid<K, M, L> {
    /// No mass.
    pub(crate) const NONE: Self = {
        assert!(
            K >= 4 && M >= 4 && L >= 1,
            "a grid has 4 directions, 4 offsets and a layer at least"
        );
        Self { lay: Lay::NONE, along: [Unit::ZERO; K], mass: [[[0.0; M]; K]; L] }
    };

    /// Takes another frame. The masses stay in their cells.
    pub(crate) fn set(&mut self, lay: Lay) {
        self.lay = lay;
        for (k, along) in self.along.iter_mut().enumerate() {
            let turned = lay.angle_at::<K>(k as f32 + 0.5);
            *along = Unit::of(lay.heading.turned(angle(turned)));
        }
    }

    /// The ramp of a column for a place that errs by `blur` either way, metres.
    pub(crate) fn ramp(lay: Lay, along: Unit, bend: f32, place: [f32; 2], blur: f32) -> Ramp {
        let [ahead, left] = along.seen(place);
        let per_cell = 1.0 / lay.step;
        let off = (left - lay.bulge(bend, ahead) - lay.low) * per_cell;
        let tilt = ahead * lay.turn * per_cell;
        let width = sqrt(1.0 + tilt * tilt) + 2.0 * blur * per_cell;
        // A cell's number is that of its lower edge, and its curves lie about its middle.
        Ramp { place: off - 0.5 + 0.5 * width, width, per_width: 1.0 / width }
    }

    /// The mass of the curves that have a site on their +1 side, if positions err by `blur` either way, metres.
    ///
    /// `O(K M L)`. What layers share is computed once for each direction.
    #[inline(never)]
    pub(crate) fn above(&self, site: Site, blur: f32) -> f32 {
        let (place, lay) = (metres(site - self.lay.pivot), self.lay);
        let per_cell = 1.0 / lay.step;
        let mut sum = 0.0;
        for (k, along) in self.along.iter().enumerate() {
            let straight = Self::ramp(lay, *along, 0.0, place, blur);
            let bulge = lay.bulge(per_cell, along.seen(place)[0]);
            for (layer, bend) in self.mass.iter().zip(lay.bends::<L>()) {
                let ramp = Ramp { place: straight.place - bend * bulge, ..straight };
                sum += layer.get(k).map_or(0.0, |column| ramp.below(column));
            }
        }
        sum
    }

    /// The same for several sites at once, which is cheaper: each column is summed up once for all of them.
    #[inline(never)]
    pub(crate) fn above_each(&self, sites: &[Site], blur: f32, sums: &mut [f32]) {
        let lay = self.lay;
        let per_cell = 1.0 / lay.step;
        sums.fill(0.0);
        for (k, along) in self.along.iter().enumerate() {
            let columns = self.mass.each_ref().map(|layer| layer.get(k).map_or([0.0; M], slopes));
            for (site, sum) in sites.iter().zip(sums.iter_mut()) {
                let place = metres(*site - lay.pivot);
                let straight = Self::ramp(lay, *along, 0.0, place, blur);
                let bulge = lay.bulge(per_cell, along.seen(place)[0]);
                for (column, bend) in columns.iter().zip(lay.bends::<L>()) {
                    let place = straight.place - bend * bulge;
                    *sum += Ramp { place, ..straight }.below_slopes(column);
                }
            }
        }
    }

    /// Multiplies the mass of the curves that have a site on their +1 side by one number, and that of the others by
    /// another. Returns the mass that is left.
    #[inline(never)]
    pub(crate) fn weigh(&mut self, site: Site, blur: f32, weights: [f32; 2]) -> f32 {
        let (place, lay) = (metres(site - self.lay.pivot), self.lay);
        let mut sum = 0.0;
        for (layer, bend) in self.mass.iter_mut().zip(lay.bends::<L>()) {
            for (column, along) in layer.iter_mut().zip(&self.along) {
                sum += Self::ramp(lay, *along, bend, place, blur).weigh(column, weights);
            }
        }
        sum
    }

    /// Multiplies all masses by a number, and adds another one.
    pub(crate) fn scale(&mut self, by: f32, more: f32) {
        scale(self.mass.as_flattened_mut().as_flattened_mut(), by, more);
    }

    pub(crate) fn cells(&mut self) -> impl Iterator<Item = &mut f32> {
        self.mass.as_flattened_mut().as_flattened_mut().iter_mut()
    }

    /// The mass in the first and the last cells of all columns.
    pub(crate) fn at_edges(&self) -> f32 {
        let ends =
            |it: &[f32; M]| it.first().zip(it.last()).map_or(0.0, |(first, last)| first + last);
        self.mass.as_flattened().iter().map(ends).sum()
    }

    /// Lets a share of each layer's mass pass to each neighbouring one.
    pub(crate) fn mix_layers(&mut self, share: f32) {
        let mut rest = self.mass.as_mut_slice();
        while let Some((layer, after)) = rest.split_first_mut() {
            if let Some(next) = after.first_mut() {
                mix(layer.as_flattened_mut(), next.as_flattened_mut(), share);
            }
            rest = after;
        }
    }

    /// Lets directions diffuse by a variance in squares of the turn between columns, 0.5 at most.
    pub(crate) fn mix_columns(&mut self, variance: f32) {
        let share = if variance < 0.5 { 0.5 * variance } else { 0.25 };
        let mut flows = [0.0; M];
        for layer in &mut self.mass {
            mix_columns(layer.as_flattened_mut(), &mut flows, share);
        }
    }

    /// Lets offsets diffuse by a variance in squares of the cells' height, by a box with ends in parts of a cell. It
    /// is as good as a Gaussian.
    pub(crate) fn blur_offsets(&mut self, variance: f32) {
        // So many whole cells to either side, whose variance is less, and a part of the next.
        let whole = (sqrt(3.0 * variance + 0.25) - 0.5) as u16;
        let n = f32::from(whole);
        let more = variance - n * (n + 1.0) / 3.0;
        let more = if more > 0.0 { more } else { 0.0 };
        let part = (n + 0.5) * more / ((n + 1.0) * (n + 1.0) - variance);
        let mut sums = [0.0; M];
        for column in self.mass.as_flattened_mut() {
            let old = *column;
            if whole == 0 {
                walk::mix(&old, column, part / (2.0 * part + 1.0));
            } else {
                walk::blur(&old, column, &mut sums, whole.into(), part);
            }
        }
    }
}

// What follows is not generic, nor inlined into what is: so it is compiled once, for speed, where programs for chips are
// compiled for size.

#[inline(never)]
fn scale(masses: &mut [f32], by: f32, more: f32) {
    let (fours, others) = masses.as_chunks_mut::<4>();
    for four in fours {
        *four = four.map(|mass| mass * by + more);
    }
    for mass in others {
        *mass = *mass * by + more;
    }
}

/// Lets a share of each cell's mass pass to the other's.
#[inline(never)]
fn mix(layer: &mut [f32], next: &mut [f32], share: f32) {
    let pass = |(a, b): (&mut f32, &mut f32)| {
        let flow = share * (*a - *b);
        *a -= flow;
        *b += flow;
    };
    let (fours, others) = layer.as_chunks_mut::<4>();
    let (next_fours, next_others) = next.as_chunks_mut::<4>();
    for (a, b) in fours.iter_mut().zip(next_fours) {
        a.iter_mut().zip(b).for_each(pass);
    }
    others.iter_mut().zip(next_others).for_each(pass);
}

/// Lets a share of each column's mass pass to each neighbour, cell by cell. `flows` is room for a column.
#[inline(never)]
fn mix_columns(layer: &mut [f32], flows: &mut [f32], share: f32) {
    let size = flows.len();
    flows.fill(0.0);
    let mut rest = layer;
    while let Some((column, after)) = rest.split_at_mut_checked(size).filter(|_| size > 0) {
        // What has come from the column before, and what comes from the next one.
        let pass = |((mass, next), flow): ((&mut f32, &f32), &mut f32)| {
            let own = *mass;
            *mass += *flow;
            *flow = share * (own - next);
            *mass -= *flow;
        };
        let (fours, others) = column.as_chunks_mut::<4>();
        let (next_fours, next_others) = after.get(..size).unwrap_or_default().as_chunks::<4>();
        let (flow_fours, flow_others) = flows.as_chunks_mut::<4>();
        for ((four, next), flow) in fours.iter_mut().zip(next_fours).zip(flow_fours) {
            four.iter_mut().zip(next).zip(flow).for_each(pass);
        }
        others.iter_mut().zip(next_others).zip(flow_others).for_each(pass);
        if after.is_empty() {
            column.iter_mut().zip(&*flows).for_each(|(mass, flow)| *mass += flow);
        }
        rest = after;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid<8, 12, 3> {
        let mut grid = Grid::NONE;
        let pivot = Site::new(3 << 16, -(5 << 16)).unwrap();
        let heading = Heading(700_000_000);
        grid.set(Lay { pivot, heading, turn: 0.05, low: -1.5, step: 0.25, bend: 0.05 });
        let mut state = 1_u32;
        for mass in grid.cells() {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *mass = (state >> 8) as f32 * 1e-10;
        }
        grid
    }

    fn total(grid: &mut Grid<8, 12, 3>) -> f32 {
        grid.cells().map(|it| *it).sum()
    }

    #[test]
    fn diffusion_loses_no_mass_and_adds_its_variance() {
        let mut grid = grid();
        let whole = total(&mut grid);
        for variance in [0.0, 0.3, 4.0, 400.0] {
            grid.blur_offsets(variance);
            grid.mix_columns(variance);
            grid.mix_layers(0.1);
            assert!((total(&mut grid) / whole - 1.0).abs() < 1e-4, "{variance}");
        }
        let mut column = Grid::<4, 64, 1>::NONE;
        column.mass[0][1][32] = 1.0;
        for variance in [0.1, 1.0, 9.0, 30.0] {
            let mut after = column.clone();
            after.blur_offsets(variance);
            let got: f32 =
                (0..64).map(|m| after.mass[0][1][m] * (m as f32 - 32.0) * (m as f32 - 32.0)).sum();
            assert!((got - variance).abs() < 0.01 * variance + 0.004, "{variance}: {got}");
        }
    }

    #[test]
    fn a_label_cuts_what_lies_above_and_below() {
        let grid = grid();
        let mut state = 7_u32;
        for _ in 0..200 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let by = Vector::new((state >> 8) as i32 % 200_000, (state >> 20) as i32 * 40).unwrap();
            let site = grid.lay.pivot.step(by).unwrap();
            let mut weighed = grid.clone();
            let above = grid.above(site, 0.02);
            let whole = total(&mut weighed);
            let left = weighed.weigh(site, 0.02, [0.9, 0.2]);
            let expected = 0.9 * above + 0.2 * (whole - above);
            assert!((left / expected - 1.0).abs() < 1e-5, "{site:?}: {left} for {expected}");
        }
    }

    #[test]
    fn several_places_are_asked_as_one_is() {
        let grid = grid();
        let whole = total(&mut grid.clone());
        let mut state = 3_u32;
        for far in [14, 18, 22, 26] {
            let sites: [Site; 40] = core::array::from_fn(|_| {
                let mut part = || {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    state as i32 >> (31 - far)
                };
                grid.lay.pivot.step(Vector::new(part(), part()).unwrap()).unwrap()
            });
            let mut sums = [7.0; 40];
            grid.above_each(&sites, 0.02, &mut sums);
            for (site, sum) in sites.into_iter().zip(sums) {
                let off = (sum - grid.above(site, 0.02)) / whole;
                assert!(off.abs() < 2e-6, "{far}, {site:?}: {off}");
            }
        }
    }

    /// The share above a place hardly changes as cells are laid anew, with the pivot or without it.
    #[test]
    fn laying_anew_keeps_what_is_known() {
        let mut grid = grid();
        // Smooth in the middle of the cells.
        for layer in &mut grid.mass {
            for (k, column) in layer.iter_mut().enumerate() {
                for (m, mass) in column.iter_mut().enumerate() {
                    let (x, y) = (k as f32 - 3.5, m as f32 - 5.5);
                    *mass = libm::expf(-0.25 * x * x - 0.15 * y * y);
                }
            }
        }
        let by = Vector::new(1 << 15, 1 << 14).unwrap();
        let moved = grid.lay.pivot.step(by).unwrap();
        let old = grid.lay;
        let lays = [
            Lay { turn: 0.06, ..old },
            Lay { step: 0.3, low: -1.9, ..old },
            Lay { heading: old.heading.turned(angle(0.04)), turn: 0.07, ..old },
            Lay { pivot: moved, low: -2.0, step: 0.3, turn: 0.06, ..old },
        ];
        let whole = total(&mut grid);
        for lay in lays {
            let mut laid = grid.clone();
            laid.lay_anew(lay);
            assert!((total(&mut laid) / whole - 1.0).abs() < 1e-4, "{lay:?}");
            for (x, z) in [(0, 0), (1, 1), (-1, 2), (2, -1), (-2, -1)] {
                let at = Vector::new(x << 15, z << 15).unwrap();
                let site = old.pivot.step(at).unwrap();
                let off = (laid.above(site, 0.0) - grid.above(site, 0.0)) / whole;
                assert!(off.abs() < 0.02, "{lay:?} at {at:?}: {off}");
            }
        }
    }

    /// Columns that go all around, seen from other directions.
    #[test]
    fn a_whole_turn_is_laid_as_a_part_of_one() {
        let mut grid = Grid::<16, 16, 1>::NONE;
        let turn = core::f32::consts::TAU / 16.0;
        for first in 0..16 {
            let heading = Heading(first << 28);
            let lay = Lay { turn, heading, low: -8.0, step: 1.0, ..Lay::NONE };
            grid.set(lay);
            let middle = Heading(1 << 30);
            // Directions within a quarter turn of the middle.
            for (k, column) in grid.mass[0].iter_mut().enumerate() {
                let off = radians(
                    heading.turned(angle(lay.angle_at::<16>(k as f32 + 0.5))).since(middle),
                );
                *column = [if off.abs() < 1.6 { 1.0 } else { 0.0 }; 16];
            }
            let before: f32 = grid.cells().map(|it| *it).sum();
            grid.lay_around(None, 0.0);
            let after: f32 = grid.cells().map(|it| *it).sum();
            assert!((after / before - 1.0).abs() < 1e-5, "{first}");
            assert!(!grid.lay.is_whole::<16>(), "{first}");
            let off = radians(grid.lay.heading.since(middle));
            assert!(
                off.abs() < 0.21 && grid.lay.turn * 16.0 < 4.0,
                "{first}: {off}, {:?}",
                grid.lay
            );
        }
    }

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
