//! The simulated world: the boundary that divides the plane, the label at each place, and robots that move and sense
//! there. Also shapes in metres.

pub mod boundary;
pub mod circle;
pub mod coast;
pub mod crs;
pub mod errors;
pub mod extent;
pub mod faults;
pub mod files;
pub mod frame;
#[cfg(not(target_family = "wasm"))]
pub mod geotiff;
pub mod grid;
pub(crate) mod in_order;
pub mod moving;
pub mod noise;
pub mod on_the_way;
pub mod polygon;
pub mod polyline;
pub mod raster;
pub mod raster_file;
pub mod robot;
pub mod shapes;
pub mod sine;
pub mod survey;
pub mod way;

#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::{Point2, Vector2};
use planner_core::{CellView, Label, Line, Reading, Site};

use crate::world::boundary::{BoundaryRecord, Curve, side};
use crate::world::moving::Moving;
use crate::world::polygon::Polygon;
use crate::world::survey::{Fit, Survey};
use crate::world::way::{Way, parts};

/// The world: its boundary, if that is known. Around a real vehicle it is not.
#[derive(Clone, Debug)]
pub struct World {
    boundary: Boundary,
    /// The motions that the robot has made.
    motions: u32,
}

#[derive(Clone, Debug)]
enum Boundary {
    Unknown,
    Line(Line),
    Moving(Moving),
    Curved(Arc<Curved>),
}

/// A boundary that is no straight line, and what it makes of the mission's area.
#[derive(Debug)]
struct Curved {
    curve: Box<dyn Curve>,
    /// The area, and what the boundary makes of it at the start.
    area: Polygon,
    survey: Survey,
    /// By so many metres the boundary moves in each motion.
    drift: Vector2<f64>,
}

/// A curve after some motions: the same, moved.
#[derive(Clone, Copy)]
struct Moved<'a> {
    curve: &'a dyn Curve,
    by: Vector2<f64>,
}

impl Moved<'_> {
    fn side(&self, at: Point2<f64>) -> Reading {
        self.curve.side(at - self.by)
    }

    fn distance(&self, at: Point2<f64>) -> f64 {
        self.curve.distance(at - self.by)
    }

    fn ways(&self, rectangle: [Point2<f64>; 2]) -> Vec<Way> {
        let ways = self.curve.ways(rectangle.map(|at| at - self.by)).into_iter();
        ways.map(|way| way.into_iter().map(|at| at + self.by).collect()).collect()
    }
}

impl World {
    /// A world that a line divides.
    pub const fn divided_by(line: Line) -> Self {
        Self { boundary: Boundary::Line(line), motions: 0 }
    }

    /// A world that a line divides which moves.
    pub const fn divided_by_moving(line: Moving) -> Self {
        Self { boundary: Boundary::Moving(line), motions: 0 }
    }

    /// A world that a curve divides, for missions in an area.
    pub fn divided_by_curve(curve: Box<dyn Curve>, area: &Polygon) -> Self {
        Self::divided_by_moving_curve(curve, area, Vector2::zeros())
    }

    /// A world that a curve divides which moves by so many metres in each motion.
    pub fn divided_by_moving_curve(
        curve: Box<dyn Curve>,
        area: &Polygon,
        drift: Vector2<f64>,
    ) -> Self {
        let survey = Survey::of(area, |at| curve.side(at));
        let curved = Curved { curve, area: area.clone(), survey, drift };
        Self { boundary: Boundary::Curved(Arc::new(curved)), motions: 0 }
    }

    /// A world of which nobody knows what divides it: no simulated robot senses anything there.
    pub const UNKNOWN: Self = Self { boundary: Boundary::Unknown, motions: 0 };

    /// Whether anything is known of its boundary.
    pub const fn is_known(&self) -> bool {
        !matches!(self.boundary, Boundary::Unknown)
    }

    /// Whether its boundary is a straight line, which may move.
    pub const fn is_line(&self) -> bool {
        matches!(self.boundary, Boundary::Line(_) | Boundary::Moving(_))
    }

    /// Whether its boundary moves.
    pub fn moves(&self) -> bool {
        match &self.boundary {
            Boundary::Moving(_) => true,
            Boundary::Curved(it) => it.drift != Vector2::zeros(),
            Boundary::Unknown | Boundary::Line(_) => false,
        }
    }

    /// The curve that divides it as it is now.
    fn curve_now<'a>(&self, Curved { curve, drift, .. }: &'a Curved) -> Moved<'a> {
        Moved { curve: &**curve, by: drift * f64::from(self.motions) }
    }

    /// What the curve makes of its area now.
    fn survey_now<'a>(&self, curved: &'a Curved) -> Cow<'a, Survey> {
        if !self.moves() || self.motions == 0 {
            return Cow::Borrowed(&curved.survey);
        }
        let curve = self.curve_now(curved);
        Cow::Owned(Survey::of(&curved.area, |at| curve.side(at)))
    }

    /// The line that divides it, if that is known and stays the same.
    pub const fn line(&self) -> Option<&Line> {
        match &self.boundary {
            Boundary::Line(line) => Some(line),
            _ => None,
        }
    }

    /// The world after so many motions of the robot.
    #[must_use]
    pub fn after(&self, motions: usize) -> Self {
        Self { motions: motions as u32, ..self.clone() }
    }

    /// The robot makes a motion.
    pub const fn advance(&mut self) {
        self.motions += 1;
    }

    /// The straight line that divides it now.
    fn line_now(&self) -> Option<Line> {
        match &self.boundary {
            Boundary::Line(line) => Some(*line),
            Boundary::Moving(moving) => Some(moving.after(self.motions)),
            Boundary::Unknown | Boundary::Curved(_) => None,
        }
    }

    /// The distance of a site from the boundary in metres, positive on its +1 side; not a number without one.
    pub fn distance(&self, site: Site) -> f64 {
        let at = Point2::from(site);
        match &self.boundary {
            Boundary::Curved(it) => {
                let curve = self.curve_now(it);
                curve.distance(at) * f64::from(curve.side(at).sign())
            }
            _ => self.line_now().map_or(f64::NAN, |line| line.distance(at)),
        }
    }

    /// The reading of a perfect sensor at a site: neither side if the world is not known.
    pub fn reading(&self, site: Site) -> Reading {
        match &self.boundary {
            Boundary::Curved(it) => self.curve_now(it).side(Point2::from(site)),
            _ => side(self.distance(site)),
        }
    }

    /// Whether a label can be the true one of a site. Where the boundary is not known, any label can.
    pub fn agrees(&self, site: Site, label: Label) -> bool {
        !self.is_known() || self.reading(site) == Reading::Side(label)
    }

    /// Whether its line is among the lines of a cell; `None` without a line.
    pub fn is_among(&self, lines: CellView<'_>) -> Option<bool> {
        self.line().map(|_| lines.support().all(|s| self.agrees(s.site, s.label)))
    }

    /// The share of an area to which a line gives the wrong label; `None` if the boundary is not known. A curve has its
    /// own area.
    pub fn misclassified(&self, area: impl Into<Polygon>, line: &Line) -> Option<f64> {
        match &self.boundary {
            Boundary::Curved(it) => Some(self.survey_now(it).misclassified(line)),
            _ => self.line_now().map(|truth| polygon::misclassified(area, &truth, line)),
        }
    }

    /// The straight line that misclassifies least now; `None` if the boundary is not known.
    pub fn fit(&self) -> Option<Fit> {
        match &self.boundary {
            Boundary::Curved(it) => Some(self.survey_now(it).fit),
            _ => self.line_now().map(|line| Fit { line, misclassified: 0.0 }),
        }
    }

    /// The boundary within an area now.
    pub fn ways(&self, area: &Polygon) -> Vec<Way> {
        if let Boundary::Curved(it) = &self.boundary {
            let rectangle = extent::around(area.0.iter().copied()).unwrap_or_default();
            let ways = self.curve_now(it).ways(rectangle);
            return ways.iter().flat_map(|way| parts(way, area)).collect();
        }
        let chord = self.line_now().and_then(|line| area.chord(&line));
        chord.into_iter().map(Vec::from).collect()
    }

    /// What its boundary is, if that is known and no fixed line.
    pub fn record(&self) -> Option<BoundaryRecord> {
        match &self.boundary {
            Boundary::Unknown | Boundary::Line(_) => None,
            Boundary::Moving(moving) => Some(moving.record()),
            Boundary::Curved(it) => {
                let drift = self.moves().then(|| it.drift.into());
                Some(BoundaryRecord { drift, ..it.curve.record() })
            }
        }
    }
}

/// The reading of a perfect sensor at a site if a line divides the plane.
pub fn reading(line: &Line, site: Site) -> Reading {
    side(line.distance(Point2::from(site)))
}
