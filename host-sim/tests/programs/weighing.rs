//! `replay` where labels may be wrong or positions may be off: its answer is that of lines tried one after the other.

use std::f64::consts::{SQRT_2, TAU};
use std::fs;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use crate::{folder, prints};

const SLOPE: f64 = 0.41;
const INTERCEPT: f64 = 3.5;

/// A place and whether it is labelled +1.
type Row = ([f64; 2], bool);

/// Lines on a grid of angles and offsets, the likeliest first.
struct Tried {
    /// The normal's angle, the offset from the middle of the area, the weight.
    lines: Vec<[f64; 3]>,
    middle: [f64; 2],
    total: f64,
}

impl Tried {
    /// Weighs each line by the logarithms of what each label tells at its distance.
    fn of(rows: &[Row], log: impl Fn(f64, bool) -> f64) -> Self {
        let ends = |k: usize| {
            let values = rows.iter().map(move |(at, _)| at[k]);
            [values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max)]
        };
        let [[x0, x1], [z0, z1]] = [ends(0), ends(1)];
        // The area of the answer: a rectangle around the samples with this margin.
        let margin = 0.1 * (x1 - x0).max(z1 - z0);
        let middle = [x0.midpoint(x1), z0.midpoint(z1)];
        let half = [x1 - middle[0] + margin, z1 - middle[1] + margin];
        let reach = half[0].hypot(half[1]);
        let (angles, offsets) = (2_160, 600);
        let (mut lines, mut most) = (Vec::new(), f64::NEG_INFINITY);
        for i in 0..angles {
            let angle = (f64::from(i) + 0.5) / f64::from(angles) * TAU;
            let (sin, cos) = angle.sin_cos();
            for j in 0..offsets {
                let offset = ((f64::from(j) + 0.5) / f64::from(offsets) * 2.0 - 1.0) * reach;
                if offset.abs() <= half[0] * cos.abs() + half[1] * sin.abs() {
                    // No label adds to the sum: what is far below the most cannot come back.
                    let sum = rows.iter().try_fold(0.0, |sum, ([x, z], label)| {
                        let at = (x - middle[0]) * cos + (z - middle[1]) * sin - offset;
                        Some(sum + log(at, *label)).filter(|sum| *sum > most - 50.0)
                    });
                    if let Some(sum) = sum {
                        most = most.max(sum);
                        lines.push([angle, offset, sum]);
                    }
                }
            }
        }
        lines.sort_by(|a, b| b[2].total_cmp(&a[2]));
        for line in &mut lines {
            line[2] = (line[2] - most).exp();
        }
        let total = lines.iter().map(|it| it[2]).sum();
        Self { lines, middle, total }
    }

    /// Slope and intercept of the mean.
    fn mean(&self) -> [f64; 2] {
        let [a, b, r] = self.lines.iter().fold([0.0; 3], |[a, b, r], [angle, offset, weight]| {
            [a + weight * angle.cos(), b + weight * angle.sin(), r + weight * offset]
        });
        [-a / b, (r + a * self.middle[0]) / b + self.middle[1]]
    }

    /// The slopes of the likeliest lines that hold this share, in degrees, with all that weigh alike; and what they
    /// hold.
    fn credible(&self, share: f64) -> ([f64; 2], f64) {
        let (mut held, mut least, mut span) = (0.0, f64::INFINITY, [f64::INFINITY, -f64::INFINITY]);
        for [angle, _, weight] in &self.lines {
            if *weight == 0.0 || held >= share * self.total && *weight < least * (1.0 - 1e-9) {
                break;
            }
            (held, least) = (held + weight, *weight);
            let degrees = angle.to_degrees() - 90.0;
            span = [span[0].min(degrees), span[1].max(degrees)];
        }
        (span, held / self.total)
    }
}

/// What a label tells that is true with this probability, at a distance that is exact or spread by `sigma`.
fn told(p: f64, sigma: Option<f64>) -> impl Fn(f64, bool) -> f64 {
    move |distance, label| {
        let on_its_side = if label { distance } else { -distance };
        let above = match sigma {
            Some(sigma) => 0.5 * libm::erfc(-on_its_side / sigma / SQRT_2),
            None => f64::from(u8::from(on_its_side > 0.0)),
        };
        (p * above + (1.0 - p) * (1.0 - above)).ln()
    }
}

fn answer(rows: &[Row], flags: &str) -> Value {
    let folder = folder();
    let sign = |label: bool| if label { 1 } else { -1 };
    let lines = rows.iter().map(|([x, z], label)| format!("{x},{z},{}\n", sign(*label)));
    fs::write(folder.path().join("s.csv"), format!("x,z,label\n{}", lines.collect::<String>()))
        .expect("a file");
    let args = format!("replay s.csv --format json {flags}");
    serde_json::from_str(&prints(folder.path(), &args.split(' ').collect::<Vec<_>>()))
        .expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn the_answer_is_that_of_lines_tried_one_after_the_other() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    // How many rows, the share of wrong labels, what is told, and how near the slopes are.
    for (count, wrong, p, tolerance, within) in [
        (60, 0.08, 0.9, None, 0.6),
        (60, 0.08, 0.9, Some(1.5), 0.3),
        (80, 0.0, 1.0, Some(0.8), 0.3),
    ] {
        let rows: Vec<Row> = (0..count)
            .map(|_| {
                let [x, z] = [0; 2].map(|_| rng.random_range(0.0..20.0));
                let label = (z > SLOPE * x + INTERCEPT) != rng.random_bool(wrong);
                let (angle, off) = (rng.random_range(0.0..TAU), rng.random_range(0.0..=1.0));
                let off = if p < 1.0 { 0.0 } else { off * tolerance.unwrap_or(0.0) };
                ([x + off * angle.cos(), z + off * angle.sin()], label)
            })
            .collect();
        let found = answer(&rows, &format!("--p {p} --tolerance {}", tolerance.unwrap_or(0.0)));
        let case = format!("{count} rows, p = {p}, tolerance {tolerance:?}: {found}");
        let near = |found: &Value, wanted: f64, within: f64| {
            assert!((number(found) - wanted).abs() <= within, "{found} is not {wanted}: {case}");
        };
        let tried = match tolerance {
            // Labels are true and positions are within the tolerance: each line is possible or not.
            Some(tolerance) if p >= 1.0 => Tried::of(&rows, |distance, label| {
                let on_its_side = if label { distance } else { -distance };
                if on_its_side >= -tolerance { 0.0 } else { f64::NEG_INFINITY }
            }),
            _ => Tried::of(&rows, told(p, tolerance.map(|it| it / 3.0))),
        };
        let [slope, intercept] = tried.mean();
        near(&found["estimates"]["centre"]["slope"], slope, 0.005);
        near(&found["estimates"]["centre"]["intercept"], intercept, 0.05);
        let (span, held) = tried.credible(if p < 1.0 { 0.9 } else { 1.0 });
        for k in 0..2 {
            near(&found["slope_arcs"][0][k], span[k], within);
        }
        if p < 1.0 {
            near(&found["credible"]["probability"], held, 0.01);
            assert!(found["pruned_mass"].is_null() || number(&found["pruned_mass"]) < 1e-4);
        }
    }
}
