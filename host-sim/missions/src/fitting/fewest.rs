//! The line that the fewest labels disagree with, of labels that no line need separate.
//!
//! Which labels lie on which side of a line changes, as the line turns, only where it is parallel to the line through two
//! of them. So one direction between each two neighbouring ones of those stands for all. The search is exact, but for
//! directions that differ by the rounding of double precision.
//!
//! That takes `n^2` directions of `n` labels. Of more than 128 labels it tries 720 directions all around, and then ever
//! finer ones about the best: `O(n log n)`. A few labels more may then disagree than with the best line.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point2, Vector2, center};
use planner_core::{Label, Line, Sample};

use crate::world::extent::around;

/// A line, and the labels that disagree with it.
#[derive(Clone, Debug)]
pub struct Fewest {
    /// The line. Of several that the same number disagrees with, it is one that the others leave the most room.
    pub line: Line,
    /// The numbers of the labels that disagree, in order.
    pub disagreeing: Vec<usize>,
}

/// So many labels are searched exactly.
const EXACT: usize = 128;

impl Fewest {
    /// The line that the fewest of some labels disagree with. `None` without a label.
    pub fn of(samples: &[Sample]) -> Option<Self> {
        let places: Vec<_> = samples.iter().map(|it| Point2::<f64>::from(it.site)).collect();
        let [low, high] = around(places.iter().copied())?;
        let middle = center(&low, &high);
        let labels = places.iter().zip(samples);
        let labels: Vec<_> =
            labels.map(|(at, it)| (at - middle, it.label == Label::Positive)).collect();
        let found = if samples.len() <= EXACT {
            among(&labels, between(&turns(&places)))
        } else {
            all_around(&labels, 720)
        };
        let (angle, Threshold { at, .. }) = found?;
        let (sin, cos) = libm::sincos(angle);
        let normal = Vector2::new(cos, sin);
        let line = Line::through(middle + normal * at, normal)?;
        let disagreeing = (0..samples.len()).filter(|k| {
            let (place, is_positive) = labels[*k];
            (normal.dot(&place) > at) != is_positive
        });
        Some(Self { line, disagreeing: disagreeing.collect() })
    }
}

/// A threshold: labels above it are to be +1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Threshold {
    pub(crate) at: f64,
    /// How many labels disagree.
    pub(crate) against: usize,
    /// How far the nearest value is.
    room: f64,
}

/// The threshold with the fewest labels against it, of values with their labels. Of several it has the most room.
pub(crate) fn threshold(values: &mut [(f64, bool)]) -> Threshold {
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut against = values.iter().filter(|(_, is_positive)| !is_positive).count();
    let [first, last] = [values.first(), values.last()].map(|it| it.map_or(0.0, |it| it.0));
    let margin = 0.01 * (last - first) + 1e-6;
    let mut best = Threshold { at: first - margin, against, room: margin };
    for (k, &(value, is_positive)) in values.iter().enumerate() {
        against = if is_positive { against + 1 } else { against - 1 };
        let next = values.get(k + 1).map_or(value + 2.0 * margin, |it| it.0);
        let room = 0.5 * (next - value);
        if room > 0.0 && (against, best.room) < (best.against, room) {
            best = Threshold { at: f64::midpoint(value, next), against, room };
        }
    }
    best
}

/// The best of the lines whose normals have some angles.
fn among(
    labels: &[(Vector2<f64>, bool)],
    angles: impl IntoIterator<Item = f64>,
) -> Option<(f64, Threshold)> {
    let mut heights = Vec::new();
    let cuts = angles.into_iter().map(|angle| {
        let (sin, cos) = libm::sincos(angle);
        heights.clear();
        heights.extend(labels.iter().map(|(at, is)| (at.x * cos + at.y * sin, *is)));
        (angle, threshold(&mut heights))
    });
    cuts.min_by(|(_, a), (_, b)| a.against.cmp(&b.against).then(b.room.total_cmp(&a.room)))
}

/// The best line, as far as a search finds it that begins with so many directions.
pub(crate) fn all_around(
    labels: &[(Vector2<f64>, bool)],
    directions: u32,
) -> Option<(f64, Threshold)> {
    let mut step = TAU / f64::from(directions);
    let mut best = among(labels, (0..directions).map(|k| step * f64::from(k)))?;
    for _ in 0..10 {
        step *= 0.5;
        best = among(labels, [best.0, best.0 - step, best.0 + step])?;
    }
    Some(best)
}

/// The directions in which two of some places have the same height, as angles of normals below half a turn, in order.
fn turns(places: &[Point2<f64>]) -> Vec<f64> {
    let mut turns = Vec::new();
    for (k, p) in places.iter().enumerate() {
        for q in places.iter().take(k) {
            let way = p - q;
            if way != Vector2::zeros() {
                turns.push(libm::atan2(way.x, -way.y).rem_euclid(PI));
            }
        }
    }
    turns.sort_by(f64::total_cmp);
    turns.dedup();
    turns
}

/// Angles of normals, one between each two neighbouring ones of some all around.
fn between(turns: &[f64]) -> Vec<f64> {
    let Some(first) = turns.first() else { return vec![0.0, PI] };
    let next = turns.iter().skip(1).copied().chain([first + PI]);
    let middles = turns.iter().zip(next).map(|(turn, next)| f64::midpoint(*turn, next));
    middles.flat_map(|it| [it, it + PI]).map(|it| it.rem_euclid(TAU)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use planner_core::Site;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    fn drawn(rng: &mut ChaCha8Rng, count: usize, side: i32, wrong: f64) -> Vec<Sample> {
        let [a, b, c] = [0; 3].map(|_| rng.random_range(-1.0..1.0) * f64::from(side));
        let sample = |_| {
            let [x, z] = [0; 2].map(|_| rng.random_range(-side..=side));
            let is_above = a * f64::from(x) + b * f64::from(z) + 0.3 * c * f64::from(side) > 0.0;
            let is_positive = is_above != rng.random_bool(wrong);
            let label = if is_positive { Label::Positive } else { Label::Negative };
            Sample { site: Site::new(x, z).expect("near"), label }
        };
        (0..count).map(sample).collect()
    }

    /// Every line that passes two of the places, moved and turned a little to either side of each: in integers.
    fn fewest_by_pairs(samples: &[Sample]) -> usize {
        let count = samples.len();
        let positive = samples.iter().filter(|it| it.label == Label::Positive).count();
        let mut least = positive.min(count - positive);
        for p in samples {
            for q in samples {
                let way = [q.site.x() - p.site.x(), q.site.z() - p.site.z()].map(i64::from);
                if way == [0; 2] {
                    continue;
                }
                // On the line: those before a place are on one side and those after it on the other, as it turns.
                let place = |it: &Sample| {
                    let off = [it.site.x() - p.site.x(), it.site.z() - p.site.z()].map(i64::from);
                    (way[0] * off[1] - way[1] * off[0], way[0] * off[0] + way[1] * off[1])
                };
                let mut cuts: Vec<i64> =
                    samples.iter().map(place).filter(|it| it.0 == 0).map(|it| it.1).collect();
                cuts.push(i64::MIN);
                for cut in cuts {
                    for first in [false, true] {
                        let is_above = |it: &Sample| match place(it) {
                            (0, along) => (along <= cut) == first,
                            (off, _) => off > 0,
                        };
                        let against = samples
                            .iter()
                            .filter(|it| is_above(it) != (it.label == Label::Positive))
                            .count();
                        least = least.min(against).min(count - against);
                    }
                }
            }
        }
        least
    }

    #[test]
    fn no_line_has_fewer_labels_against_it() {
        for seed in 0..300 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let count = rng.random_range(1..14);
            let wrong = [0.0, 0.1, 0.5][seed as usize % 3];
            // On a coarse grid many places are on one line, and some are the same.
            let side = if seed % 2 == 0 { 5 } else { 900_000 };
            let samples = drawn(&mut rng, count, side, wrong);
            let found = Fewest::of(&samples).expect("a line");
            let is_against = |it: &Sample| {
                (found.line.distance(Point2::from(it.site)) > 0.0) != (it.label == Label::Positive)
            };
            let against: Vec<_> = (0..samples.len()).filter(|k| is_against(&samples[*k])).collect();
            assert_eq!(found.disagreeing, against, "seed {seed}");
            assert_eq!(against.len(), fewest_by_pairs(&samples), "seed {seed}");
        }
    }

    #[test]
    fn of_many_labels_hardly_more_disagree_than_must() {
        for seed in 0..6 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let samples = drawn(&mut rng, EXACT + 40, 900_000, [0.0, 0.1][seed as usize % 2]);
            let found = Fewest::of(&samples).expect("a line").disagreeing.len();
            let least = fewest_by_pairs(&samples);
            assert!((least..=least + 1 + least / 10).contains(&found), "{seed}: {found}, {least}");
        }
    }
}
