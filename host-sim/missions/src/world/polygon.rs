//! Convex polygons in metres: clipping, area, and certain ground.

use nalgebra::{Point2, Vector2};
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::link::message::MissionArea;
use planner_core::parts::Bound;
use planner_core::{Area, KeepOut, Label, Line, Sample};
use serde::Serialize;

use crate::world::extent::around;

/// A convex polygon as its corners in order; empty when there are none.
#[derive(Clone, Debug, Serialize)]
pub struct Polygon(pub Vec<Point2<f64>>);

impl From<Area> for Polygon {
    fn from(area: Area) -> Self {
        let (a, b) = (Point2::<f64>::from(area.min()), Point2::<f64>::from(area.max()));
        Self(vec![a, Point2::new(b.x, a.y), b, Point2::new(a.x, b.y)])
    }
}

impl From<MissionArea> for Polygon {
    fn from(area: MissionArea) -> Self {
        Self(area.corners().iter().copied().map(Point2::from).collect())
    }
}

/// The border of a keep-out. Each quarter turn of an arc becomes 16 chords.
impl<const C: usize> From<&KeepOut<C>> for Polygon {
    fn from(KeepOut { hull, radius }: &KeepOut<C>) -> Self {
        const CHORDS: u32 = 64;
        let radius = f64::from(*radius) / f64::from(UNITS_PER_METRE);
        let corners: Vec<Point2<f64>> = hull.corners().iter().map(|at| Point2::from(*at)).collect();
        if radius == 0.0 {
            return Self(corners);
        }
        // The corner that is furthest a way, and the radius beyond it.
        let at = |n: u32| {
            let (sin, cos) = libm::sincos(f64::from(n) / f64::from(CHORDS) * std::f64::consts::TAU);
            let way = Vector2::new(cos, sin);
            let furthest =
                corners.iter().max_by(|a, b| a.coords.dot(&way).total_cmp(&b.coords.dot(&way)));
            furthest.map(|corner| corner + way * radius)
        };
        Self((0..CHORDS).filter_map(at).collect())
    }
}

impl Polygon {
    /// The part on the +1 side of the line (`side` 1) or on the other (`side` -1).
    #[must_use]
    pub fn clip(&self, line: &Line, side: f64) -> Self {
        self.above(|at| side * line.distance(at))
    }

    /// The part where a linear function is not negative.
    #[must_use]
    pub fn above(&self, height: impl Fn(Point2<f64>) -> f64) -> Self {
        let mut kept = Vec::with_capacity(self.0.len() + 1);
        for (p, q) in self.sides() {
            let (d, e) = (height(p), height(q));
            if d >= 0.0 {
                kept.push(p);
            }
            if (d > 0.0 && e < 0.0) || (d < 0.0 && e > 0.0) {
                kept.push(p + (q - p) * (d / (d - e)));
            }
        }
        Self(kept)
    }

    /// The sides in order, each by its two ends.
    pub fn sides(&self) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> + '_ {
        self.0.iter().copied().zip(self.0.iter().copied().cycle().skip(1))
    }

    /// Where a line enters and leaves it; none if it passes by.
    pub fn across(&self, line: &Line) -> Vec<Point2<f64>> {
        let part = self.clip(line, 1.0).0;
        part.into_iter().filter(|at| line.distance(*at).abs() < 1e-6).collect()
    }

    /// The two ends of the part of a line in it, from left to right as one looks from the line's +1 side; `None` if the
    /// line passes by.
    pub fn chord(&self, line: &Line) -> Option<[Point2<f64>; 2]> {
        let detail = 1e-9 * self.diameter() + 1e-6;
        let part = self.clip(line, 1.0).0;
        let on = || part.iter().copied().filter(|at| line.distance(*at).abs() < detail);
        let [a, b, _] = line.coefficients();
        let along = |p: &Point2<f64>, q: &Point2<f64>| {
            let [p, q] = [p, q].map(|at| b * at.x - a * at.y);
            p.total_cmp(&q)
        };
        Some([on().min_by(along)?, on().max_by(along)?])
    }

    /// The part in a convex polygon whose corners go counter-clockwise.
    #[must_use]
    pub fn within(self, convex: &Self) -> Self {
        let lines = convex.sides().filter_map(|(p, q)| {
            let way = q - p;
            Line::through(p, Vector2::new(-way.y, way.x))
        });
        lines.fold(self, |ground, line| ground.clip(&line, 1.0))
    }

    /// The part of an area to which all lines give `label`. The samples of `support`, in cyclic order, bound these
    /// lines; all of them lie in the area.
    ///
    /// This part lies beyond the two lines that pass between the labels. It also lies beyond the samples of the label,
    /// which cut off the corner where the two lines cross.
    pub fn certain(area: impl Into<Self>, support: &[Sample], label: Label) -> Self {
        let next = support.iter().cycle().skip(1);
        let sides = support.iter().zip(next).filter(|(p, q)| p.label != q.label);
        let bound = |(p, q): (&Sample, &Sample)| Bound { through: p.site, along: p.site - q.site };
        let lines: Vec<_> = sides.map(|pair| Line::from(bound(pair))).collect();
        let beyond = |ground: Self, line: &Line| ground.clip(line, f64::from(label.sign()));
        let mut ground = lines.iter().fold(area.into(), beyond);
        let off =
            |corner: &Point2<f64>| lines.iter().map(|line| line.distance(*corner).abs()).sum();
        let offs: Vec<f64> = ground.0.iter().map(off).collect();
        if let Some(crossing) = (0..offs.len()).min_by(|a, b| offs[*a].total_cmp(&offs[*b])) {
            let opposite = support.iter().position(|s| s.label != label).unwrap_or_default();
            let from_opposite = support.iter().cycle().skip(opposite).take(support.len());
            let mut own: Vec<_> =
                from_opposite.filter(|s| s.label == label).map(|s| Point2::from(s.site)).collect();
            if label == Label::Negative {
                own.reverse(); // corners go counter-clockwise, and round a negative hull a cell does not
            }
            ground.0.splice(crossing..=crossing, own);
        }
        ground
    }

    /// Whether a place lies in a convex polygon, or on its border.
    pub fn holds(&self, at: Point2<f64>) -> bool {
        let turns = || self.sides().map(|(p, q)| (q - p).perp(&(at - p)));
        turns().all(|turn| turn >= 0.0) || turns().all(|turn| turn <= 0.0)
    }

    /// The longest way across the rectangle around it, metres.
    pub fn diameter(&self) -> f64 {
        around(self.0.iter().copied()).map_or(0.0, |[min, max]| (max - min).norm())
    }

    /// Area, square metres.
    pub fn area(&self) -> f64 {
        let twice: f64 = self.sides().map(|(p, q)| p.coords.perp(&q.coords)).sum();
        twice.abs() / 2.0
    }
}

/// The share of the area to which the estimate gives the wrong label.
pub fn misclassified(area: impl Into<Polygon>, truth: &Line, estimate: &Line) -> f64 {
    let all: Polygon = area.into();
    let wrong: f64 =
        [1.0, -1.0].iter().map(|side| all.clip(truth, *side).clip(estimate, -side).area()).sum();
    wrong / all.area()
}

#[cfg(test)]
mod tests {
    use planner_core::Site;

    use super::*;

    #[test]
    fn misclassified_shares_of_a_square() {
        let corner = |m: f64| Site::try_from(Point2::new(m, m)).unwrap();
        let area = Area::new(corner(0.0), corner(20.0)).unwrap();
        let line = |slope, intercept| Line::from_slope(slope, intercept).unwrap();
        for (truth, estimate, share) in [
            (line(0.0, 10.0), line(0.0, 10.0), 0.0),
            (line(0.0, 10.0), line(0.0, 11.0), 0.05),
            (line(1.0, 0.0), line(-1.0, 20.0), 0.5),
            (line(0.0, -5.0), line(0.0, 30.0), 1.0),
        ] {
            let got = misclassified(area, &truth, &estimate);
            assert!((got - share).abs() < 1e-12, "{got} for {share}");
        }
    }
}
