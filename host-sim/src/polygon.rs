//! Convex polygons in metres: clipping and area.

use nalgebra::Point2;
use planner_core::area::Area;
use planner_core::line::Line;

/// A convex polygon as its corners in order; empty when there are none.
#[derive(Clone, Debug)]
pub struct Polygon(pub Vec<Point2<f64>>);

impl From<Area> for Polygon {
    fn from(area: Area) -> Self {
        let (a, b) = (Point2::<f64>::from(area.min()), Point2::<f64>::from(area.max()));
        Self(vec![a, Point2::new(b.x, a.y), b, Point2::new(a.x, b.y)])
    }
}

impl Polygon {
    /// The part on the +1 side of the line (`side` 1) or on the other (`side` -1).
    #[must_use]
    pub fn clip(&self, line: &Line, side: f64) -> Self {
        let corners = &self.0;
        let mut kept = Vec::with_capacity(corners.len() + 1);
        for (p, q) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let (d, e) = (side * line.distance(*p), side * line.distance(*q));
            if d >= 0.0 {
                kept.push(*p);
            }
            if (d > 0.0 && e < 0.0) || (d < 0.0 && e > 0.0) {
                kept.push(p + (q - p) * (d / (d - e)));
            }
        }
        Self(kept)
    }

    /// Area, square metres.
    pub fn area(&self) -> f64 {
        let corners = &self.0;
        let twice: f64 = corners
            .iter()
            .zip(corners.iter().cycle().skip(1))
            .map(|(p, q)| p.coords.perp(&q.coords))
            .sum();
        twice.abs() / 2.0
    }
}

/// The share of the area to which the estimate gives the wrong label.
pub fn misclassified(area: Area, truth: &Line, estimate: &Line) -> f64 {
    let all = Polygon::from(area);
    let wrong: f64 =
        [1.0, -1.0].iter().map(|side| all.clip(truth, *side).clip(estimate, -side).area()).sum();
    wrong / all.area()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misclassified_shares_of_a_square() {
        let area = crate::field::area();
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
