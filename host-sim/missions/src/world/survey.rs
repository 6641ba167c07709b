//! What a curved boundary makes of an area: the share that a line misclassifies, and the line that misclassifies least.
//!
//! The area is cut into columns and into rows. Along each of them the boundary is found exactly, but for parts thinner
//! than one `PLACES`th of it, so that a share is a sum of lengths.

use std::f64::consts::PI;

use nalgebra::{Point2, Vector2};
use planner_core::{Label, Line, Reading};

use crate::world::extent::around;
use crate::world::polygon::Polygon;

/// Columns, and rows.
const STRIPS: u32 = 400;

/// Places along each of them where the label is looked at.
const PLACES: u32 = 400;

/// The resolution of the line that fits best: degrees, and of the area's size, by which its distance from the middle of
/// the area is varied.
pub const RESOLUTION: [f64; 2] = [1e-3, 1e-6];

/// The straight line that misclassifies least of an area.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The line.
    pub line: Line,
    /// The share of the area that it misclassifies.
    pub misclassified: f64,
}

/// An area with a curved boundary.
#[derive(Clone, Debug)]
pub struct Survey {
    columns: Vec<Strip>,
    rows: Vec<Strip>,
    /// The best line.
    pub fit: Fit,
}

/// A column or a row: where it lies on one axis, and what there is along the other.
#[derive(Clone, Debug)]
struct Strip {
    at: f64,
    /// Where it begins, where its label changes, and where it ends. With each, the length so far that is +1.
    changes: Vec<(f64, f64)>,
    /// Whether it begins with +1.
    begins_positive: bool,
}

impl Survey {
    /// Surveys an area. The best line is one that meets the area.
    ///
    /// # Panics
    /// Never: its lines have finite coefficients.
    pub fn of(area: &Polygon, side: impl Fn(Point2<f64>) -> Reading) -> Self {
        let is_positive = |at| side(at) == Reading::Side(Label::Positive);
        let [columns, rows] = [0, 1].map(|axis| strips(area, axis, &is_positive));
        let line = Line::from_slope(0.0, 0.0).expect("finite");
        let mut survey = Self { columns, rows, fit: Fit { line, misclassified: 1.0 } };
        survey.fit = survey.best(area);
        survey
    }

    /// The share of the area to which a line gives the wrong label.
    pub fn misclassified(&self, line: &Line) -> f64 {
        let [a, b, c] = line.coefficients();
        let sums = if a.abs() <= b.abs() {
            sums(&self.columns, [a, b, c])
        } else {
            sums(&self.rows, [b, a, c])
        };
        sums[0] / sums[1]
    }

    /// The best line: first of some in all directions, then step by step from the best of them.
    fn best(&self, area: &Polygon) -> Fit {
        const TURNS: u32 = 90;
        const OFFSETS: i32 = 40;
        const STARTS: usize = 4;
        let [min, max] = around(area.0.iter().copied()).unwrap_or_default();
        let (middle, size) = (nalgebra::center(&min, &max), (max - min).norm());
        let judged = |[turn, offset]: [f64; 2]| {
            let (sin, cos) = libm::sincos(turn);
            let normal = Vector2::new(cos, sin);
            let line = Line::through(middle + normal * offset, normal).expect("a unit normal");
            if area.chord(&line).is_none() {
                return Fit { line, misclassified: f64::INFINITY };
            }
            // The same line the other way round misclassifies the rest.
            let share = self.misclassified(&line);
            if share <= 0.5 {
                return Fit { line, misclassified: share };
            }
            let line = Line::through(middle + normal * offset, -normal).expect("a unit normal");
            Fit { line, misclassified: 1.0 - share }
        };
        let mut starts: Vec<_> = (0..TURNS)
            .filter_map(|turn| {
                let offsets = (-OFFSETS..=OFFSETS).map(|offset| {
                    let step = size / f64::from(2 * OFFSETS);
                    let at = [f64::from(turn) / f64::from(TURNS) * PI, f64::from(offset) * step];
                    (at, judged(at))
                });
                offsets.min_by(|p, q| p.1.misclassified.total_cmp(&q.1.misclassified))
            })
            .collect();
        starts.sort_by(|p, q| p.1.misclassified.total_cmp(&q.1.misclassified));
        let refined = starts.into_iter().take(STARTS).map(|(mut at, mut best)| {
            let mut steps = [PI / f64::from(TURNS), size / f64::from(2 * OFFSETS)];
            while steps[0] > RESOLUTION[0].to_radians() || steps[1] > RESOLUTION[1] * size {
                let ways = [
                    [-1.0, 0.0],
                    [1.0, 0.0],
                    [0.0, -1.0],
                    [0.0, 1.0],
                    [-1.0, -1.0],
                    [-1.0, 1.0],
                    [1.0, -1.0],
                    [1.0, 1.0],
                ];
                let tried = ways.map(|[turn, offset]| {
                    let tried = [at[0] + turn * steps[0], at[1] + offset * steps[1]];
                    (tried, judged(tried))
                });
                let next = tried
                    .into_iter()
                    .min_by(|p, q| p.1.misclassified.total_cmp(&q.1.misclassified));
                match next {
                    Some((place, fit)) if fit.misclassified < best.misclassified => {
                        (at, best) = (place, fit);
                    }
                    _ => steps = steps.map(|step| step / 2.0),
                }
            }
            best
        });
        refined.min_by(|p, q| p.misclassified.total_cmp(&q.misclassified)).unwrap_or(self.fit)
    }
}

/// The lengths that a line `a u + b v + c = 0` gives the wrong label, and all lengths. Strips lie at `u` and run along `v`.
fn sums(strips: &[Strip], [a, b, c]: [f64; 3]) -> [f64; 2] {
    let each = strips.iter().filter_map(|strip| {
        let (&(from, _), &(to, positive)) = (strip.changes.first()?, strip.changes.last()?);
        let crossing = (-(a * strip.at + c) / b).clamp(from, to);
        let below = strip.positive_below(crossing);
        // Where the line has -1 below and +1 above: what is +1 below, and what is -1 above.
        let wrong = below + (to - crossing) - (positive - below);
        Some([if b > 0.0 { wrong } else { to - from - wrong }, to - from])
    });
    each.fold([0.0; 2], |[wrong, all], [w, of]| [wrong + w, all + of])
}

impl Strip {
    /// The length up to some place that is +1.
    fn positive_below(&self, place: f64) -> f64 {
        let after = self.changes.partition_point(|(at, _)| *at <= place).max(1);
        let (at, length) = self.changes[after - 1];
        let is_positive = (after % 2 == 1) == self.begins_positive;
        length + if is_positive { place - at } else { 0.0 }
    }
}

/// The columns of an area (axis 0) or its rows (axis 1).
fn strips(area: &Polygon, axis: usize, is_positive: &impl Fn(Point2<f64>) -> bool) -> Vec<Strip> {
    let [min, max] = around(area.0.iter().copied()).unwrap_or_default();
    let width = (max[axis] - min[axis]) / f64::from(STRIPS);
    let strip = |number: u32| {
        let at = min[axis] + width * (f64::from(number) + 0.5);
        let place = |along: f64| {
            if axis == 0 { Point2::new(at, along) } else { Point2::new(along, at) }
        };
        let crossings = area.sides().filter_map(|(p, q)| {
            let share = (at - p[axis]) / (q[axis] - p[axis]);
            (0.0..=1.0).contains(&share).then(|| p[1 - axis] + share * (q[1 - axis] - p[1 - axis]))
        });
        let [from, to] = crate::world::extent::span(crossings);
        let label = |along: f64| is_positive(place(along));
        (from < to).then(|| changes(at, [from, to], label))
    };
    (0..STRIPS).filter_map(strip).collect()
}

/// A strip with the places where its label changes.
fn changes(at: f64, [from, to]: [f64; 2], label: impl Fn(f64) -> bool) -> Strip {
    const HALVINGS: u32 = 30;
    let place = |number: u32| from + (to - from) * (f64::from(number) / f64::from(PLACES));
    let begins_positive = label(from);
    let (mut last, mut positive) = (begins_positive, 0.0);
    let mut changes = vec![(from, 0.0)];
    let mut add = |end: f64, was: bool| {
        let before = changes.last().map_or(from, |(at, _)| *at);
        positive += if was { end - before } else { 0.0 };
        changes.push((end, positive));
    };
    for number in 1..=PLACES {
        let now = label(place(number));
        if now != last {
            let (mut low, mut high) = (place(number - 1), place(number));
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if label(middle) == last { low = middle } else { high = middle }
            }
            add(0.5 * (low + high), last);
            last = now;
        }
    }
    add(to, last);
    Strip { at, changes, begins_positive }
}
