//! What is known of a front over a stretch of it, and how much a label is expected to narrow that.
//!
//! About the mean, a curve of the grid has at the distance `s` ahead of the pivot the offset
//! `offset + s turn + curvature s^2 / 2`. So three moments say its variance at each place of a stretch. Those of the mass
//! below the place of a label say what the label takes from it.

use crate::belief::front::grid::Grid;
use crate::belief::front::lay::{Unit, metres};
use crate::belief::front::moments::Moments;
use crate::belief::front::tracker::Tracker;
use crate::geometry::approximate::sqrt;
use crate::geometry::heading::Heading;
use crate::geometry::lattice::Site;

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
        let per_cell = 1.0 / lay.step;
        let [mut sum, mut rows, mut columns, mut bends] = [0.0; 4];
        let mut k = -0.5 * (K as f32 - 1.0);
        for (number, along) in self.along.iter().enumerate() {
            let straight = lay.ramp(*along, 0.0, place, blur);
            let bulge = lay.bulge(per_cell, along.seen(place)[0]);
            let mut in_column = 0.0;
            for (layer, bend) in self.mass.iter().zip(lay.bends::<L>()) {
                let ramp = straight.lower(bend * bulge);
                let [mass, row] = layer.get(number).map_or([0.0; 2], |it| ramp.moments(it));
                in_column += mass;
                rows += row;
                bends += bend * mass;
            }
            sum += in_column;
            columns += k * in_column;
            k += 1.0;
        }
        rows -= 0.5 * (M as f32 - 1.0) * sum;
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

    /// What a label at a site is expected to take of the front's variance, square metres: the mean over the places of the
    /// stretch. The site has this share of the curves above it. `O(K M L)`.
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
    pub fn beside(&self, site: Site, heading: Heading) -> Beside {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::Belief as _;
    use crate::belief::front::settings::Front;
    use crate::belief::noise::Noise;
    use crate::belief::sample::Label;
    use crate::geometry::area::Area;
    use crate::geometry::heading::Heading;

    fn at(x: f64, z: f64) -> Site {
        Site::metres([x, z]).unwrap()
    }

    /// A tracker that has gone to and fro across `z = 10 + 0.1 x`.
    fn flown(p: f64) -> Tracker<16, 16, 3> {
        let area = Area::metres([0.0, 0.0], [20.0, 20.0]).unwrap();
        let front = Front::bending(60.0).and_then(|it| it.moving(0.02)).unwrap();
        let mut tracker = Tracker::new(area, front, Noise::new(p).unwrap());
        for k in 0..40 {
            let (x, aside) = (0.3 * f64::from(k), 0.4 * f64::from(k % 5) - 0.7);
            let site = at(x, 10.0 + 0.1 * x + aside);
            tracker.moved(site, 1.0);
            let label = if aside > 0.0 { Label::Positive } else { Label::Negative };
            tracker.observe(site, label.into()).unwrap();
        }
        tracker
    }

    const HEADING: f64 = 0.0997;

    fn beside(tracker: &Tracker<16, 16, 3>, site: Site) -> Beside {
        tracker.beside(site, Heading::from_radians(HEADING).unwrap())
    }

    #[test]
    fn the_front_is_known_best_where_the_robot_is() {
        let tracker = flown(0.9);
        let waist = tracker.waist();
        let there = tracker.beside(waist.site, waist.heading);
        assert!(there.left.abs() < 0.1 && (there.deviation / waist.deviation - 1.0).abs() < 0.3);
        let known = [11.0, 5.0, 0.0, -6.0].map(|x| beside(&tracker, at(x, 10.0 + 0.1 * x)));
        assert!(known.is_sorted_by(|a, b| a.deviation < b.deviation), "{known:?}");
        assert!(known.iter().all(|it| it.left.abs() < 2.5 * it.deviation), "{known:?}");
        // A place elsewhere on the same line across says the same.
        let off = beside(&tracker, at(5.0 - 0.0995 * 2.0, 10.5 + 0.995 * 2.0));
        assert!((off.left + 2.0 - known[1].left).abs() < 0.02, "{off:?} {known:?}");
        assert!((off.deviation / known[1].deviation - 1.0).abs() < 0.05, "{off:?} {known:?}");
    }

    /// Against what either label leaves of the variance, in the same cells.
    #[test]
    fn a_label_is_expected_to_take_what_it_takes() {
        for p in [1.0, 0.9, 0.7] {
            let tracker = flown(p);
            let places = [-3.0, 1.5, 6.0, 10.5, 15.0].map(|x| at(x, 10.0 + 0.1 * x));
            let spread = tracker.spread_over(places);
            let of = |tracker: &Tracker<16, 16, 3>| {
                let variance = |site| beside(tracker, site).deviation.powi(2);
                places.map(variance).iter().sum::<f32>() / places.len() as f32
            };
            for (x, off) in [(-3.0, 0.0), (0.0, 0.3), (6.0, 0.1), (14.0, -0.3), (18.0, 0.2)] {
                let site = at(x, 10.0 + 0.1 * x + off);
                let share = tracker.share_above(site);
                let chance = tracker.chance(site) as f32;
                let before = of(&tracker);
                let [plus, minus] = [Label::Positive, Label::Negative].map(|label| {
                    let mut after = tracker.clone();
                    assert_eq!(after.observe_on_the_way(site, label.into()), Ok(true));
                    of(&after)
                });
                let taken = before - chance * plus - (1.0 - chance) * minus;
                let expected = tracker.reduces(&spread, site, share);
                let error = (expected - taken).abs();
                assert!(
                    error < 0.15 * taken + 0.01 * before,
                    "{p}, {x}: {expected}, {taken} of {before}"
                );
            }
        }
    }
}
