//! An area and the chart of what is open in it.

use crate::geometry::area::Area;
use crate::geometry::chart::Chart;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::value::ValueError;
use crate::geometry::workspace::{HalfPlane, Obstacle, Workspace};

/// An area in which motions stay on the open cells of a [`Chart`], if there is one.
///
/// Keep-outs of the area count too.
#[derive(Clone, Copy, Debug)]
pub struct Charted<'a, G = Area> {
    area: G,
    chart: Option<Chart<'a>>,
}

impl<'a, G: Workspace> Charted<'a, G> {
    /// An area with a chart. Without one, all of the area is open but its keep-outs.
    pub const fn new(area: G, chart: Option<Chart<'a>>) -> Self {
        Self { area, chart }
    }

    /// The area.
    pub const fn area(&self) -> &G {
        &self.area
    }
}

impl<'a> From<Chart<'a>> for Charted<'a> {
    /// The rectangle around all cells.
    fn from(chart: Chart<'a>) -> Self {
        Self::new(chart.bounds(), Some(chart))
    }
}

impl<G: Workspace> Workspace for Charted<'_, G> {
    fn bounds(&self) -> Area {
        self.area.bounds()
    }

    fn share_of_bounds(&self) -> f32 {
        self.area.share_of_bounds()
    }

    fn way_home(&self, from: Site) -> Vector {
        let margin = self.area.bounds().margin();
        let home = self.chart.and_then(|it| it.way_home(from, margin));
        home.unwrap_or_else(|| self.area.way_home(from))
    }

    fn with_clearance(&self, metres: f64) -> Result<Self, ValueError> {
        Ok(Self { area: self.area.with_clearance(metres)?, ..*self })
    }

    fn inset(&self, margin: u32) -> Option<Self> {
        Some(Self { area: self.area.inset(margin)?, ..*self })
    }

    fn whole(&self) -> Self {
        Self { area: self.area.whole(), ..*self }
    }

    fn sides(&self) -> impl Iterator<Item = HalfPlane> {
        self.area.sides()
    }

    fn keep_outs(&self) -> impl Iterator<Item = Obstacle<'_>> {
        self.area.keep_outs()
    }

    fn chart(&self) -> Option<Chart<'_>> {
        self.chart
    }
}
