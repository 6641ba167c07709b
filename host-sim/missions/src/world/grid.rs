//! Values in cells, as rasters of every format have them, and their limits.

use anyhow::{Result, bail};
use nalgebra::Point2;
use planner_core::lattice::{LIMIT, UNITS_PER_METRE};

/// The most cells.
const MOST_CELLS: usize = 4_000_000;

/// How far the lattice reaches, metres.
const REACH: f64 = LIMIT as f64 / UNITS_PER_METRE as f64;

/// Values in cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// The corner with the least coordinates, metres.
    pub corner: Point2<f64>,
    /// The size of a cell, metres.
    pub cell: [f64; 2],
    /// Cells in a row.
    pub columns: usize,
    /// The values, row by row from the greatest z down. What has no value is not a number.
    pub values: Vec<f64>,
}

impl Grid {
    /// Puts its least corner at that of a rectangle, if it lies beyond the lattice, as a raster in coordinates of a map
    /// does. Returns where the corner was.
    pub fn brought_to(&mut self, rectangle: [Point2<f64>; 2]) -> Option<[f64; 2]> {
        let rows = self.values.len() / self.columns;
        let size = [self.cell[0] * self.columns as f64, self.cell[1] * rows as f64];
        let corner: [f64; 2] = self.corner.into();
        let is_beyond = |axis: usize| corner[axis] > REACH || corner[axis] + size[axis] < -REACH;
        (is_beyond(0) || is_beyond(1)).then(|| {
            self.corner = rectangle[0];
            corner
        })
    }
}

/// Whether there are so many cells as can be handled.
///
/// # Errors
/// The count.
pub(super) fn check_cells(columns: usize, rows: usize) -> Result<()> {
    let count = columns.checked_mul(rows);
    if !count.is_some_and(|count| (1..=MOST_CELLS).contains(&count)) {
        bail!("found {columns} x {rows} cells, expected 1 to {MOST_CELLS}");
    }
    Ok(())
}

/// Whether cells have such a size, metres.
///
/// # Errors
/// Names `field` and the size.
pub(super) fn check_size(field: &str, cell: [f64; 2]) -> Result<()> {
    if !cell.iter().all(|it| (1e-6..=1e6).contains(it)) {
        bail!("found {field} {cell:?}, expected metres, above 0");
    }
    Ok(())
}
