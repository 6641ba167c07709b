//! The threshold of some values that has the fewest labels against it, and the line that has.

use std::f64::consts::{PI, TAU};

use crate::fitting::fit::labels::Labels;

/// A threshold: labels above it are to be +1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Threshold {
    pub(crate) at: f64,
    /// How many labels disagree.
    pub(crate) against: usize,
}

/// The threshold with the fewest labels against it, of values with their labels. Of several it lies in the widest gap.
pub(crate) fn threshold(values: &mut [(f64, bool)]) -> Threshold {
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut against = values.iter().filter(|(_, is_positive)| !is_positive).count();
    let [first, last] = [values.first(), values.last()].map(|it| it.map_or(0.0, |it| it.0));
    let margin = 0.01 * (last - first) + 1e-6;
    let mut best = Threshold { at: first - margin, against };
    let mut widest = margin;
    for (k, &(value, is_positive)) in values.iter().enumerate() {
        against = if is_positive { against + 1 } else { against - 1 };
        let next = values.get(k + 1).map_or(value + 2.0 * margin, |it| it.0);
        let gap = next - value;
        if gap > 0.0 && (against < best.against || (against == best.against && gap > widest)) {
            best = Threshold { at: f64::midpoint(value, next), against };
            widest = gap;
        }
    }
    best
}

/// Some `most` of the indices below `count`, evenly spread.
pub(crate) fn spread(indices: &[usize], most: usize) -> Vec<usize> {
    let count = indices.len();
    if count <= most {
        return indices.to_vec();
    }
    (0..most).map(|k| indices[(k as u64 * count as u64 / most as u64) as usize]).collect()
}

/// A directed line: the angle of its normal, radians, and its distance along it, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Directed {
    pub(crate) angle: f64,
    pub(crate) offset: f64,
}

impl Directed {
    /// How far above the line each position is.
    pub(crate) fn heights(self, labels: &Labels) -> impl Fn(usize) -> f64 {
        let (sin, cos) = libm::sincos(self.angle);
        let offset = self.offset;
        move |index| {
            let at = labels.at[index];
            at.x * cos + at.y * sin - offset
        }
    }
}

/// The line with the fewest of some labels against it, as far as a search by angles finds it. It begins with `tried`
/// angles all around, or near to an angle, and halves their distance some times.
pub(crate) fn line(labels: &Labels, some: &[usize], near: Option<f64>) -> (Directed, usize) {
    let mut values = Vec::with_capacity(some.len());
    let mut of = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        values.clear();
        values.extend(some.iter().map(|&index| {
            let at = labels.at[index];
            (at.x * cos + at.y * sin, labels.is_positive[index])
        }));
        threshold(&mut values)
    };
    let (tried, mut step) = if near.is_some() { (16, PI / 32.0) } else { (32, TAU / 32.0) };
    let from = near.unwrap_or(0.0) - 0.5 * step * f64::from(tried);
    let angles = (0..=tried).map(|k| from + f64::from(k) * step);
    let mut best = angles
        .map(|angle| (angle, of(angle)))
        .min_by_key(|(_, threshold)| threshold.against)
        .unwrap_or((0.0, Threshold { at: 0.0, against: some.len() }));
    for _ in 0..6 {
        step *= 0.5;
        for angle in [best.0 - step, best.0 + step] {
            let found = of(angle);
            if found.against < best.1.against {
                best = (angle, found);
            }
        }
    }
    (Directed { angle: best.0, offset: best.1.at }, best.1.against)
}
