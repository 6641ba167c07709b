//! Where motions may go: a convex polygon or a rectangle, but for keep-outs and the closed cells of a chart.

#[cfg(feature = "charts")]
use planner_core::lattice::UNITS_PER_METRE;
#[cfg(feature = "polygons")]
use planner_core::{Hull, Site, error::PolygonAreaError};

use crate::types::Point;
#[cfg(feature = "polygons")]
use crate::{status::Status, verdict::Refusal};

/// Corners that an area can have, and each keep-out in it.
pub const CORNERS: usize = 8;

/// Keep-outs that an area can have.
pub const KEEP_OUTS: usize = 8;

/// Rows and columns that a chart can have.
pub const CHART_CELLS: u16 = 256;
const _: () = assert!(CHART_CELLS == planner_core::Chart::MOST_CELLS);

/// An area as planners have it.
#[cfg(feature = "charts")]
pub(crate) type Ground = planner_core::Charted<'static, Outlines>;
#[cfg(not(feature = "charts"))]
pub(crate) type Ground = Outlines;

/// An area by its corners.
#[cfg(feature = "polygons")]
pub(crate) type Outlines = planner_core::PolygonArea<CORNERS, KEEP_OUTS>;
#[cfg(not(feature = "polygons"))]
pub(crate) type Outlines = planner_core::Area;

/// What no motion touches: all places within a radius of a point, of a straight wall or of a convex polygon.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct KeepOut {
    /// Its corners in order, either way round. One is a disc's middle, two are the ends of a wall.
    pub corners: [Point; CORNERS],
    /// How far it reaches beyond them, metres.
    pub radius: f64,
    /// How many corners it has, from 1 to `PLANNER_CORNERS`.
    pub corner_count: u8,
}

/// Where motions may go: a convex polygon, but for keep-outs.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Area {
    /// The polygon's corners in order, either way round.
    pub corners: [Point; CORNERS],
    /// What no motion touches.
    pub keep_outs: [KeepOut; KEEP_OUTS],
    /// How many corners the polygon has, from 3 to `PLANNER_CORNERS`. Then the mission's rectangle is all zeros. Or 0
    /// for the mission's rectangle in place of a polygon.
    pub corner_count: u8,
    /// How many keep-outs there are, up to `PLANNER_KEEP_OUTS`.
    pub keep_out_count: u8,
}

/// Square cells, of which each is open or closed. Motions stay on open cells, and all ground outside of them is closed.
///
/// The words are not copied. A planner reads them with each call, so they stay where they are, and as they are, for as long
/// as it is used. They may be in flash.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Chart {
    /// `PLANNER_CHART_WORDS(columns, rows)` words: row by row, that of the least z first. A row begins with a word of its
    /// own. Bit `k` of its word `w` is column `32 w + k`, counted from the least x. 1 is open.
    pub cells: *const u32,
    /// The corner with the least x and z, metres.
    pub corner: Point,
    /// The side of a cell, metres; it is rounded to a multiple of 2^-16 m.
    pub side: f64,
    /// Columns, from 1 to `PLANNER_CHART_CELLS`.
    pub columns: u16,
    /// Rows, from 1 to `PLANNER_CHART_CELLS`.
    pub rows: u16,
}

#[cfg(feature = "charts")]
impl Chart {
    /// As planners have it.
    ///
    /// # Safety
    /// If its size is possible, `cells` must be null or readable for as long as a planner has it.
    pub(crate) unsafe fn read(&self) -> Result<planner_core::Chart<'static>, Refusal> {
        let refused = |status| Refusal::of(status, c"chart");
        let corner = self.corner.read().map_err(refused)?;
        let is_possible = |count: u16| (1..=CHART_CELLS).contains(&count);
        if !is_possible(self.columns) || !is_possible(self.rows) {
            return Err(refused(Status::Chart));
        }
        if self.cells.is_null() || !self.cells.is_aligned() {
            return Err(refused(Status::Memory));
        }
        let words = planner_core::Chart::words_in(self.columns) * usize::from(self.rows);
        // SAFETY: the caller promises it.
        let cells = unsafe { core::slice::from_raw_parts(self.cells, words) };
        // What is no number becomes 0, which is no side.
        let side = (self.side * f64::from(UNITS_PER_METRE) + 0.5) as u32;
        let chart = planner_core::Chart::new(corner, side, [self.columns, self.rows], cells);
        chart.map_err(|_| refused(Status::Chart))
    }
}

#[cfg(feature = "polygons")]
impl Area {
    /// Its polygon.
    pub(crate) fn polygon(&self) -> Result<Hull<CORNERS>, Refusal> {
        let refusal = Refusal::of(Status::Area, c"area");
        let hull = hull(&self.corners, self.corner_count).ok_or(refusal)?;
        // A point and a wall are hulls too, but no areas.
        Outlines::new(hull, &[]).map(|_| hull).map_err(|_| refusal)
    }

    /// A polygon with these keep-outs in it.
    pub(crate) fn with_keep_outs(&self, polygon: Hull<CORNERS>) -> Result<Outlines, Refusal> {
        let refusal = Refusal::of(Status::KeepOut, c"keep_outs");
        let keep_outs = self.keep_outs.get(..usize::from(self.keep_out_count)).ok_or(refusal)?;
        let mut read = [planner_core::KeepOut { hull: polygon, radius: 0 }; KEEP_OUTS];
        for (number, (place, keep_out)) in read.iter_mut().zip(keep_outs).enumerate() {
            *place = keep_out.read().ok_or(refusal.about(number))?;
        }
        let read = read.get(..keep_outs.len()).unwrap_or(&read);
        Outlines::new(polygon, read).map_err(|why| match why {
            PolygonAreaError::KeepOut(number) => refusal.about(number),
            _ => refusal,
        })
    }
}

#[cfg(feature = "polygons")]
impl KeepOut {
    fn read(&self) -> Option<planner_core::KeepOut<CORNERS>> {
        planner_core::KeepOut::new(hull(&self.corners, self.corner_count)?, self.radius).ok()
    }
}

#[cfg(feature = "polygons")]
fn hull(corners: &[Point; CORNERS], count: u8) -> Option<Hull<CORNERS>> {
    let corners = corners.get(..usize::from(count))?;
    let mut sites = [Site::ORIGIN; CORNERS];
    for (site, corner) in sites.iter_mut().zip(corners) {
        *site = corner.read().ok()?;
    }
    Hull::new(sites.get(..corners.len())?).ok()
}
