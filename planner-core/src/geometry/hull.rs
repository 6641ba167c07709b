//! Small convex hulls, and whether two of them keep apart: exact.
//!
//! A hull is given by its corners in order. One corner is a point, such as the middle of a disc. Two corners are a
//! segment, such as a wall or the path of a straight motion.

use nalgebra::Point2;

use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, Vector, orient};

/// The corners of a convex hull, counter-clockwise, `C` at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Hull<const C: usize> {
    corners: [Site; C],
    count: u8,
    extent: Extent,
}

/// These corners are not those of a convex polygon, or too many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum HullError {
    /// There are none.
    Empty,
    /// There are more corners than this, for which the hull has room.
    TooMany(usize),
    /// Polygons have their corners in order around them, each of them turning to the same side.
    NotConvex,
    /// A corner lies 8,192 m from the origin or more, or is no number.
    Beyond,
    /// The radius is negative, 8,192 m or more, or no number.
    Radius,
}

impl core::fmt::Display for HullError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Empty => f.write_str("no corners"),
            Self::TooMany(most) => write!(f, "more than {most} corners"),
            Self::Beyond => f.write_str("coordinates must be finite and smaller than 8192 m in size"),
            Self::Radius => f.write_str("a radius is from 0 to below 8192 m"),
            Self::NotConvex => f.write_str(
                "not convex: corners go round in order, all turn the same way, no three are in line",
            ),
        }
    }
}

impl core::error::Error for HullError {}

impl<const C: usize> Hull<C> {
    /// The hull with these corners, in either order around it.
    ///
    /// # Errors
    /// [`HullError`] says what is wrong with them.
    pub fn new(corners: &[Site]) -> Result<Self, HullError> {
        let mut all = [Site::ORIGIN; C];
        let room = all.get_mut(..corners.len()).ok_or(HullError::TooMany(C))?;
        room.copy_from_slice(corners);
        let count = u8::try_from(corners.len()).map_err(|_| HullError::TooMany(u8::MAX.into()))?;
        match *corners {
            [] => return Err(HullError::Empty),
            [_] => {}
            [a, b] if a != b => {}
            [a, b, c, ..] if goes_round(corners, orient(a, b, c).signum()) => {
                if orient(a, b, c) < 0 {
                    room.reverse();
                }
            }
            _ => return Err(HullError::NotConvex),
        }
        Ok(Self { corners: all, count, extent: Extent::of(corners) })
    }

    /// The hull with these corners, `[x, z]` in metres or points of `nalgebra`, in either order around it.
    ///
    /// # Errors
    /// [`HullError`] says what is wrong with them.
    pub fn metres<P: Copy + Into<Point2<f64>>>(corners: &[P]) -> Result<Self, HullError> {
        let mut sites = [Site::ORIGIN; C];
        let room = sites.get_mut(..corners.len()).ok_or(HullError::TooMany(C))?;
        for (site, &corner) in room.iter_mut().zip(corners) {
            *site = Site::metres(corner).map_err(|_| HullError::Beyond)?;
        }
        Self::new(room)
    }

    /// The hull of a rectangle.
    pub fn of(area: Area) -> Self {
        const { assert!(C >= 4, "a rectangle has four corners") };
        let (min, max) = (area.min(), area.max());
        let aside = [(max.x(), min.z()), (min.x(), max.z())];
        let [right, left] = aside.map(|(x, z)| Site::new(x, z).unwrap_or(min));
        let mut corners = [Site::ORIGIN; C];
        for (place, corner) in corners.iter_mut().zip([min, right, max, left]) {
            *place = corner;
        }
        Self { corners, count: 4, extent: Extent::of(&[min, max]) }
    }

    /// Its corners.
    pub fn corners(&self) -> &[Site] {
        self.corners.get(..usize::from(self.count)).unwrap_or_default()
    }

    /// The box around it.
    pub(crate) const fn extent(&self) -> Extent {
        self.extent
    }
}

/// Whether all other corners lie strictly on one side of each edge.
fn goes_round(corners: &[Site], side: i64) -> bool {
    side != 0
        && edges(corners).all(|(a, b)| {
            let others = corners.iter().filter(|c| **c != a && **c != b);
            others.clone().count() + 2 == corners.len()
                && others.into_iter().all(|c| orient(a, b, *c).signum() == side)
        })
}

/// A hull's edges in order. Those of a point and a segment run to and fro.
pub(crate) fn edges(corners: &[Site]) -> impl Iterator<Item = (Site, Site)> + Clone {
    let next = corners.iter().skip(1).chain(corners.first());
    corners.iter().copied().zip(next.copied())
}

/// Whether all of one hull is further than `by` lattice units from all of another. Corners go round in either order.
///
/// Cost: if their boxes are further apart, a comparison for each corner. If an edge of one separates them, a cross product
/// for each corner of one and edge of the other. Otherwise, near corners, several of these.
pub fn are_apart(a: &[Site], b: &[Site], by: u32) -> bool {
    Extent::of(a).is_apart_from(Extent::of(b), by) || are_apart_beside(a, b, by)
}

/// The same of hulls whose boxes are not so far apart.
pub(crate) fn are_apart_beside(a: &[Site], b: &[Site], by: u32) -> bool {
    let has_inside = |hull: &[Site]| matches!(*hull, [a, b, c, ..] if orient(a, b, c) != 0);
    match gap(a, b, by).max(gap(b, a, by)) {
        Gap::Wide => true,
        // Where a hull has an inside, an edge of one lies between any two that do not meet.
        Gap::None if has_inside(a) || has_inside(b) => false,
        Gap::None => !meet(a, b) && have_corners_apart(a, b, by),
        Gap::Some => have_corners_apart(a, b, by),
    }
}

/// The box around a hull, by its least and its greatest coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "[i32; 4]", into = "[i32; 4]"))]
pub(crate) struct Extent {
    low: Vector,
    high: Vector,
}

impl From<[i32; 4]> for Extent {
    fn from([x, z, right, top]: [i32; 4]) -> Self {
        Self { low: Vector { x, z }, high: Vector { x: right, z: top } }
    }
}

impl From<Extent> for [i32; 4] {
    fn from(Extent { low, high }: Extent) -> Self {
        [low.x, low.z, high.x, high.z]
    }
}

impl Extent {
    /// Of nothing.
    pub(crate) const NONE: Self = Self {
        low: Vector { x: i32::MAX, z: i32::MAX },
        high: Vector { x: i32::MIN, z: i32::MIN },
    };

    pub(crate) fn of(hull: &[Site]) -> Self {
        hull.iter().fold(Self::NONE, |all, it| all.with(*it))
    }

    /// The same with a site.
    pub(crate) fn with(self, site: Site) -> Self {
        let Self { low, high } = self;
        Self {
            low: Vector { x: low.x.min(site.x()), z: low.z.min(site.z()) },
            high: Vector { x: high.x.max(site.x()), z: high.z.max(site.z()) },
        }
    }

    /// The same and so much ground about it.
    pub(crate) fn grown(self, by: i32) -> Self {
        let Self { low, high } = self;
        let [x, z] = [low.x.saturating_sub(by), low.z.saturating_sub(by)];
        let high = Vector { x: high.x.saturating_add(by), z: high.z.saturating_add(by) };
        Self { low: Vector { x, z }, high }
    }

    /// How high it is, lattice units; 0 of nothing.
    pub(crate) fn height(self) -> u32 {
        self.high.z.checked_sub(self.low.z).and_then(|it| it.try_into().ok()).unwrap_or(0)
    }

    /// Whether it holds a site.
    pub(crate) fn holds(self, site: Site) -> bool {
        (self.low.x..=self.high.x).contains(&site.x())
            && (self.low.z..=self.high.z).contains(&site.z())
    }

    /// Whether a box is further away than this: then the hull in it is.
    pub(crate) fn is_apart_from(self, other: Self, by: u32) -> bool {
        // No two positions are as far apart as the least of these: no sum overflows.
        let by = by.min(1 << 30) as i32;
        let gap = |low: i32, high: i32| low > high + by;
        gap(self.low.x, other.high.x)
            || gap(other.low.x, self.high.x)
            || gap(self.low.z, other.high.z)
            || gap(other.low.z, self.high.z)
    }
}

/// What lies between a hull and another, as far as the edges of one tell.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Gap {
    /// No edge has all of the other hull beyond its line.
    None,
    /// One has.
    Some,
    /// One has all of the other hull further beyond its line than was asked.
    Wide,
}

fn gap(hull: &[Site], other: &[Site], by: u32) -> Gap {
    let square = |a: u64| u128::from(a) * u128::from(a);
    // On which side of its edges a hull lies: on none, if it is a segment or a point.
    let side = if let [a, b, c, ..] = *hull { orient(a, b, c).signum() } else { 0 };
    let mut found = Gap::None;
    for (from, to) in edges(hull) {
        let along = to - from;
        let (low, high) = other.iter().fold((i64::MAX, i64::MIN), |(low, high), q| {
            let off = along.cross(*q - from);
            (low.min(off), high.max(off))
        });
        let nearest = match side {
            1 => high.saturating_neg(),
            -1 => low,
            _ => low.max(high.saturating_neg()),
        };
        if nearest > 0 {
            let length = along.dot(along).unsigned_abs();
            if square(nearest.unsigned_abs()) > square(by.into()) * u128::from(length) {
                return Gap::Wide;
            }
            found = Gap::Some;
        }
    }
    found
}

/// The same, computed from all pairs of a corner of one and an edge of the other: the nearest points of hulls that do
/// not meet are such a corner, and a point of such an edge. Exact in all cases.
fn have_corners_apart(a: &[Site], b: &[Site], by: u32) -> bool {
    a.iter().all(|corner| edges(b).all(|edge| is_further(*corner, edge, by)))
        && b.iter().all(|corner| edges(a).all(|edge| is_further(*corner, edge, by)))
}

/// Whether edges cross, or one hull lies inside the other. A corner on an edge is left to the distances.
fn meet(a: &[Site], b: &[Site]) -> bool {
    let apart = |(p, q), r, s| orient(p, q, r).signum() * orient(p, q, s).signum() < 0;
    edges(a).any(|(p, q)| edges(b).any(|(r, s)| apart((p, q), r, s) && apart((r, s), p, q)))
        || a.first().is_some_and(|first| encloses(b, *first))
        || b.first().is_some_and(|first| encloses(a, *first))
}

/// Whether a position lies strictly inside a hull.
fn encloses(corners: &[Site], q: Site) -> bool {
    [1, -1].iter().any(|side| edges(corners).all(|(a, b)| orient(a, b, q).signum() == *side))
}

/// Whether a position is further than `by` from a segment. Differences are below 2^30, so that squares of their
/// products are below 2^124.
fn is_further(q: Site, (from, to): (Site, Site), by: u32) -> bool {
    let (along, way) = (to - from, q - from);
    let (length, reach) = (along.dot(along), along.dot(way));
    let by = u128::from(by) * u128::from(by);
    let square = |a: i64| u128::from(a.unsigned_abs()) * u128::from(a.unsigned_abs());
    if reach <= 0 || length == 0 {
        u128::from(way.dot(way).unsigned_abs()) > by
    } else if reach >= length {
        let rest = q - to;
        u128::from(rest.dot(rest).unsigned_abs()) > by
    } else {
        square(along.cross(way)) > by * u128::from(length.unsigned_abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(half: i32) -> [Site; 4] {
        [(-half, -half), (half, -half), (half, half), (-half, half)]
            .map(|(x, z)| Site::new(x, z).unwrap())
    }

    #[test]
    fn a_hull_inside_another_is_not_apart_from_it() {
        let (inner, outer) = (square(10), square(1_000));
        assert!(!are_apart(&inner, &outer, 0) && !are_apart(&outer, &inner, 0));
        assert!(!are_apart(&outer, &[Site::ORIGIN], 0));
    }
}
