//! Labels that may be wrong, by brute force: every sequence of true labels, and every value of a probability that nobody
//! knows, on a fine grid. It shares no code with the planner's counts, weights or logarithms.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use planner_core::{Label, Sample, Site};

use crate::twins::brute;

/// Points of the grid.
const GRID: usize = 4_000;

/// Cells that are thinner than this, in radian metres, are lost in the rounding of the measure.
const LEAST: f64 = 1e-13;

/// A label and how probably it is true; `None` if nobody knows.
pub type Doubtful = (Sample, Option<f64>);

/// The joint distribution of the lines and of the probability `p` that nobody knows.
pub struct Joint {
    /// Probabilities, and what the prior Beta(a, b) weighs each with.
    grid: Vec<[f64; 2]>,
    /// By the sequence of true labels, a bit for each: the samples with these labels, and the weight for each `p`. The
    /// whole has a weight of 1.
    cells: BTreeMap<u64, (Vec<Sample>, Vec<f64>)>,
}

impl Joint {
    /// What the labels leave. `by_area` weighs lines by their measure, otherwise all sequences count alike.
    ///
    /// # Panics
    /// When no line is left.
    pub fn of(given: &[Sample], seen: &[Doubtful], [a, b]: [f64; 2], by_area: bool) -> Self {
        // With p = sin^2 of an angle the density has no poles at its ends.
        let points = if seen.iter().any(|it| it.1.is_none()) { GRID } else { 1 };
        let angles = (0..points).map(|n| (n as f64 + 0.5) / points as f64 * FRAC_PI_2);
        let grid = angles.map(|angle| {
            let (sin, cos) = angle.sin_cos();
            let log = (2.0 * a - 1.0) * sin.ln() + (2.0 * b - 1.0) * cos.ln();
            [sin * sin, log]
        });
        let mut grid: Vec<_> = grid.collect();
        let most = grid.iter().map(|it| it[1]).fold(f64::NEG_INFINITY, f64::max);
        for it in &mut grid {
            it[1] = (it[1] - most).exp();
        }
        // A sequence has no more lines than its beginning: where that has none, it is left out.
        let mut begun = vec![(0_u64, given.to_vec(), 0.0, [0; 2], brute::measure(given))];
        for (n, (seen, known)) in seen.iter().enumerate() {
            let mut longer = Vec::new();
            for (bits, samples, log, counts, _) in &begun {
                for (bit, label) in [Label::Negative, Label::Positive].into_iter().enumerate() {
                    let agrees = label == seen.label;
                    // In logarithms, as labels can be all but certain.
                    let log = log
                        + match known {
                            Some(p) if agrees => p.ln(),
                            Some(p) => (-p).ln_1p(),
                            None => 0.0,
                        };
                    let mut counts: [i32; 2] = *counts;
                    counts[usize::from(!agrees)] += i32::from(known.is_none());
                    let samples = [&samples[..], &[Sample { label, ..*seen }]].concat();
                    let area = if log.is_finite() { brute::measure(&samples) } else { 0.0 };
                    if area > LEAST {
                        longer.push((bits | (bit as u64) << n, samples, log, counts, area));
                    }
                }
            }
            begun = longer;
        }
        let weigh = |(bits, samples, log, [right, wrong], area): (_, _, f64, [i32; 2], f64)| {
            let log = log + if by_area { area.ln() } else { 0.0 };
            let each = grid.iter();
            let weights = each.map(|[p, it]| it * p.powi(right) * (1.0 - p).powi(wrong));
            (bits, samples, log, weights.collect::<Vec<_>>())
        };
        let mut sequences: Vec<(u64, Vec<Sample>, f64, Vec<f64>)> =
            begun.into_iter().map(weigh).collect();
        let most = sequences.iter().map(|it| it.2).fold(f64::NEG_INFINITY, f64::max);
        let mut total = 0.0;
        for (_, _, log, weights) in &mut sequences {
            for weight in weights {
                *weight *= (*log - most).exp();
                total += *weight;
            }
        }
        assert!(total > 0.0, "no line is left");
        let cells = sequences.into_iter().map(|(bits, samples, _, mut weights)| {
            for it in &mut weights {
                *it /= total;
            }
            (bits, (samples, weights))
        });
        Self { grid, cells: cells.collect() }
    }

    /// The probability of each sequence.
    pub fn sequences(&self) -> BTreeMap<u64, f64> {
        self.cells.iter().map(|(&bits, (_, weights))| (bits, weights.iter().sum())).collect()
    }

    /// The mean and the standard deviation of `p`.
    pub fn p(&self) -> [f64; 2] {
        let moment = |power: i32| -> f64 {
            let of = |weights: &[f64]| -> f64 {
                self.grid.iter().zip(weights).map(|([p, _], weight)| p.powi(power) * weight).sum()
            };
            self.cells.values().map(|(_, weights)| of(weights)).sum()
        };
        let mean = moment(1);
        [mean, (moment(2) - mean * mean).sqrt()]
    }

    /// The chance that a label at a site is +1, which is true with a probability; with the unknown one, if it is `None`.
    pub fn chance(&self, site: Site, known: Option<f64>) -> f64 {
        let of = |(samples, weights): &(Vec<Sample>, Vec<f64>)| -> f64 {
            let with = |label| brute::measure(&[&samples[..], &[Sample { site, label }]].concat());
            let [above, below] = [Label::Positive, Label::Negative].map(with);
            let share = above / (above + below);
            let chance = |p: f64| share * p + (1.0 - share) * (1.0 - p);
            let each = self.grid.iter().zip(weights);
            each.map(|([p, _], weight)| chance(known.unwrap_or(*p)) * weight).sum()
        };
        self.cells.values().map(of).sum()
    }
}
