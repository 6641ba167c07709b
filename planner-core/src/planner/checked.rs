//! Serialises values that have an invariant: they are written as bare numbers, and checked when they are read.

use crate::belief::noise::Reliability;
use crate::geometry::area::Area;
use crate::geometry::lattice::{OffLattice, Site, Vector};
use crate::geometry::local_line::LocalLine;
use crate::search::objective::Varrho;

impl From<Site> for (i32, i32) {
    fn from(site: Site) -> Self {
        (site.x(), site.z())
    }
}

impl TryFrom<(i32, i32)> for Site {
    type Error = OffLattice;

    fn try_from((x, z): (i32, i32)) -> Result<Self, OffLattice> {
        Self::new(x, z)
    }
}

/// A number that is none of the type it should be of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfRange;

impl core::fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("out of range")
    }
}

impl core::error::Error for OutOfRange {}

/// Its corners.
impl From<Area> for [Site; 2] {
    fn from(area: Area) -> Self {
        [area.min(), area.max()]
    }
}

impl TryFrom<[Site; 2]> for Area {
    type Error = OutOfRange;

    fn try_from([min, max]: [Site; 2]) -> Result<Self, OutOfRange> {
        Self::new(min, max).ok_or(OutOfRange)
    }
}

/// Millionths.
impl From<Varrho> for u32 {
    fn from(varrho: Varrho) -> Self {
        varrho.millionths
    }
}

impl TryFrom<u32> for Varrho {
    type Error = OutOfRange;

    fn try_from(millionths: u32) -> Result<Self, OutOfRange> {
        (millionths < Self::ONE).then_some(Self { millionths }).ok_or(OutOfRange)
    }
}

/// The logarithm of the odds, in units of 2^-32.
impl From<Reliability> for i64 {
    fn from(reliability: Reliability) -> Self {
        reliability.log_odds()
    }
}

impl TryFrom<i64> for Reliability {
    type Error = OutOfRange;

    fn try_from(units: i64) -> Result<Self, OutOfRange> {
        Self::from_log_odds(units).ok_or(OutOfRange)
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
    type Error = OutOfRange;

    fn try_from(
        (about, [x, z], [slope, intercept]): (Site, [i32; 2], [f32; 2]),
    ) -> Result<Self, OutOfRange> {
        let along = Vector::new(x, z).ok_or(OutOfRange)?;
        Self::new(about, along, slope, intercept).ok_or(OutOfRange)
    }
}
