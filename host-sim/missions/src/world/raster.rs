//! A raster of labels as the boundary: each cell has one label, and beyond the raster the nearest cell counts.

use std::collections::BTreeMap;

use nalgebra::Point2;
use planner_core::{Label, Reading};

use crate::world::boundary::{BoundaryRecord, Curve};
use crate::world::grid::Grid;
use crate::world::way::{self, Way};

/// How far the cells of the border reach, metres: beyond every place of the lattice.
const FAR: f64 = 1e6;

/// A raster of labels.
#[derive(Clone, Debug)]
pub struct Raster {
    /// The file.
    name: String,
    threshold: f64,
    /// The corner with the least coordinates.
    corner: Point2<f64>,
    /// The size of a cell, metres.
    cell: [f64; 2],
    columns: usize,
    /// Whether a cell has the label +1, row by row from the least z.
    is_positive: Vec<bool>,
    /// Between cells of different labels, with the +1 side on the left.
    ways: Vec<Way>,
}

/// A corner of cells, by its column and its row.
type Corner = [usize; 2];

impl Raster {
    /// The labels of a grid's values: +1 from the threshold up. The grid's values stand in rows from the greatest z
    /// down; what has no value is -1.
    pub fn new(name: String, grid: &Grid, threshold: f64) -> Self {
        let rows = grid.values.chunks_exact(grid.columns).rev().flatten();
        let is_positive = rows.map(|value| *value >= threshold).collect();
        let mut raster = Self {
            name,
            threshold,
            corner: grid.corner,
            cell: grid.cell,
            columns: grid.columns,
            is_positive,
            ways: Vec::new(),
        };
        raster.ways = raster.borders();
        raster
    }

    fn rows(&self) -> usize {
        self.is_positive.len() / self.columns
    }

    fn label(&self, column: usize, row: usize) -> bool {
        self.is_positive[row * self.columns + column]
    }

    /// The place of a corner. Cells of the border have no end.
    fn place(&self, [column, row]: Corner) -> Point2<f64> {
        let axis = |number: usize, count: usize, from: f64, size: f64| match number {
            0 => -FAR,
            _ if number == count => FAR,
            _ => from + size * number as f64,
        };
        Point2::new(
            axis(column, self.columns, self.corner.x, self.cell[0]),
            axis(row, self.rows(), self.corner.y, self.cell[1]),
        )
    }

    /// The sides of cells between different labels, each with the +1 cell on its left.
    fn edges(&self) -> impl Iterator<Item = [Corner; 2]> + '_ {
        let directed =
            |is_left: bool, from: Corner, to: Corner| if is_left { [from, to] } else { [to, from] };
        let cells =
            (0..self.rows()).flat_map(|row| (0..self.columns).map(move |column| [column, row]));
        cells.flat_map(move |[column, row]| {
            let own = self.label(column, row);
            let differs = |other: Option<bool>| other.is_some_and(|it| it != own);
            let before = column.checked_sub(1).map(|it| self.label(it, row));
            let below = row.checked_sub(1).map(|it| self.label(column, it));
            let left = differs(before).then(|| directed(!own, [column, row], [column, row + 1]));
            let low = differs(below).then(|| directed(own, [column, row], [column + 1, row]));
            left.into_iter().chain(low)
        })
    }

    /// The edges joined to ways, each piece as long as it is straight.
    fn borders(&self) -> Vec<Way> {
        let mut onwards: BTreeMap<Corner, Vec<Corner>> = BTreeMap::new();
        let mut arriving: BTreeMap<Corner, usize> = BTreeMap::new();
        for [from, to] in self.edges() {
            onwards.entry(from).or_default().push(to);
            *arriving.entry(to).or_default() += 1;
        }
        // Ways that begin at the border of the raster come first. What is left are rings.
        let is_open = |at: &Corner| !arriving.contains_key(at);
        let mut begins: Vec<Corner> = onwards.keys().copied().collect();
        begins.sort_by_key(|at| !is_open(at));
        let mut ways = Vec::new();
        for begin in begins {
            while let Some(first) = onwards.get_mut(&begin).and_then(Vec::pop) {
                let mut corners = vec![begin, first];
                let mut at = first;
                while let Some(next) = onwards.get_mut(&at).and_then(Vec::pop) {
                    let before = corners[corners.len() - 2];
                    if (0..2).any(|axis| before[axis] == at[axis] && at[axis] == next[axis]) {
                        corners.pop();
                    }
                    corners.push(next);
                    at = next;
                }
                ways.push(corners.into_iter().map(|it| self.place(it)).collect());
            }
        }
        ways
    }
}

impl Curve for Raster {
    fn side(&self, at: Point2<f64>) -> Reading {
        // A place beyond the raster is clamped to it; a cast takes what is below 0 to 0.
        let number =
            |off: f64, size: f64, count: usize| ((off / size).floor() as usize).min(count - 1);
        let column = number(at.x - self.corner.x, self.cell[0], self.columns);
        let row = number(at.y - self.corner.y, self.cell[1], self.rows());
        let label = if self.label(column, row) { Label::Positive } else { Label::Negative };
        label.into()
    }

    fn distance(&self, at: Point2<f64>) -> f64 {
        way::distance(at, &self.ways)
    }

    fn ways(&self, _: [Point2<f64>; 2]) -> Vec<Way> {
        self.ways.clone()
    }

    fn record(&self) -> BoundaryRecord {
        let raster = Some(self.name.clone());
        BoundaryRecord { raster, threshold: Some(self.threshold), ..BoundaryRecord::default() }
    }
}
