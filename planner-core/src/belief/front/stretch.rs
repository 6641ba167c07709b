//! What is known of a front over a stretch of it, and how much a label is expected to narrow that.
//!
//! About the mean, a curve of the grid has at the distance `s` ahead of the pivot the offset
//! `offset + s turn + curvature s^2 / 2`. So its variance at each place of a stretch, and what a label takes from it,
//! follow from three moments of the mass that lies below the place of the label.

use crate::belief::front::grid::{Grid, Unit, metres};
use crate::belief::front::moments::Moments;
use crate::belief::front::tracker::Tracker;
use crate::geometry::approximate::sqrt;
use crate::geometry::lattice::Site;
use crate::motion::dynamics::Pose;

/// Places of a stretch at which its front is looked at: both ends, the middle, and halfway.
pub(crate) const ASKED: usize = 5;

/// A curve that crosses a line more obliquely than this is taken to cross it so, as a cosine.
const OBLIQUE: f32 = 0.3;

/// Times that the place where it crosses is computed anew, as a curve bends.
const CLOSER: u32 = 2;

/// How the mean of a grid, and its front at each place of a stretch, depend on row, column and curvature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    /// By how much the front lies further to the left for a row, a column, and 1/m, metres.
    levers: [[f32; 3]; ASKED],
    /// The mean row, column and curvature.
    mean: [f32; 3],
}

/// Where a front crosses a line that is square to a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// How far to the left of the place, on average, metres.
    pub left: f32,
    /// The standard deviation, metres.
    pub deviation: f32,
}

impl<const K: usize, const M: usize, const L: usize> Grid<K, M, L> {
    /// The mass of the curves that have a site on their +1 side, and its first moments: rows and columns from the
    /// middle, and curvature. `O(K M L)`.
    #[inline(never)]
    fn moments_above(&self, site: Site, blur: f32) -> [f32; 4] {
        let (place, lay) = (metres(site - self.lay.pivot), self.lay);
        let middle = [0.5 * (K as f32 - 1.0), 0.5 * (M as f32 - 1.0)];
        let [mut sum, mut rows, mut columns, mut bends] = [0.0; 4];
        for (layer, bend) in self.mass.iter().zip(lay.bends::<L>()) {
            let (mut in_layer, mut k) = (0.0, -middle[0]);
            for (column, along) in layer.iter().zip(&self.along) {
                let [mass, row] = Self::ramp(lay, *along, bend, place, blur).moments(column);
                in_layer += mass;
                rows += row - middle[1] * mass;
                columns += k * mass;
                k += 1.0;
            }
            sum += in_layer;
            bends += bend * in_layer;
        }
        [sum, rows, columns, bends]
    }
}

impl<const K: usize, const M: usize, const L: usize> Tracker<K, M, L> {
    /// How the front at some places, one behind the other along it, depends on what is not known. `O(K M L)`.
    pub(crate) fn spread_over(&self, places: [Site; ASKED]) -> Spread {
        let (moments, lay) = (Moments::of(&self.grid), self.grid.lay);
        let along = Unit::of(moments.heading(&self.grid));
        let levers = places.map(|site| {
            let [ahead, _] = along.seen(metres(site - lay.pivot));
            [lay.step, ahead * lay.turn, lay.bulge(1.0, ahead)]
        });
        let [column, row] = moments.mean;
        Spread { levers, mean: [row, column, moments.bend] }
    }

    /// By how much a label at a site, that has this share of the curves above it, is expected to reduce the variance of
    /// the front, square metres: the mean over the places of the stretch. `O(K M L)`.
    pub(crate) fn reduces(&self, spread: &Spread, site: Site, share: f32) -> f32 {
        let [mass, rows, columns, bends] = self.grid.moments_above(site, self.blurred());
        let [row, column, bend] = spread.mean;
        let off = [rows - row * mass, columns - column * mass, bends - bend * mass];
        let sum: f32 = spread
            .levers
            .iter()
            .map(|it| {
                let at = it[0] * off[0] + it[1] * off[1] + it[2] * off[2];
                at * at
            })
            .sum();
        let p = self.counted();
        let plus = p * share + (1.0 - p) * (1.0 - share);
        let sharp = 2.0 * p - 1.0;
        let both = plus * (1.0 - plus);
        if both > 0.0 { sharp * sharp * sum / (ASKED as f32 * both) } else { 0.0 }
    }

    /// Where the front crosses the line through a site that is square to a heading, on average, and how well that is
    /// known. Of no meaning before the front [is found](Self::found). `O(K M L)`.
    pub fn beside(&self, Pose { site, heading }: Pose) -> Beside {
        let (place, lay) = (metres(site - self.grid.lay.pivot), self.grid.lay);
        let [mut sum, mut first, mut second] = [0.0; 3];
        let ahead_of = Unit::of(heading);
        for (layer, bend) in self.grid.mass.iter().zip(lay.bends::<L>()) {
            for (column, along) in layer.iter().zip(&self.grid.along) {
                let [ahead, left] = along.seen(place);
                let [cos, sin] = ahead_of.seen([along.x, along.z]);
                let cos = if cos > OBLIQUE { cos } else { OBLIQUE };
                let mut offset = lay.low + 0.5 * lay.step - left;
                for mass in column {
                    let mut to_left = offset / cos;
                    for _ in 0..CLOSER {
                        to_left = (offset + lay.bulge(bend, ahead - to_left * sin)) / cos;
                    }
                    sum += mass;
                    first += mass * to_left;
                    second += mass * to_left * to_left;
                    offset += lay.step;
                }
            }
        }
        let each = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let left = first * each;
        let variance = second * each - left * left;
        let [ahead, _] = Unit::of(heading).seen(place);
        let [cell, turned] = [lay.step, ahead * lay.turn];
        // A cell's own width.
        let own = (cell * cell + turned * turned) / 12.0;
        let variance = (if variance > 0.0 { variance } else { 0.0 }) + own;
        Beside { left, deviation: sqrt(variance) }
    }
}
