//! The results of a set of lines, from the lines at its corners: slopes, intercepts, and the ground on which all agree.

use std::f64::consts::PI;

use nalgebra::Vector2;
use planner_core::{Label, Line};

use crate::world::extent::span;
use crate::world::polygon::Polygon;

/// A line `normal . q = distance`, with a unit normal that points to its +1 side; metres.
pub type ByNormal = (Vector2<f64>, f64);

/// As a line of the planner's.
pub fn line((normal, distance): ByNormal) -> Option<Line> {
    Line::from_coefficients(normal.x, normal.y, -distance)
}

/// The smallest arc of slopes that spans some ranges of directions, radians. It is given as intervals of degrees within
/// [-90, 90], two where it crosses the vertical.
pub fn slope_arcs(directions: impl IntoIterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    const ALL: [f64; 2] = [-90.0, 90.0];
    let turned = |[from, to]: [f64; 2]| {
        let first = from.rem_euclid(PI);
        [first, first + (to - from)]
    };
    let mut arcs: Vec<_> = directions.into_iter().map(turned).collect();
    arcs.sort_by(|a, b| a[0].total_cmp(&b[0]));
    // The widest gap between them is what they leave out.
    let mut reached = arcs.iter().map(|arc| arc[1]).fold(f64::NEG_INFINITY, f64::max) - PI;
    let mut gap: Option<[f64; 2]> = None;
    for &[from, to] in &arcs {
        if from > reached && gap.is_none_or(|[a, b]| from - reached > b - a) {
            gap = Some([reached, from]);
        }
        reached = reached.max(to);
    }
    let Some([from, to]) = gap else { return vec![ALL] };
    let turn = if to >= PI / 2.0 { PI } else { 0.0 };
    let [from, to] = [to - turn, from + PI - turn].map(f64::to_degrees);
    if to <= 90.0 { vec![[from, to]] } else { vec![[-90.0, to - 180.0], [from, 90.0]] }
}

/// The range of the intercepts of some lines whose slopes span arcs, metres; `None` where a vertical one is among them.
pub fn intercepts(
    arcs: &[[f64; 2]],
    lines: impl IntoIterator<Item = ByNormal>,
) -> Option<[f64; 2]> {
    let [[from, to]] = arcs else { return None };
    if *from <= -90.0 || *to >= 90.0 {
        return None;
    }
    Some(span(lines.into_iter().map(|(normal, distance)| distance / normal.y)))
}

/// The parts of some ground that all lines label +1, and -1.
pub fn agreed(ground: &Polygon, lines: &[ByNormal]) -> [Polygon; 2] {
    [Label::Positive, Label::Negative].map(|label| {
        let side = f64::from(label.sign());
        let clip = |rest: Polygon, it: &ByNormal| match line(*it) {
            Some(line) if rest.0.iter().any(|at| side * line.distance(*at) < 0.0) => {
                rest.clip(&line, side)
            }
            _ => rest,
        };
        lines.iter().fold(ground.clone(), clip)
    })
}
