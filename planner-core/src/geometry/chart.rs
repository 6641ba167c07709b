//! Ground of any shape: square cells, of which each is open or closed.
//!
//! A lake with bays and islands is no convex polygon. A chart covers it with cells, and the cells that lie wholly in the
//! water are open. Motions stay on open cells. A test looks at the rows of cells that a motion meets, and in each row at
//! all cells between its ends at once. So it takes as long along a ragged shore as along a straight one.
//!
//! Tests are exact for motions that keep no distance. Where a distance is asked for, a square of it stands for the disc, so
//! motions stay up to 1.5 times as far away.

use core::ops::RangeInclusive;

use crate::geometry::area::Area;
use crate::geometry::hull::{Extent, edges};
use crate::geometry::lattice::{LIMIT, Site, Vector};
use crate::geometry::walk::{Walk, along};

/// Open and closed cells. All ground outside of them is closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chart<'a> {
    bounds: Area,
    /// The side of a cell, lattice units.
    side: u32,
    columns: u16,
    rows: u16,
    cells: &'a [u32],
}

/// Why there is no such chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ChartError {
    /// There are from 1 to [`Chart::MOST_CELLS`] rows and as many columns.
    Size,
    /// Cells have a side, and all of the chart lies within 8,192 m of the origin.
    Beyond,
    /// So many words are needed for the cells.
    Words(usize),
}

impl core::fmt::Display for ChartError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Size => write!(f, "a chart has 1 to {} rows and columns", Chart::MOST_CELLS),
            Self::Beyond => f.write_str("a chart lies within 8192 m of the origin"),
            Self::Words(words) => write!(f, "a chart of this size has {words} words"),
        }
    }
}

impl core::error::Error for ChartError {}

impl<'a> Chart<'a> {
    /// A chart has so many rows and columns at most.
    pub const MOST_CELLS: u16 = 256;

    /// Cells by rows, that of the least z first. A row is so many [words](Self::words_in) long. Bit `k` of its word `w` is
    /// column `32 w + k`, counted from the least x, and 1 is open. `side` is that of a cell, lattice units.
    ///
    /// # Errors
    /// [`ChartError`].
    pub fn new(
        corner: Site,
        side: u32,
        [columns, rows]: [u16; 2],
        cells: &'a [u32],
    ) -> Result<Self, ChartError> {
        let is_count = |it: u16| (1..=Self::MOST_CELLS).contains(&it);
        if !is_count(columns) || !is_count(rows) {
            return Err(ChartError::Size);
        }
        let reach = |count: u16| {
            let units = u64::from(side) * u64::from(count);
            i32::try_from(units).ok().filter(|it| (1..2 * LIMIT).contains(it))
        };
        let far = reach(columns).zip(reach(rows)).and_then(|(x, z)| Vector::new(x, z));
        let far = far.and_then(|far| corner.step(far).ok()).ok_or(ChartError::Beyond)?;
        let bounds = Area::new(corner, far).map_err(|_| ChartError::Beyond)?;
        let words = Self::words_in(columns) * usize::from(rows);
        if cells.len() != words {
            return Err(ChartError::Words(words));
        }
        Ok(Self { bounds, side, columns, rows, cells })
    }

    /// The words of a row of so many columns.
    pub const fn words_in(columns: u16) -> usize {
        columns.div_ceil(32) as usize
    }

    /// The side of a cell, lattice units.
    pub const fn side(&self) -> u32 {
        self.side
    }

    /// The rectangle around all cells.
    pub const fn bounds(&self) -> Area {
        self.bounds
    }

    /// Columns and rows.
    pub const fn size(&self) -> [u16; 2] {
        [self.columns, self.rows]
    }

    /// The cells, as [`new`](Self::new) takes them.
    pub const fn cells(&self) -> &'a [u32] {
        self.cells
    }

    /// Whether a cell is open, by its column and its row. Those outside are not.
    pub fn is_open(&self, [column, row]: [u16; 2]) -> bool {
        column < self.columns
            && row < self.rows
            && self.word(row, usize::from(column / 32)) >> (column % 32) & 1 == 1
    }

    /// The column and the row of the cell that a site lies in; `None` outside.
    pub fn cell_of(&self, site: Site) -> Option<[u16; 2]> {
        let Vector { x, z } = site - self.bounds.min();
        let at = |it: i32, count: u16| {
            let cell = u32::try_from(it).ok()?.checked_div(self.side)?;
            u16::try_from(cell).ok().filter(|cell| *cell < count)
        };
        Some([at(x, self.columns)?, at(z, self.rows)?])
    }

    /// The middle of a cell.
    pub fn middle_of(&self, [column, row]: [u16; 2]) -> Option<Site> {
        let at = |it: u16| (u64::from(self.side) * (2 * u64::from(it) + 1) / 2) as i32;
        self.bounds.min().step(Vector { x: at(column), z: at(row) }).ok()
    }

    /// Whether all of a hull lies on open cells, with so many lattice units of ground about it.
    pub(crate) fn holds(&self, hull: &[Site], by: u32) -> bool {
        self.holds_but_for(None, hull, by)
    }

    /// Whether a motion leads away from where errors have brought the agent. `swept` are the corners of its hull, the first
    /// of them where it begins. Ashore, the cell that the agent stands on counts as open. Where all cells about it are
    /// closed too, any motion is as good as another.
    pub(crate) fn lets_out(&self, swept: &[Site]) -> bool {
        let own = swept.first().and_then(|it| self.cell_of(*it));
        self.holds_but_for(own, swept, 0) || own.is_none_or(|own| self.is_inland(own))
    }

    /// Whether a cell and all about it are closed.
    fn is_inland(&self, [column, row]: [u16; 2]) -> bool {
        let [columns, rows] = [column, row].map(|it| it.saturating_sub(1)..=it.saturating_add(1));
        rows.flat_map(|z| columns.clone().map(move |x| [x, z])).all(|it| !self.is_open(it))
    }

    /// As [`holds`](Self::holds), where one cell counts as open.
    fn holds_but_for(&self, own: Option<[u16; 2]>, hull: &[Site], by: u32) -> bool {
        let by = i64::from(by.min(LIMIT.unsigned_abs()));
        let side = i64::from(self.side);
        let from = |at: Site| {
            let Vector { x, z } = at - self.bounds.min();
            [i64::from(x), i64::from(z)]
        };
        let (mut least, mut most) = (i64::MAX, i64::MIN);
        for [_, z] in hull.iter().map(|it| from(*it)) {
            (least, most) = (least.min(z - by), most.max(z + by));
        }
        let row_of = |z: i64| u16::try_from(self.cells_to(z)?).ok().filter(|it| *it < self.rows);
        let (Some(first), Some(last)) = (row_of(least), row_of(most)) else { return false };
        if let [a, b] = hull {
            return self.holds_way(own, [from(*a), from(*b)], by, first..=last);
        }
        (first..=last).all(|row| {
            let low = i64::from(row) * side - by;
            let high = low + side + 2 * by;
            let (mut left, mut right) = (i64::MAX, i64::MIN);
            for (a, b) in edges(hull) {
                let (a, b) = (from(a), from(b));
                let [a, b] = if a[1] <= b[1] { [a, b] } else { [b, a] };
                if a[1] <= high && b[1] >= low {
                    let at = |z: i64| along(a, b, z);
                    let ends = [at(low.max(a[1])), at(high.min(b[1]))];
                    left = left.min(ends[0].0).min(ends[1].0);
                    right = right.max(ends[0].1).max(ends[1].1);
                }
            }
            left > right || self.is_open_between(row, [left - by, right + by], own)
        })
    }

    /// The same of a straight way in the rows that it meets. It may be long, so it takes no division in a row.
    fn holds_way(
        &self,
        own: Option<[u16; 2]>,
        [a, b]: [[i64; 2]; 2],
        by: i64,
        mut rows: RangeInclusive<u16>,
    ) -> bool {
        let [a, b] = if a[1] <= b[1] { [a, b] } else { [b, a] };
        let side = i64::from(self.side);
        let low = i64::from(*rows.start()) * side - by;
        let high = low + side + 2 * by;
        let [mut enters, mut leaves] = [low, high].map(|z| Walk::new((a, b), z, side));
        rows.all(|row| {
            let (enter, leave) = (enters.next([a, b]), leaves.next([a, b]));
            let ends = [enter.0.min(leave.0) - by, enter.1.max(leave.1) + by];
            self.is_open_between(row, ends, own)
        })
    }

    /// How many cells fit in a length; `None` if it is negative.
    fn cells_to(&self, length: i64) -> Option<u32> {
        u32::try_from(length).ok()?.checked_div(self.side)
    }

    /// The rows that a box meets with so much ground about it, at most.
    pub(crate) fn rows_of(&self, extent: Extent) -> u32 {
        extent.height().checked_div(self.side).unwrap_or(0).saturating_add(2).min(self.rows.into())
    }

    /// Whether all cells of a row from one to another coordinate are open, or that one.
    fn is_open_between(&self, row: u16, [left, right]: [i64; 2], own: Option<[u16; 2]>) -> bool {
        let own = own.filter(|it| it[1] == row).map(|it| u32::from(it[0]));
        let (Some(first), Some(last)) = (self.cells_to(left), self.cells_to(right)) else {
            return false;
        };
        last < self.columns.into()
            && (first / 32..=last / 32).all(|word| {
                let from = if word == first / 32 { first % 32 } else { 0 };
                let to = if word == last / 32 { last % 32 } else { 31 };
                let mask = u32::MAX << from & u32::MAX >> (31 - to);
                let own = own.filter(|it| it / 32 == word).map_or(0, |it| 1 << (it % 32));
                (self.word(row, word as usize) | own) & mask == mask
            })
    }

    fn word(&self, row: u16, word: usize) -> u32 {
        let first = usize::from(row) * Self::words_in(self.columns);
        self.cells.get(first + word).copied().unwrap_or(0)
    }

    /// From a site that has less than so much open ground about it to the middle of a cell that has it, among the nearest.
    /// The way there is straight, and [leads out](Self::lets_out). `None` from any other site, and where there is no such way
    /// within sixteen cells.
    pub(crate) fn way_home(&self, from: Site, by: u32) -> Option<Vector> {
        let Vector { x, z } = from - self.bounds.min();
        let side = self.side as i32;
        let [column, row] = [x, z].map(|it| it.checked_div_euclid(side).unwrap_or(0));
        let open = |column: i32, row: i32| {
            let cell = [u16::try_from(column).ok()?, u16::try_from(row).ok()?];
            self.is_open(cell).then(|| self.middle_of(cell)).flatten()
        };
        if self.holds(&[from], by) {
            return None;
        }
        let is_home = |to: &Site| self.holds(&[*to], by) && self.lets_out(&[from, *to]);
        (0..=16).find_map(|ring: i32| {
            let all = (-ring..=ring).flat_map(|k| [(k, -ring), (k, ring), (-ring, k), (ring, k)]);
            let homes = all.filter_map(|(x, z)| open(column + x, row + z)).filter(is_home);
            homes.map(|home| home - from).min_by_key(|way| way.dot(*way))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;
    use crate::geometry::hull::are_apart;

    const SIDE: u32 = 1_000;

    fn at(x: i32, z: i32) -> Site {
        Site::new(x, z).unwrap()
    }

    /// The corners of a cell, so much smaller on each side.
    fn square(chart: &Chart<'_>, [column, row]: [i32; 2], less: i32) -> [Site; 4] {
        let (from, side) = (chart.bounds().min(), SIDE as i32);
        let [x, z] = [from.x() + column * side + less, from.z() + row * side + less];
        let far = side - 2 * less;
        [at(x, z), at(x + far, z), at(x + far, z + far), at(x, z + far)]
    }

    /// Every closed cell, with some about the chart, is judged by the exact distance of hulls.
    #[test]
    fn a_hull_is_held_where_it_touches_no_closed_cell() {
        let mut draws = Draws::new(7);
        let (mut held, mut refused) = (0, 0);
        for case in 0..4_000 {
            let [columns, rows] = [1 + draws.below(40) as u16, 1 + draws.below(9) as u16];
            let mut cells = [0_u32; 2 * 9];
            let words = Chart::words_in(columns) * usize::from(rows);
            // Few closed cells, so that some hulls are held.
            for word in &mut cells {
                let closed = 1 << draws.below(32);
                *word = if draws.below(3) > 0 { u32::MAX } else { !closed };
            }
            let corner = at(draws.below(9_000) as i32 - 4_000, draws.below(9_000) as i32 - 4_000);
            let chart = Chart::new(corner, SIDE, [columns, rows], &cells[..words]).unwrap();
            let [width, height] = [columns, rows].map(|it| u32::from(it) * SIDE);
            let mut place = || {
                let [x, z] = [width, height].map(|it| draws.below(it + 400) as i32 - 200);
                at(corner.x() + x, corner.z() + z)
            };
            let hull = [place(), place(), place()];
            let hull = &hull[..=case % 3];
            for by in [0, 1, 300, 1_700] {
                let closed = (-3..i32::from(columns) + 3)
                    .flat_map(|x| (-3..i32::from(rows) + 3).map(move |z| [x, z]))
                    .filter(|cell| {
                        let cell = cell.map(|it| u16::try_from(it).unwrap_or(u16::MAX));
                        !chart.is_open(cell)
                    });
                let apart = |less: i32, by: u32| {
                    closed.clone().all(|cell| are_apart(&square(&chart, cell, less), hull, by))
                };
                if let [a, b] = *hull {
                    // As hulls of more corners are judged.
                    assert_eq!(chart.holds(hull, by), chart.holds(&[a, b, b], by), "{hull:?}");
                }
                if chart.holds(hull, by) {
                    held += 1;
                    // Coordinates along the hull are rounded, and a cell may be touched.
                    assert!(apart(2, by.saturating_sub(2)), "case {case}: {hull:?} {by}");
                } else {
                    refused += 1;
                    assert!(!apart(0, by * 3 / 2 + 2), "case {case}: {hull:?} {by}");
                }
            }
        }
        assert!(held > 1_000 && refused > 1_000, "{held}, {refused}");
    }

    #[test]
    fn from_land_the_way_home_leads_to_water() {
        // Two columns of land, two of water.
        let cells = [0b1100_u32; 4];
        let chart = Chart::new(Site::ORIGIN, SIDE, [4, 4], &cells).unwrap();
        for (x, z) in [(100, 1_500), (1_900, 3_900), (-2_500, 700), (700, -3_000)] {
            let home = at(x, z).step(chart.way_home(at(x, z), 0).unwrap()).unwrap();
            assert!(chart.is_open(chart.cell_of(home).unwrap()));
        }
        assert_eq!(chart.way_home(at(2_500, 1_500), 0), None);
        assert_eq!(chart.way_home(at(40_000, 1_500), 0), None);
    }

    #[test]
    fn from_beside_the_shore_the_way_home_leads_off_it_without_a_landfall() {
        // Water about a spit: row 2 is land from column 2 on.
        let cells = [0xff_u32, 0xff, 0b11, 0xff, 0xff, 0xff];
        let chart = Chart::new(Site::ORIGIN, SIDE, [8, 6], &cells).unwrap();
        for x in (1_100..7_000).step_by(300) {
            for z in [1_990, 3_010] {
                let from = at(x, z);
                let home = chart.way_home(from, 300).map(|way| from.step(way).unwrap());
                match home {
                    Some(home) => {
                        assert!(chart.holds(&[home], 300) && chart.holds(&[from, home], 0));
                    }
                    None => assert!(chart.holds(&[from], 300), "{from:?}"),
                }
            }
        }
        assert_ne!(chart.way_home(at(5_500, 1_990), 300), None);
        assert_eq!(chart.way_home(at(5_500, 1_690), 300), None);
    }

    #[test]
    fn from_ashore_a_motion_leads_out_over_its_own_cell_alone() {
        // A spit as above: row 2 is land from column 2 on; below, rows 3 to 5 are land.
        let cells = [0xff_u32, 0xff, 0b11, 0, 0, 0];
        let chart = Chart::new(Site::ORIGIN, SIDE, [8, 6], &cells).unwrap();
        let leads_out = |from: [i32; 2], to: [i32; 2]| {
            let [from, to] = [from, to].map(|[x, z]| at(x, z));
            chart.lets_out(&[from, to])
        };
        // From the shore straight into the water, and not along the shore first.
        assert!(
            leads_out([5_500, 2_100], [5_500, 1_500]) && leads_out([5_500, 2_100], [5_600, 2_200])
        );
        assert!(
            !leads_out([5_500, 2_100], [6_500, 2_100])
                && !leads_out([5_500, 2_100], [7_500, 1_900])
        );
        // From the water never ashore, and from inland anywhere.
        assert!(!leads_out([5_500, 1_900], [5_500, 2_100]));
        assert!(
            leads_out([5_500, 4_500], [5_500, 3_500]) && leads_out([5_500, 9_500], [5_500, 5_500])
        );
    }

    #[test]
    fn what_is_no_chart_is_refused() {
        let cells = [0; 9];
        let new =
            |corner, side, size, words: usize| Chart::new(corner, side, size, &cells[..words]);
        let origin = Site::ORIGIN;
        assert_eq!(new(origin, SIDE, [0, 3], 0), Err(ChartError::Size));
        assert_eq!(new(origin, SIDE, [257, 1], 9), Err(ChartError::Size));
        assert_eq!(new(origin, SIDE, [33, 4], 4), Err(ChartError::Words(8)));
        assert_eq!(new(origin, 0, [3, 3], 3), Err(ChartError::Beyond));
        assert_eq!(new(at(LIMIT - 2_000, 0), SIDE, [3, 3], 3), Err(ChartError::Beyond));
        assert!(new(at(-LIMIT + 1, 1 - LIMIT), 4_194_303, [256, 1], 8).is_ok());
    }
}
