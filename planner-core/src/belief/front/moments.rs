//! The first moments of a grid, and its sums over rows, columns and layers.

use crate::belief::front::grid::Grid;
use crate::belief::front::lay::{Unit, angle};
use crate::geometry::approximate::heading;
use crate::geometry::heading::Heading;

/// Sums of the masses of a grid, and moments about the middle of its cells, in cells and columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments<const K: usize, const M: usize, const L: usize> {
    pub(crate) total: f32,
    /// The mass of each direction in each layer.
    pub(crate) layers: [[f32; K]; L],
    /// The mass of each direction, and of each offset.
    pub(crate) columns: [f32; K],
    pub(crate) rows: [f32; M],
    /// The mean column and the mean row, from the middle.
    pub(crate) mean: [f32; 2],
    /// Their variances, the width of a cell included, and their covariance.
    pub(crate) variance: [f32; 2],
    pub(crate) covariance: f32,
    /// The mean curvature, 1/m.
    pub(crate) bend: f32,
}

impl<const K: usize, const M: usize, const L: usize> Moments<K, M, L> {
    /// `O(K M L)`.
    #[inline(never)]
    pub(crate) fn of(grid: &Grid<K, M, L>) -> Self {
        let mut layers = [[0.0; K]; L];
        let (mut columns, mut rows, mut products) = ([0.0; K], [0.0; M], 0.0);
        for (layer, sums) in grid.mass.iter().zip(&mut layers) {
            products += sum_up(layer.as_flattened(), sums, &mut rows);
            columns.iter_mut().zip(&*sums).for_each(|(column, sum)| *column += sum);
        }
        let (mut total, mut bent) = (0.0, 0.0);
        for (layer, bend) in layers.iter().zip(grid.lay.bends::<L>()) {
            let mass: f32 = layer.iter().sum();
            (total, bent) = (total + mass, bent + bend * mass);
        }
        let each = if total > 0.0 { 1.0 / total } else { 0.0 };
        let [by_column, by_row] = [of_masses(&columns, each), of_masses(&rows, each)];
        Self {
            total,
            layers,
            columns,
            rows,
            mean: [by_column[0], by_row[0]],
            variance: [by_column[1], by_row[1]],
            covariance: products * each - by_column[0] * by_row[0],
            bend: bent * each,
        }
    }

    /// Offset and direction are correlated by this, from -1 to 1.
    pub(crate) fn correlation_squared(&self) -> f32 {
        self.covariance * self.covariance / (self.variance[0] * self.variance[1])
    }

    /// The mean direction: where columns go all around, that of the mean vector.
    pub(crate) fn heading(&self, grid: &Grid<K, M, L>) -> Heading {
        let lay = grid.lay;
        if !lay.is_whole::<K>() {
            return lay.heading.turned(angle(self.mean[0] * lay.turn));
        }
        let sum = self.columns.iter().zip(&grid.along).fold(Unit::ZERO, |sum, (mass, it)| Unit {
            x: sum.x + mass * it.x,
            z: sum.z + mass * it.z,
        });
        let has_one = sum.x.abs() + sum.z.abs() > 1e-6 * self.total;
        if has_one { heading(sum.x, sum.z) } else { lay.heading }
    }
}

/// Takes the sum of each column of a layer, and adds the masses to the rows. Returns the sum of the masses times the
/// numbers of their column and row, counted from the middle.
#[inline(never)]
fn sum_up(layer: &[f32], columns: &mut [f32], rows: &mut [f32]) -> f32 {
    let (mut products, mut k) = (0.0, -0.5 * (columns.len() as f32 - 1.0));
    let half = 0.5 * (rows.len() as f32 + 1.0);
    for (column, masses) in columns.iter_mut().zip(layer.chunks(rows.len().max(1))) {
        // A cell counts once more for each that comes after it.
        let (mut sum, mut more) = (0.0, 0.0);
        let mut add = |(row, mass): (&mut f32, &f32)| {
            *row += mass;
            sum += mass;
            more += sum;
        };
        let (row_fours, row_others) = rows.as_chunks_mut::<4>();
        let (fours, others) = masses.as_chunks::<4>();
        for (row, four) in row_fours.iter_mut().zip(fours) {
            row.iter_mut().zip(four).for_each(&mut add);
        }
        row_others.iter_mut().zip(others).for_each(add);
        *column = sum;
        products += k * (half * sum - more);
        k += 1.0;
    }
    products
}

/// The mean and the variance of some masses, numbered from the middle.
fn of_masses(masses: &[f32], each: f32) -> [f32; 2] {
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
