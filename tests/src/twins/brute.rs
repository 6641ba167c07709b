//! The measure of the lines that separate samples, by sweeping the angle: it shares no code with the
//! planner's cells, measures or version spaces.

use nalgebra::{Point2, Vector2};
use planner_core::{Label, Sample};

/// The measure d(angle) d(offset) of all lines that agree with the samples, in radian metres; 0 where
/// none does, or only single ones.
///
/// Between two angles at which some line through two samples runs, the same two samples bound the
/// offsets: the lowest of the positive ones and the highest of the negative ones, as seen along the
/// normal. `O(n^3)`.
pub fn measure(samples: &[Sample]) -> f64 {
    let Some(first) = samples.first() else { return 0.0 };
    let about = Point2::<f64>::from(first.site);
    let of = |label: Label| -> Vec<Vector2<f64>> {
        let of = samples.iter().filter(|s| s.label == label);
        of.map(|s| Point2::<f64>::from(s.site) - about).collect()
    };
    let (positive, negative) = (of(Label::Positive), of(Label::Negative));
    let all = || positive.iter().chain(&negative);
    let mut angles = vec![0.0, std::f64::consts::TAU];
    for (p, q) in all().flat_map(|p| all().map(move |q| (p, q))).filter(|(p, q)| p != q) {
        // The normal of the line through both; the pair the other way round has the opposite one.
        let normal = f64::atan2(q.x - p.x, -(q.y - p.y));
        angles.push(normal.rem_euclid(std::f64::consts::TAU));
    }
    angles.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    for ends in angles.windows(2) {
        let [from, to] = [ends[0], ends[1]];
        let (sin, cos) = f64::midpoint(from, to).sin_cos();
        let normal = Vector2::new(cos, sin);
        let height = |v: &&Vector2<f64>| v.dot(&normal);
        let by_height = |a: &&Vector2<f64>, b: &&Vector2<f64>| height(a).total_cmp(&height(b));
        let (low, high) = (positive.iter().min_by(by_height), negative.iter().max_by(by_height));
        let (Some(low), Some(high)) = (low, high) else { return f64::INFINITY };
        let gap = low - high;
        if gap.dot(&normal) > 0.0 {
            // The integral of the gap's component along the normal.
            let (a, b) = (from.sin_cos(), to.sin_cos());
            sum += gap.x * (b.0 - a.0) - gap.y * (b.1 - a.1);
        }
    }
    sum
}
