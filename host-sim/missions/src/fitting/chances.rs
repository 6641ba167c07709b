//! What a distribution over lines says of places: the mean line, and the chance that a place is on its +1 side.

use nalgebra::{Point2, Vector2};
use rayon::prelude::*;

use crate::fitting::line_posterior::{Cell, LinePosterior};
use crate::fitting::line_set::ByNormal;
use crate::fitting::patch::{Mass, Patch, Quarter};
use crate::world::extent::span;

/// A cell, seen from afar: all its lines lie within so much of its middle.
struct Far {
    quarter: Quarter,
    middle: Point2<f64>,
    half: Vector2<f64>,
    weight: f64,
}

impl LinePosterior {
    /// The integrals over all lines.
    pub fn mass(&self) -> Mass {
        let mut all = Mass::default();
        self.cells.iter().for_each(|cell| all.add(&cell.mass, 1.0));
        all
    }

    /// The mean line: its unit normal, to its +1 side, and its distance along that.
    pub fn mean(&self) -> ByNormal {
        self.mass().line()
    }

    /// The chance that each place lies on the +1 side of the line. Most cells have a place wholly on one side; of the others
    /// the share of their lines counts.
    pub fn chances(&self, places: &[Point2<f64>]) -> Vec<f64> {
        let far = |Cell { patch, mass, .. }: &Cell| {
            let [x, z] = [0, 1].map(|k| span(patch.lines.0.iter().map(|line| line[k])));
            let [from, to] = [0, 1].map(|k| Vector2::new(x[k], z[k]));
            let middle = Point2::from((from + to) / 2.0);
            Far { quarter: patch.quarter, middle, half: (to - from) / 2.0, weight: mass.measure }
        };
        let cells: Vec<_> = self.cells.iter().map(|cell| (far(cell), cell)).collect();
        let total: f64 = cells.iter().map(|(far, _)| far.weight).sum();
        let chance = |at: &Point2<f64>| {
            let seen = Quarter::ALL.map(|it| it.seen(*at));
            let share = |(far, cell): &(Far, &Cell)| {
                let [ahead, left] = seen[usize::from(far.quarter.0)];
                let height = left - far.middle.x * ahead - far.middle.y;
                let spread = ahead.abs() * far.half.x + far.half.y;
                if height.abs() >= spread {
                    return if height > 0.0 { far.weight } else { 0.0 };
                }
                let of = |it: Option<Patch>| it.map_or(0.0, |it| it.mass(|_| 1.0).measure);
                let [above, below] = cell.patch.split([ahead, left]).map(of);
                far.weight * above / (above + below).max(f64::MIN_POSITIVE)
            };
            cells.iter().map(share).sum::<f64>() / total
        };
        places.par_iter().map(chance).collect()
    }
}
