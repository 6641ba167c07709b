//! Where motions may go: a convex area without its keep-outs.

use crate::geometry::area::Area;
use crate::geometry::chart::Chart;
use crate::geometry::hull::{Extent, are_apart_beside};
use crate::geometry::lattice::{LIMIT, Site, UNITS_PER_METRE, Vector};
use crate::geometry::value::ValueError;

/// Where motions may go: a convex area without convex keep-outs, which no motion touches.
///
/// [`Area`], a rectangle without keep-outs, has no cost for polygons and keep-outs.
/// [`PolygonArea`](crate::geometry::polygon_area::PolygonArea) is a convex polygon with keep-outs.
pub trait Workspace: Copy {
    /// The smallest rectangle around it.
    fn bounds(&self) -> Area;

    /// Fraction of the bounding rectangle that the area covers, at most 1. Keep-outs count as part of the area. An
    /// [inset](Self::inset) part returns the same value as the whole.
    fn share_of_bounds(&self) -> f32 {
        1.0
    }

    /// The displacement from a position outside the area, or in a keep-out, towards the inside. It may be longer than
    /// one motion, and the next keep-out may be on the way.
    fn way_home(&self, from: Site) -> Vector {
        self.bounds().middle() - from
    }

    /// The same area with a clearance: motions stay at least so many metres away from its border and its keep-outs. By
    /// default the clearance is the tolerance of the planner's belief. A smaller clearance has no effect.
    ///
    /// # Errors
    /// [`ValueError`] if the clearance is negative or no number, or nothing of the area is left.
    fn with_clearance(&self, metres: f64) -> Result<Self, ValueError> {
        const NONE: ValueError =
            ValueError("a clearance is 0 or more, and leaves some of the area");
        let units = libm::ceil(metres * f64::from(UNITS_PER_METRE));
        let is_length = (0.0..f64::from(LIMIT)).contains(&units);
        let part = if is_length { self.whole().inset(units as u32) } else { None };
        part.ok_or(NONE)
    }

    /// The part that is further than so many lattice units from the border and from all keep-outs: where to aim if
    /// motions end that far off. `None` if the border leaves no such part; keep-outs are not considered.
    #[must_use]
    fn inset(&self, margin: u32) -> Option<Self>;

    /// The whole area of which this is an [inset](Self::inset) part.
    #[must_use]
    fn whole(&self) -> Self;

    /// The sides of the border that are not sides of the [bounding rectangle](Self::bounds).
    fn sides(&self) -> impl Iterator<Item = HalfPlane> {
        core::iter::empty()
    }

    /// What no motion touches.
    fn keep_outs(&self) -> impl Iterator<Item = Obstacle<'_>> {
        core::iter::empty()
    }

    /// The cells that motions stay on, if not all ground inside the border is open.
    fn chart(&self) -> Option<Chart<'_>> {
        None
    }

    /// Whether motions may go everywhere inside the border.
    fn is_open(&self) -> bool {
        self.keep_outs().next().is_none() && self.chart().is_none()
    }

    /// Whether a position lies inside the area's border or on it, be it in a keep-out or not.
    fn encloses(&self, q: Site) -> bool {
        self.bounds().contains(q) && self.sides().all(|side| side.at(q) >= 0)
    }

    /// Whether all of a hull is further than `by` lattice units from all keep-outs and closed cells, and their margins.
    fn is_clear(&self, hull: &[Site], by: u32) -> bool {
        let extent = Extent::of(hull);
        let margin = self.bounds().margin();
        self.keep_outs().all(|it| !it.is_near(extent, by) || it.is_apart_beside(hull, by))
            && self.chart().is_none_or(|it| it.holds(hull, margin.saturating_add(by)))
    }

    /// How far inside the border a position lies, in lattice units or somewhat less; negative outside.
    fn depth(&self, q: Site) -> i32 {
        let (min, max) = (self.bounds().min(), self.bounds().max());
        let bounds = [q.x() - min.x(), q.z() - min.z(), max.x() - q.x(), max.z() - q.z()];
        let side = |it: HalfPlane| it.at(q).checked_div(it.length.into()).unwrap_or(0) as i32;
        bounds.into_iter().chain(self.sides().map(side)).min().unwrap_or(0)
    }

    /// Whether a motion from one position may come to another, as far as the border is concerned.
    ///
    /// The margin of an [inset](Self::inset) area is for errors alone: no motion leads into it from inside. If an error
    /// has brought the agent into the margin, motions may use it but not leave the area. From outside, motions may go
    /// anywhere. Each side of the border is judged by itself.
    fn confines(&self, from: Site, to: Site) -> bool {
        if self.encloses(to) {
            return true;
        }
        let bounds = self.bounds();
        let inside = |q: Site| {
            let (min, max) = (bounds.min(), bounds.max());
            [q.x() - min.x(), q.z() - min.z(), max.x() - q.x(), max.z() - q.z()]
        };
        let margin = i64::from(bounds.margin());
        let by_bounds = |(from, to): (i32, i32)| may_go(from.into(), to.into(), margin);
        inside(from).into_iter().zip(inside(to)).all(by_bounds)
            && self.sides().all(|it| may_go(it.at(from), it.at(to), margin * i64::from(it.length)))
    }

    /// Whether the agent may be at a position.
    fn contains(&self, q: Site) -> bool {
        self.encloses(q) && self.is_clear(&[q], 0)
    }

    /// Whether all of a disc is where the agent may be; the radius in lattice units, below 2^30.
    fn contains_disc(&self, centre: Site, radius: i32) -> bool {
        self.bounds().contains_disc(centre, radius)
            && self.sides().all(|side| side.at(centre) >= side.offset_of(radius))
            && self.is_clear(&[centre], radius.unsigned_abs())
    }

    /// Whether a motion stays clear of all keep-outs and closed cells. `swept` are the corners of the hull that the motion sweeps. The
    /// hull may not come nearer to a keep-out than its margin.
    ///
    /// If an error has brought the agent too near to a keep-out, a motion from there need only stay out of the keep-out
    /// itself. So it is with closed cells, and of these the agent may cross the one that it stands on.
    fn lets_pass(&self, swept: &[Site]) -> bool {
        let extent = Extent::of(swept);
        let margin = self.bounds().margin();
        self.keep_outs().all(|it| !it.is_near(extent, 0) || it.lets_pass(swept))
            && self.chart().is_none_or(|it| {
                let start = swept.get(..1).unwrap_or_default();
                it.holds(swept, margin) || !it.holds(start, margin) && it.lets_out(swept)
            })
    }
}

/// Whether a motion may change the agent's depth inside a side from `from` to `to`. The border lies `margin` outside of
/// that side.
const fn may_go(from: i64, to: i64, margin: i64) -> bool {
    to >= 0 || from < 0 && (to >= -margin || from < -margin)
}

impl Workspace for Area {
    fn bounds(&self) -> Area {
        *self
    }

    fn inset(&self, margin: u32) -> Option<Self> {
        Self::inset(self, margin)
    }

    fn whole(&self) -> Self {
        Self::whole(self)
    }
}

/// Positions to the left of a line, and some way off it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HalfPlane {
    /// On the line.
    pub from: Site,
    /// Its direction, with the inside to the left.
    pub along: Vector,
    /// The length of `along`, rounded up.
    pub length: u32,
    /// What [`at`](Self::at) would be at the origin, negative.
    offset: i64,
}

impl HalfPlane {
    /// To the left of the line from one position to another, at least so many lattice units away from it.
    pub fn between(from: Site, to: Site, margin: u32) -> Self {
        let along = to - from;
        let square = along.dot(along).unsigned_abs();
        let root = square.isqrt();
        let length = (root + u64::from(root * root < square)) as u32;
        let offset = along.cross(from - Site::ORIGIN) + i64::from(margin) * i64::from(length);
        Self { from, along, length, offset }
    }

    /// How far inside a position lies, lattice units squared: the length of the direction times the distance from the
    /// line less the margin. Negative outside.
    pub fn at(&self, q: Site) -> i64 {
        self.along.cross(q - Site::ORIGIN) - self.offset
    }

    /// The increase of [`at`](Self::at) for a distance further in, or somewhat more. The distance is in lattice units,
    /// below 2^30.
    pub fn offset_of(&self, distance: i32) -> i64 {
        i64::from(distance) * i64::from(self.length)
    }
}

/// Ground that no motion touches: all within a distance of a convex hull. A disc is all within its radius of a point.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle<'a> {
    /// The hull's corners.
    pub corners: &'a [Site],
    /// The box around them.
    pub(crate) extent: Extent,
    /// The distance, lattice units.
    pub radius: u32,
    /// How far motions stay from it besides, lattice units.
    pub margin: u32,
}

impl<'a> Obstacle<'a> {
    /// All within a radius of a hull, from which motions stay a margin away.
    pub fn new(corners: &'a [Site], radius: u32, margin: u32) -> Self {
        Self { corners, extent: Extent::of(corners), radius, margin }
    }

    /// Whether the box around it comes as near to another box as its margin and `by` together. Cheap.
    pub(crate) fn is_near(&self, extent: Extent, by: u32) -> bool {
        !self.extent.is_apart_from(extent, self.away(by))
    }

    /// Whether a hull is further from it than its margin and `by` together, lattice units.
    pub fn is_clear_of(&self, hull: &[Site], by: u32) -> bool {
        self.is_apart_from(hull, self.away(by))
    }

    /// The same of a hull whose box is near.
    fn is_apart_beside(&self, hull: &[Site], by: u32) -> bool {
        are_apart_beside(self.corners, hull, self.away(by))
    }

    fn away(&self, by: u32) -> u32 {
        self.radius.saturating_add(self.margin).saturating_add(by)
    }

    fn is_apart_from(&self, hull: &[Site], by: u32) -> bool {
        self.extent.is_apart_from(Extent::of(hull), by) || are_apart_beside(self.corners, hull, by)
    }

    fn lets_pass(&self, swept: &[Site]) -> bool {
        let start = swept.get(..1).unwrap_or_default();
        if self.is_apart_beside(swept, 0) {
            return true;
        }
        let begins = |apart: u32| self.is_apart_from(start, apart);
        let is_near = !begins(self.radius.saturating_add(self.margin));
        is_near && (!begins(self.radius) || self.is_apart_from(swept, self.radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_from_the_margin_does_not_leave_the_area() {
        let whole = Area::metres([0.0, 0.0], [10.0, 10.0]).unwrap();
        let area = Workspace::with_clearance(&whole, 1.0).unwrap();
        let [inside, margin, outside] = [2.0, 0.5, -0.5].map(|x| Site::metres([x, 5.0]).unwrap());
        assert!(area.confines(inside, inside) && !area.confines(inside, margin));
        assert!(area.confines(margin, margin) && !area.confines(margin, outside));
        assert!(area.confines(outside, outside) && area.confines(outside, margin));
    }
}
