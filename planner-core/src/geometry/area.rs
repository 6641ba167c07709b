//! The mission area: the rectangle in which all positions stay.

use nalgebra::Point2;

use crate::geometry::lattice::Site;
use crate::geometry::value::ValueError;

const INSIDE_OUT: ValueError =
    ValueError("an area's second corner lies beyond its first in x and in z");

/// The rectangle in which all positions stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[Site; 2]", into = "[Site; 2]"))]
pub struct Area {
    min: Site,
    max: Site,
    /// How far the border lies outside, lattice units: see [`inset`](Self::inset).
    margin: u32,
}

impl Area {
    /// The rectangle with these corners.
    ///
    /// # Errors
    /// [`ValueError`] unless it has an inside.
    pub fn new(min: Site, max: Site) -> Result<Self, ValueError> {
        let has_inside = min.x() < max.x() && min.z() < max.z();
        has_inside.then_some(Self { min, max, margin: 0 }).ok_or(INSIDE_OUT)
    }

    /// The rectangle with these corners, metres.
    ///
    /// # Errors
    /// [`ValueError`] unless it has an inside and lies within 8,192 m of the origin.
    pub fn metres(
        min: impl Into<Point2<f64>>,
        max: impl Into<Point2<f64>>,
    ) -> Result<Self, ValueError> {
        Self::new(Site::metres(min)?, Site::metres(max)?)
    }

    /// The least rectangle that holds some sites; `None` if it has no inside.
    pub(crate) fn around(sites: impl Iterator<Item = Site>) -> Option<Self> {
        let corners = sites.fold(None, |corners: Option<(Site, Site)>, site| {
            let (min, max) = corners.unwrap_or((site, site));
            let lower = Site::new(min.x().min(site.x()), min.z().min(site.z())).ok()?;
            let upper = Site::new(max.x().max(site.x()), max.z().max(site.z())).ok()?;
            Some((lower, upper))
        });
        corners.and_then(|(min, max)| Self::new(min, max).ok())
    }

    /// The part that is at least so many lattice units away from the border: where to aim if motions end that
    /// far off. It remembers where the border is. `None` if that part has no inside.
    pub fn inset(&self, by: u32) -> Option<Self> {
        let margin = i32::try_from(by).ok()?;
        let inwards = |site: Site, by: i32| {
            let (x, z) = (site.x().checked_add(by)?, site.z().checked_add(by)?);
            Site::new(x, z).ok()
        };
        let inset = Self::new(inwards(self.min, margin)?, inwards(self.max, -margin)?).ok()?;
        Some(Self { margin: self.margin.saturating_add(by), ..inset })
    }

    /// The area of which this is an inset part.
    #[must_use]
    pub fn whole(&self) -> Self {
        let margin = self.margin as i32;
        let outwards = |site: Site, by: i32| {
            Site::new(site.x().saturating_add(by), site.z().saturating_add(by)).unwrap_or(site)
        };
        Self { min: outwards(self.min, -margin), max: outwards(self.max, margin), margin: 0 }
    }

    /// How far the border lies outside of this part of an area, lattice units.
    pub const fn margin(&self) -> u32 {
        self.margin
    }

    /// The corner of smallest coordinates.
    pub const fn min(&self) -> Site {
        self.min
    }

    /// The corner of largest coordinates.
    pub const fn max(&self) -> Site {
        self.max
    }

    /// The site in its middle, rounded.
    pub fn middle(&self) -> Site {
        Site::between(self.min, self.max)
    }

    /// Half of its breadth and half of its height, lattice units; rounded up.
    pub(crate) const fn half_sides(&self) -> [i32; 2] {
        let (x, z) = (self.max.x() - self.min.x(), self.max.z() - self.min.z());
        [(x + 1) / 2, (z + 1) / 2]
    }

    /// The mean of its breadth and its height, lattice units.
    pub(crate) fn mean_side(&self) -> f32 {
        self.half_sides().into_iter().map(|half| half as f32).sum()
    }

    /// Whether all of a disc lies inside or on the border; the radius in lattice units, below 2^30.
    pub fn contains_disc(&self, centre: Site, radius: i32) -> bool {
        let (from, to) = (centre - self.min, self.max - centre);
        [from.x, from.z, to.x, to.z].into_iter().all(|inside| inside >= radius)
    }

    /// Whether a position lies inside or on the border.
    pub fn contains(&self, q: Site) -> bool {
        (self.min.x()..=self.max.x()).contains(&q.x())
            && (self.min.z()..=self.max.z()).contains(&q.z())
    }
}

/// Its corners. The margin of an [inset](Area::inset) part is not written.
impl From<Area> for [Site; 2] {
    fn from(Area { min, max, .. }: Area) -> Self {
        [min, max]
    }
}

impl TryFrom<[Site; 2]> for Area {
    type Error = ValueError;

    fn try_from([min, max]: [Site; 2]) -> Result<Self, ValueError> {
        Self::new(min, max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inset_of_an_inset_remembers_both_margins() {
        let area = Area::metres([0.0, 0.0], [10.0, 10.0]).unwrap();
        let twice = area.inset(3).and_then(|it| it.inset(4)).unwrap();
        assert_eq!((twice.margin(), twice.whole()), (7, area));
    }
}
