//! Serialises values that have an invariant: they are written as bare numbers, and checked when they are read.

use crate::belief::noise::Reliability;
use crate::geometry::area::Area;
use crate::geometry::lattice::{LatticeError, Site, Vector};
use crate::geometry::local_line::LocalLine;
use crate::geometry::value::ValueError;
use crate::search::objective::{EffortWeight, RANGE};

impl From<Site> for (i32, i32) {
    fn from(site: Site) -> Self {
        (site.x(), site.z())
    }
}

impl TryFrom<(i32, i32)> for Site {
    type Error = LatticeError;

    fn try_from((x, z): (i32, i32)) -> Result<Self, LatticeError> {
        Self::new(x, z)
    }
}

/// Its corners. The margin of an [inset](Area::inset) part is not written.
impl From<Area> for [Site; 2] {
    fn from(area: Area) -> Self {
        [area.min(), area.max()]
    }
}

impl TryFrom<[Site; 2]> for Area {
    type Error = ValueError;

    fn try_from([min, max]: [Site; 2]) -> Result<Self, ValueError> {
        Self::new(min, max)
    }
}

/// Millionths.
impl From<EffortWeight> for u32 {
    fn from(weight: EffortWeight) -> Self {
        weight.millionths
    }
}

impl TryFrom<u32> for EffortWeight {
    type Error = ValueError;

    fn try_from(millionths: u32) -> Result<Self, ValueError> {
        (millionths < Self::ONE).then_some(Self { millionths }).ok_or(RANGE)
    }
}

/// The logarithm of the odds, in units of 2^-32.
impl From<Reliability> for i64 {
    fn from(reliability: Reliability) -> Self {
        reliability.log_odds()
    }
}

impl TryFrom<i64> for Reliability {
    type Error = ValueError;

    fn try_from(units: i64) -> Result<Self, ValueError> {
        Self::from_log_odds(units).ok_or(ValueError("odds are those of a probability"))
    }
}

/// Its site, its direction, and slope and intercept.
impl From<LocalLine> for (Site, [i32; 2], [f32; 2]) {
    fn from(line: LocalLine) -> Self {
        let along = line.along();
        (line.about(), [along.x(), along.z()], [line.slope(), line.intercept()])
    }
}

impl TryFrom<(Site, [i32; 2], [f32; 2])> for LocalLine {
    type Error = ValueError;

    fn try_from(
        (about, [x, z], [slope, intercept]): (Site, [i32; 2], [f32; 2]),
    ) -> Result<Self, ValueError> {
        const NONE: ValueError = ValueError("a line has a direction, a slope and an intercept");
        let along = Vector::new(x, z).ok_or(NONE)?;
        Self::new(about, along, slope, intercept).ok_or(NONE)
    }
}
