//! A convex polygon with keep-outs.

use heapless::Vec;
use nalgebra::Point2;

use crate::geometry::area::Area;
use crate::geometry::hull::{Hull, HullError, edges};
use crate::geometry::lattice::{LIMIT, Site, UNITS_PER_METRE, Vector};
use crate::geometry::workspace::{HalfPlane, Obstacle, Workspace};

/// A convex polygon without its keep-outs. There are at most `K` keep-outs. The polygon and each keep-out have at most
/// `C` corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PolygonArea<const C: usize, const K: usize> {
    polygon: Hull<C>,
    bounds: Area,
    /// The sides that are not sides of the bounds: so many, at the margin of these.
    sides: [HalfPlane; C],
    count: u8,
    keep_outs: [Option<KeepOut<C>>; K],
}

/// Ground that no motion touches: all places within a distance of a convex hull. A hull of one point makes a disc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct KeepOut<const C: usize> {
    /// The hull.
    pub hull: Hull<C>,
    /// The distance, lattice units; below 2^29 (8,192 m).
    pub radius: u32,
}

impl<const C: usize> KeepOut<C> {
    /// All within so many metres of a hull.
    ///
    /// # Errors
    /// [`HullError::Radius`].
    pub fn new(hull: Hull<C>, metres: f64) -> Result<Self, HullError> {
        let units = libm::ceil(metres * f64::from(UNITS_PER_METRE));
        let is_radius = (0.0..f64::from(LIMIT)).contains(&units);
        let radius = is_radius.then_some(units as u32).ok_or(HullError::Radius)?;
        Ok(Self { hull, radius })
    }

    /// A disc: all within so many metres of a place.
    ///
    /// # Errors
    /// [`HullError::Beyond`], [`HullError::Radius`].
    pub fn disc(centre: impl Into<Point2<f64>>, metres: f64) -> Result<Self, HullError> {
        Self::new(Hull::metres(&[centre.into()])?, metres)
    }

    /// A convex polygon with these corners, `[x, z]` in metres or points of `nalgebra`. Two make a wall.
    ///
    /// # Errors
    /// [`HullError`].
    pub fn polygon<P: Copy + Into<Point2<f64>>>(corners: &[P]) -> Result<Self, HullError> {
        Ok(Self { hull: Hull::metres(corners)?, radius: 0 })
    }
}

/// Why a polygon and its keep-outs make no area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PolygonAreaError {
    /// The area is no polygon.
    Area(HullError),
    /// There are more keep-outs than this, for which the area has room.
    TooManyKeepOuts(usize),
    /// The radius of this keep-out is 8,192 m or more. The first keep-out is number 0.
    KeepOut(usize),
}

impl core::fmt::Display for PolygonAreaError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Area(why) => why.fmt(f),
            Self::TooManyKeepOuts(most) => write!(f, "more than {most} keep-outs"),
            Self::KeepOut(number) => write!(f, "keep-out {number} is larger than the lattice"),
        }
    }
}

impl core::error::Error for PolygonAreaError {}

impl From<HullError> for PolygonAreaError {
    fn from(why: HullError) -> Self {
        Self::Area(why)
    }
}

impl<const C: usize, const K: usize> PolygonArea<C, K> {
    /// The area of a polygon without its keep-outs.
    ///
    /// # Errors
    /// [`PolygonAreaError`] says what is wrong with them.
    pub fn new(polygon: Hull<C>, keep_outs: &[KeepOut<C>]) -> Result<Self, PolygonAreaError> {
        let bounds =
            bounds_of(polygon.corners()).ok_or(PolygonAreaError::Area(HullError::NotConvex))?;
        let mut kept = [None; K];
        let too_many = PolygonAreaError::TooManyKeepOuts(K);
        let places = kept.get_mut(..keep_outs.len()).ok_or(too_many)?;
        for (number, (place, keep_out)) in places.iter_mut().zip(keep_outs).enumerate() {
            if keep_out.radius >= LIMIT.unsigned_abs() {
                return Err(PolygonAreaError::KeepOut(number));
            }
            *place = Some(*keep_out);
        }
        Ok(Self::of(polygon, bounds, kept))
    }

    /// The area of a polygon with these corners, `[x, z]` in metres or points of `nalgebra`, without its keep-outs.
    ///
    /// # Errors
    /// [`PolygonAreaError`] says what is wrong with them.
    pub fn metres<P: Copy + Into<Point2<f64>>>(
        corners: &[P],
        keep_outs: &[KeepOut<C>],
    ) -> Result<Self, PolygonAreaError> {
        Self::new(Hull::metres(corners)?, keep_outs)
    }

    fn of(polygon: Hull<C>, bounds: Area, keep_outs: [Option<KeepOut<C>>; K]) -> Self {
        let mut area = Self {
            polygon,
            bounds,
            sides: [HalfPlane::between(Site::ORIGIN, Site::ORIGIN, 0); C],
            count: 0,
            keep_outs,
        };
        let cuts = |(from, to): &(Site, Site)| from.x() != to.x() && from.z() != to.z();
        for (side, (from, to)) in area.sides.iter_mut().zip(edges(polygon.corners()).filter(cuts)) {
            *side = HalfPlane::between(from, to, bounds.margin());
            area.count += 1;
        }
        area
    }

    /// Its corners, counter-clockwise.
    pub fn corners(&self) -> &[Site] {
        self.polygon.corners()
    }

    /// The keep-outs.
    pub fn hulls(&self) -> impl Iterator<Item = &KeepOut<C>> {
        self.keep_outs.iter().flatten()
    }

    /// Whether some position is as far from all of its sides as its margin says. It clips the rectangle by the sides, in
    /// single precision, so a part as thin as some lattice units may go either way.
    fn has_inside(&self) -> bool {
        let (min, max) = (self.bounds.min(), self.bounds.max());
        let box_corners =
            [(min.x(), min.z()), (max.x(), min.z()), (max.x(), max.z()), (min.x(), max.z())];
        let mut polygon: Vec<[f32; 2], 24, u8> = Vec::new();
        for (x, z) in box_corners {
            let _ = polygon.push([(x - min.x()) as f32, (z - min.z()) as f32]);
        }
        for side in self.sides() {
            let (along, at) = ([side.along.x as f32, side.along.z as f32], side.at(min) as f32);
            let value = |[x, z]: [f32; 2]| along[0] * z - along[1] * x + at;
            let mut rest: Vec<[f32; 2], 24, u8> = Vec::new();
            let next = polygon.iter().copied().cycle().skip(1);
            for (a, b) in polygon.iter().copied().zip(next) {
                let (at_a, at_b) = (value(a), value(b));
                if at_a >= 0.0 {
                    let _ = rest.push(a);
                }
                if (at_a >= 0.0) != (at_b >= 0.0) {
                    let t = at_a / (at_a - at_b);
                    let _ = rest.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
                }
            }
            polygon = rest;
        }
        !polygon.is_empty()
    }

    /// The middle of its corners, which is inside.
    pub fn middle(&self) -> Site {
        middle_of(self.corners())
    }
}

/// A rectangle without keep-outs.
impl<const C: usize, const K: usize> From<Area> for PolygonArea<C, K> {
    fn from(bounds: Area) -> Self {
        Self::of(Hull::of(bounds), bounds, [None; K])
    }
}

/// The rectangle around positions; `None` unless it has an inside.
fn bounds_of(corners: &[Site]) -> Option<Area> {
    let xs = || corners.iter().map(|corner| corner.x());
    let zs = || corners.iter().map(|corner| corner.z());
    let min = Site::new(xs().min()?, zs().min()?).ok()?;
    let max = Site::new(xs().max()?, zs().max()?).ok()?;
    let has_inside = corners.len() > 2;
    Area::new(min, max).ok().filter(|_| has_inside)
}

fn middle_of(corners: &[Site]) -> Site {
    let count = corners.len().max(1) as i64;
    let mean = |coordinates: i64| coordinates.checked_div(count).unwrap_or(0) as i32;
    let x = mean(corners.iter().map(|corner| i64::from(corner.x())).sum());
    let z = mean(corners.iter().map(|corner| i64::from(corner.z())).sum());
    Site::new(x, z).unwrap_or(Site::ORIGIN)
}

impl<const C: usize, const K: usize> Workspace for PolygonArea<C, K> {
    fn bounds(&self) -> Area {
        self.bounds
    }

    fn share_of_bounds(&self) -> f32 {
        let middle = self.middle();
        let twice = |(a, b): (Site, Site)| (a - middle).cross(b - middle) as f32;
        let [x, z] = self.bounds.half_sides().map(|half| half as f32 + self.bounds.margin() as f32);
        edges(self.corners()).map(twice).sum::<f32>() / (8.0 * x * z)
    }

    fn way_home(&self, from: Site) -> Vector {
        let is_in = |it: &Obstacle<'_>| !it.is_clear_of(&[from], 0);
        self.keep_outs().find(is_in).map_or_else(
            || self.middle() - from,
            |it| match from - middle_of(it.corners) {
                Vector { x: 0, z: 0 } => self.middle() - from,
                away => away,
            },
        )
    }

    fn inset(&self, margin: u32) -> Option<Self> {
        let inset = Self::of(self.polygon, self.bounds.inset(margin)?, self.keep_outs);
        inset.has_inside().then_some(inset)
    }

    fn whole(&self) -> Self {
        Self::of(self.polygon, self.bounds.whole(), self.keep_outs)
    }

    fn sides(&self) -> impl Iterator<Item = HalfPlane> {
        self.sides.get(..usize::from(self.count)).unwrap_or_default().iter().copied()
    }

    fn keep_outs(&self) -> impl Iterator<Item = Obstacle<'_>> {
        self.hulls().map(|KeepOut { hull, radius }| Obstacle {
            corners: hull.corners(),
            extent: hull.extent(),
            radius: *radius,
            margin: self.bounds.margin(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_margin_as_wide_as_the_polygon_leaves_no_area() {
        let corners = [[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]];
        let triangle = PolygonArea::<3, 0>::metres(&corners, &[]).unwrap();
        // Its widest circle has a radius of 2.93 m.
        let inset = |metres| triangle.with_clearance(metres);
        assert!(inset(2.9).is_ok() && inset(3.0).is_err());
    }
}
