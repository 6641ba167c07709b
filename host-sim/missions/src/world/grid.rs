//! Values in cells, as rasters of every format have them, and their limits.

use anyhow::{Result, bail};
use nalgebra::{Point2, Vector2};
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
    /// The value of the cell that a place lies in; not a number beyond.
    fn value(&self, at: Point2<f64>) -> f64 {
        let rows = self.values.len() / self.columns;
        let [column, row] = [0, 1].map(|k| ((at[k] - self.corner[k]) / self.cell[k]).floor());
        if column < 0.0 || row < 0.0 || column >= self.columns as f64 || row >= rows as f64 {
            return f64::NAN;
        }
        self.values[(rows - 1 - row as usize) * self.columns + column as usize]
    }

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

/// Places between which a way of bringing places elsewhere counts as straight, cells.
const KNOTS: usize = 32;

/// Draws a grid anew where another map lies: `source` says where on the old grid a place of the rectangle is. The cells are
/// of the old size, or larger if they would be too many. Each has the value of the old cell that its middle lies in.
///
/// # Errors
/// That of `source`, and if nothing of the old grid lies in the rectangle.
pub(crate) fn drawn_on(
    old: &Grid,
    [min, max]: [Point2<f64>; 2],
    source: impl Fn(Point2<f64>) -> Result<Point2<f64>>,
) -> Result<Grid> {
    let size = max - min;
    let [from, to] = [source(min)?, source(max)?];
    let scale = [(to.x - from.x).abs() / size.x, (to.y - from.y).abs() / size.y];
    let least = (size.x * size.y / MOST_CELLS as f64).sqrt() * 1.01;
    let side = (old.cell[0] / scale[0]).min(old.cell[1] / scale[1]).max(least).min(size.min());
    let [columns, rows] = [size.x, size.y].map(|it| (it / side).ceil() as usize);
    let middle = |column: usize, row: usize| {
        min + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * side
    };
    let mut values = vec![f64::NAN; columns * rows];
    for (top, left) in
        (0..rows).step_by(KNOTS).flat_map(|z| (0..columns).step_by(KNOTS).map(move |x| (z, x)))
    {
        let corner = |x, z| source(middle(left + x, top + z));
        let [a, b, c, d] =
            [corner(0, 0)?, corner(KNOTS, 0)?, corner(0, KNOTS)?, corner(KNOTS, KNOTS)?];
        for (row, column) in (top..rows.min(top + KNOTS))
            .flat_map(|z| (left..columns.min(left + KNOTS)).map(move |x| (z, x)))
        {
            let [u, v] = [column - left, row - top].map(|it| it as f64 / KNOTS as f64);
            let at = a.lerp(&b, u).lerp(&c.lerp(&d, u), v);
            // Rows stand from the greatest z down.
            values[(rows - 1 - row) * columns + column] = old.value(at);
        }
    }
    if values.iter().all(|it| it.is_nan()) {
        bail!("one of the ground of the area, in the coordinates of the area or of truth.crs");
    }
    Ok(Grid { corner: min, cell: [side; 2], columns, values })
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
