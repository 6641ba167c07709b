//! Values in cells, as rasters of every format have them, and their limits.

use anyhow::{Result, bail};
use nalgebra::{Point2, Vector2};
use planner_core::lattice::{LIMIT, UNITS_PER_METRE};

/// The most cells.
const MOST_CELLS: usize = 4_000_000;

/// How far the lattice reaches, metres.
const REACH: f64 = LIMIT as f64 / UNITS_PER_METRE as f64;

/// What a file says that its coordinates are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Longitudes and latitudes, degrees.
    Degrees,
    /// Metres of the system with this number in the EPSG registry.
    Metres(u16),
}

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
    fn rows(&self) -> usize {
        self.values.len() / self.columns
    }

    /// How far it reaches from its corner, metres.
    fn size(&self) -> Vector2<f64> {
        Vector2::new(self.cell[0] * self.columns as f64, self.cell[1] * self.rows() as f64)
    }

    /// Its middle.
    pub fn middle(&self) -> Point2<f64> {
        self.corner + self.size() / 2.0
    }

    /// The column and the row from the least z of the cell that a place lies in, and whether there is one. Beyond the grid the
    /// nearest one.
    fn cell_at(&self, at: Point2<f64>) -> ([usize; 2], bool) {
        let [x, z] = [0, 1].map(|k| ((at[k] - self.corner[k]) / self.cell[k]).floor());
        let count = [self.columns, self.rows()].map(|it| it as f64);
        let is_inside = (0.0..count[0]).contains(&x) && (0.0..count[1]).contains(&z);
        let nearest = |it: f64, count: f64| it.clamp(0.0, count - 1.0) as usize;
        ([nearest(x, count[0]), nearest(z, count[1])], is_inside)
    }

    /// The same values drawn anew on a rectangle of another map; `source` brings its places to this one.
    ///
    /// # Errors
    /// That of `source`, and if nothing of the grid lies in the rectangle.
    pub(crate) fn drawn_on(
        &self,
        [min, max]: [Point2<f64>; 2],
        source: impl Fn(Point2<f64>) -> Result<Point2<f64>>,
    ) -> Result<Self> {
        let size = max - min;
        let [from, to] = [source(min)?, source(max)?];
        // The size of a cell on the rectangle, by how far apart its corners are here.
        let own = [0, 1].map(|k| self.cell[k] * size[k] / (to[k] - from[k]).abs() / FINER);
        let least = (size.x * size.y / MOST_CELLS as f64).sqrt() * 1.01;
        let side = own[0].min(own[1]).max(least).min(size.min());
        let [columns, rows] = [size.x, size.y].map(|it| (it / side).ceil() as usize);
        let source = |column: usize, row: usize| {
            source(min + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * side)
        };
        let (mut values, mut is_met) = (vec![f64::NAN; columns * rows], false);
        for (top, left) in blocks(rows, columns) {
            let [right, bottom] = [left + KNOTS, top + KNOTS];
            let above = [source(left, top)?, source(right, top)?];
            let below = [source(left, bottom)?, source(right, bottom)?];
            for (row, column) in (top..rows.min(bottom))
                .flat_map(|z| (left..columns.min(right)).map(move |x| (z, x)))
            {
                let [u, v] = [column - left, row - top].map(|it| it as f64 / KNOTS as f64);
                let [above, below] = [above, below].map(|[a, b]| a.lerp(&b, u));
                let ([x, z], is_inside) = self.cell_at(above.lerp(&below, v));
                is_met |= is_inside;
                // Rows stand from the greatest z down.
                values[(rows - 1 - row) * columns + column] =
                    self.values[(self.rows() - 1 - z) * self.columns + x];
            }
        }
        if !is_met {
            bail!(
                "one of the ground of the area, in the coordinates that it names, of the area or of truth.crs"
            );
        }
        Ok(Self { corner: min, cell: [side; 2], columns, values })
    }

    /// Puts its least corner at that of a rectangle, if it lies beyond the lattice, as a raster in coordinates of a map
    /// does. Returns where the corner was.
    pub fn brought_to(&mut self, rectangle: [Point2<f64>; 2]) -> Option<[f64; 2]> {
        let size = self.size();
        let corner: [f64; 2] = self.corner.into();
        let is_beyond = |axis: usize| corner[axis] > REACH || corner[axis] + size[axis] < -REACH;
        (is_beyond(0) || is_beyond(1)).then(|| {
            self.corner = rectangle[0];
            corner
        })
    }
}

/// Cells between two places that are brought to another map; those between lie on a straight line.
const KNOTS: usize = 32;

/// On another map a cell is drawn by so many along each axis, so that its sides lie within an eighth of a cell of where they
/// were.
const FINER: f64 = 4.0;

/// The first row and the first column of each block of [`KNOTS`] rows and columns.
fn blocks(rows: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    let all = (0..rows).step_by(KNOTS);
    all.flat_map(move |row| (0..columns).step_by(KNOTS).map(move |column| (row, column)))
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
