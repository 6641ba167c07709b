//! Where motions may go: a convex polygon or a rectangle, but for keep-outs.

#[cfg(feature = "polygons")]
use planner_core::{Hull, Site, error::PolygonAreaError};

use crate::types::Point;
#[cfg(feature = "polygons")]
use crate::{status::Status, verdict::Refusal};

/// Corners that an area can have, and each keep-out in it.
pub const CORNERS: usize = 8;

/// Keep-outs that an area can have.
pub const KEEP_OUTS: usize = 8;

/// An area as planners have it.
#[cfg(feature = "polygons")]
pub(crate) type Ground = planner_core::PolygonArea<CORNERS, KEEP_OUTS>;
#[cfg(not(feature = "polygons"))]
pub(crate) type Ground = planner_core::Area;

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

#[cfg(feature = "polygons")]
impl Area {
    /// Its polygon.
    pub(crate) fn polygon(&self) -> Result<Hull<CORNERS>, Refusal> {
        let refusal = Refusal::of(Status::Area, c"area");
        let hull = hull(&self.corners, self.corner_count).ok_or(refusal)?;
        // A point and a wall are hulls too, but no areas.
        Ground::new(hull, &[]).map(|_| hull).map_err(|_| refusal)
    }

    /// A polygon with these keep-outs in it.
    pub(crate) fn with_keep_outs(&self, polygon: Hull<CORNERS>) -> Result<Ground, Refusal> {
        let refusal = Refusal::of(Status::KeepOut, c"keep_outs");
        let keep_outs = self.keep_outs.get(..usize::from(self.keep_out_count)).ok_or(refusal)?;
        let mut read = [planner_core::KeepOut { hull: polygon, radius: 0 }; KEEP_OUTS];
        for (number, (place, keep_out)) in read.iter_mut().zip(keep_outs).enumerate() {
            *place = keep_out.read().ok_or(refusal.about(number))?;
        }
        let read = read.get(..keep_outs.len()).unwrap_or(&read);
        Ground::new(polygon, read).map_err(|why| match why {
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
