//! The simulated world: the line that divides the plane, the label at each place, and robots that move and sense there.
//! Also shapes in metres.

pub mod errors;
pub mod extent;
pub mod faults;
pub(crate) mod in_order;
pub mod noise;
pub mod polygon;
pub mod robot;

use nalgebra::Point2;
use planner_core::belief::cells::CellView;
use planner_core::{Label, Line, Reading, Site};

/// The world: its straight boundary, if that is known. Around a real vehicle it is not.
#[derive(Clone, Debug)]
pub struct World {
    boundary: Option<Line>,
}

impl World {
    /// A world that a line divides.
    pub const fn divided_by(line: Line) -> Self {
        Self { boundary: Some(line) }
    }

    /// A world of which nobody knows what divides it: no simulated robot senses anything there.
    pub const UNKNOWN: Self = Self { boundary: None };

    /// The line that divides it, if that is known.
    pub const fn line(&self) -> Option<&Line> {
        self.boundary.as_ref()
    }

    /// The distance of a site from the boundary in metres, positive on its +1 side; not a number without one.
    pub fn distance(&self, site: Site) -> f64 {
        self.boundary.map_or(f64::NAN, |line| line.distance(Point2::from(site)))
    }

    /// The reading of a perfect sensor at a site: neither side if the world is not known.
    pub fn reading(&self, site: Site) -> Reading {
        side(self.distance(site))
    }

    /// Whether a label can be the true one of a site. Where the boundary is not known, any label can.
    pub fn agrees(&self, site: Site, label: Label) -> bool {
        self.boundary.is_none() || self.reading(site) == Reading::Side(label)
    }

    /// Whether its line is among the lines of a cell; `None` without a line.
    pub fn is_among(&self, lines: CellView<'_>) -> Option<bool> {
        self.line().map(|_| lines.support().all(|s| self.agrees(s.site, s.label)))
    }
}

/// The reading of a perfect sensor at a site if a line divides the plane.
pub fn reading(line: &Line, site: Site) -> Reading {
    side(line.distance(Point2::from(site)))
}

fn side(distance: f64) -> Reading {
    if distance > 0.0 {
        Label::Positive.into()
    } else if distance < 0.0 {
        Label::Negative.into()
    } else {
        Reading::Boundary
    }
}
