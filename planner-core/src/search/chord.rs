//! The estimate as it crosses the area's rectangle.

use crate::belief::predictions::Stretch;
use crate::geometry::approximate::{METRE, UnitVector, inverse_sqrt};
use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::local_line::LocalLine;
use crate::geometry::span::Span;

/// The part of an estimate inside a rectangle.
pub(crate) struct Chord {
    /// The middle of the rectangle; from there in metres, a point of the line, and its direction.
    middle: Site,
    base: [f32; 2],
    way: [f32; 2],
    /// What of it lies inside.
    inside: Span,
}

impl Chord {
    /// `None` if the estimate does not cross the rectangle.
    pub(crate) fn of(estimate: LocalLine, area: Area) -> Option<Self> {
        let (middle, half) = (area.middle(), area.half_sides().map(|side| side as f32));
        let unit = UnitVector::of(estimate.along());
        let (slope, intercept) = (estimate.slope(), estimate.intercept());
        let per_length = inverse_sqrt(1.0 + slope * slope);
        let way = [unit.x - slope * unit.z, unit.z + slope * unit.x].map(|it| it * per_length);
        let about = estimate.about() - middle;
        let base = [
            about.x as f32 * METRE - unit.z * intercept,
            about.z as f32 * METRE + unit.x * intercept,
        ];
        let sides = half.map(|side| side * METRE);
        let inside = Span::inside(base, way, sides.map(|side| -side), sides);
        (!inside.is_empty()).then_some(Self { middle, base, way, inside })
    }

    /// Lattice units.
    pub(crate) fn length(&self) -> f32 {
        self.inside.width() * UNITS_PER_METRE as f32
    }

    /// The site at a share of the chord, and so many lattice units to its left.
    pub(crate) fn site(&self, along: f32, aside: f32) -> Option<Site> {
        let ahead = self.inside.low + along * self.inside.width();
        let [x, z] = self.way;
        let aside = aside * METRE;
        let at = [self.base[0] + ahead * x - aside * z, self.base[1] + ahead * z + aside * x];
        let [x, z] = at.map(|it| (it * UNITS_PER_METRE as f32) as i32);
        self.middle.step(Vector::new(x, z)?).ok()
    }

    /// All of it, as a stretch over which lines lie apart.
    pub(crate) fn stretch(&self) -> Option<Stretch> {
        const LONG: f32 = (1 << 24) as f32;
        let [x, z] = self.way.map(|it| (it * LONG) as i32);
        let along = Vector::new(x, z)?;
        Some(Stretch { middle: self.site(0.5, 0.0)?, along, length: self.length() })
    }
}
