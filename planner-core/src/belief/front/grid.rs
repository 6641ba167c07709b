//! A distribution over curves: a mass for each direction, offset and curvature, in a frame that can be laid anew.
//!
//! Column `k` is a direction, cell `m` of it an offset to the left of the pivot, and layer `l` a curvature. Within a
//! cell the density is even. Where cells of a front that bends are laid anew, it has a slope. At the distance `s` along
//! its direction a curve lies `offset + curvature s^2 / 2` to the left.
//!
//! Lengths are metres from the pivot and angles are radians from the frame's heading, all in single precision. So
//! digits are lost neither far from the origin nor where the distribution is narrow.

use crate::belief::front::lay::{Lay, Unit, angle, metres};
use crate::belief::front::ramp::slopes;
use crate::geometry::lattice::Site;

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

    /// The mass of the curves that have a site on their +1 side, if positions err by `blur` either way, metres.
    ///
    /// `O(K M L)`. What layers share is computed once for each direction.
    #[inline(never)]
    pub(crate) fn above(&self, site: Site, blur: f32) -> f32 {
        let (place, lay) = (metres(site - self.lay.pivot), self.lay);
        let per_cell = 1.0 / lay.step;
        let mut sum = 0.0;
        for (k, along) in self.along.iter().enumerate() {
            let straight = lay.ramp(*along, 0.0, place, blur);
            let bulge = lay.bulge(per_cell, along.seen(place)[0]);
            for (layer, bend) in self.mass.iter().zip(lay.bends::<L>()) {
                let ramp = straight.lower(bend * bulge);
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
                let straight = lay.ramp(*along, 0.0, place, blur);
                let bulge = lay.bulge(per_cell, along.seen(place)[0]);
                for (column, bend) in columns.iter().zip(lay.bends::<L>()) {
                    *sum += straight.lower(bend * bulge).below_slopes(column);
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
                sum += lay.ramp(*along, bend, place, blur).weigh(column, weights);
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
}

/// Not generic, nor inlined into what is: so it is compiled once, for speed, where programs for chips are compiled for
/// size.
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::belief::front::lay::radians;
    use crate::draws::Draws;
    use crate::geometry::heading::Heading;
    use crate::geometry::lattice::Vector;

    pub(crate) fn grid() -> Grid<8, 12, 3> {
        let mut grid = Grid::NONE;
        let pivot = Site::new(3 << 16, -(5 << 16)).unwrap();
        let heading = Heading(700_000_000);
        grid.set(Lay { pivot, heading, turn: 0.05, low: -1.5, step: 0.25, bend: 0.05 });
        let mut draws = Draws::new(1);
        for mass in grid.cells() {
            *mass = (draws.bits() >> 8) as f32 * 1e-10;
        }
        grid
    }

    pub(crate) fn total(grid: &mut Grid<8, 12, 3>) -> f32 {
        grid.cells().map(|it| *it).sum()
    }

    #[test]
    fn a_label_cuts_what_lies_above_and_below() {
        let grid = grid();
        let mut draws = Draws::new(7);
        for _ in 0..200 {
            let by = Vector::new(draws.below(200_000) as i32, draws.below(163_840) as i32).unwrap();
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
        let mut draws = Draws::new(3);
        for far in [14, 18, 22, 26] {
            let sites: [Site; 40] = core::array::from_fn(|_| {
                let mut part = || draws.bits() as i32 >> (31 - far);
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
}
