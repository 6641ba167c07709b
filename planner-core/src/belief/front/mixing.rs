//! Masses pass to cells nearby: between layers, directions and offsets.

use crate::belief::front::grid::Grid;
use crate::belief::front::walk;
use crate::geometry::approximate::sqrt;

impl<const K: usize, const M: usize, const L: usize> Grid<K, M, L> {
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
    use crate::belief::front::grid::tests::{grid, total};

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
}
