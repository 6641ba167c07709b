//! Labels that are true with one probability that nobody knows, by brute force: every sequence of labels, and every
//! probability of a fine grid. It shares no code with the planner's counts, weights or logarithms.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use planner_core::{Label, Sample, Site};

use crate::twins::brute;

/// Points of the grid.
const GRID: usize = 4_000;

/// Cells that are thinner than this, in radian metres, are lost in the rounding of the measure.
const LEAST: f64 = 1e-13;

/// The joint distribution of the lines and of `p`.
pub struct Joint {
    /// Probabilities, and what the prior Beta(a, b) weighs each with.
    grid: Vec<[f64; 2]>,
    /// By the sequence of true labels, a bit for each: the samples with these labels, and the weight for each `p`. The
    /// whole has a weight of 1.
    cells: BTreeMap<u64, (Vec<Sample>, Vec<f64>)>,
}

impl Joint {
    /// What the labels leave. `is_certain` says which of them are true for certain. `by_area` weighs lines by their
    /// measure, otherwise all sequences count alike.
    ///
    /// # Panics
    /// When no line is left.
    pub fn of(given: &[Sample], seen: &[(Sample, bool)], [a, b]: [f64; 2], by_area: bool) -> Self {
        // With p = sin^2 of an angle the density has no poles at its ends.
        let angles = (0..GRID).map(|n| (n as f64 + 0.5) / GRID as f64 * FRAC_PI_2);
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
        let mut cells = BTreeMap::new();
        for bits in 0..1_u64 << seen.len() {
            let truth =
                |n: usize| if bits >> n & 1 == 1 { Label::Positive } else { Label::Negative };
            let agrees = |n: usize| truth(n) == seen[n].0.label;
            if (0..seen.len()).any(|n| seen[n].1 && !agrees(n)) {
                continue;
            }
            let labelled = (0..seen.len()).map(|n| Sample { label: truth(n), ..seen[n].0 });
            let samples: Vec<_> = given.iter().copied().chain(labelled).collect();
            let area = brute::measure(&samples);
            if area <= LEAST {
                continue;
            }
            let prior = if by_area { area } else { 1.0 };
            let weight = |[p, density]: [f64; 2]| {
                let doubtful = (0..seen.len()).filter(|&n| !seen[n].1);
                let each = doubtful.map(|n| if agrees(n) { p } else { 1.0 - p });
                prior * density * each.product::<f64>()
            };
            cells.insert(bits, (samples, grid.iter().map(|&it| weight(it)).collect::<Vec<_>>()));
        }
        let total: f64 = cells.values().flat_map(|(_, weights)| weights).sum();
        assert!(total > 0.0, "no line is left");
        for weight in cells.values_mut().flat_map(|(_, it)| it) {
            *weight /= total;
        }
        Self { grid, cells }
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

    /// The chance that a doubtful label at a site is +1.
    pub fn chance(&self, site: Site) -> f64 {
        let of = |(samples, weights): &(Vec<Sample>, Vec<f64>)| -> f64 {
            let with = |label| brute::measure(&[&samples[..], &[Sample { site, label }]].concat());
            let [above, below] = [Label::Positive, Label::Negative].map(with);
            let share = above / (above + below);
            let chance = |p: f64| share * p + (1.0 - share) * (1.0 - p);
            self.grid.iter().zip(weights).map(|([p, _], weight)| chance(*p) * weight).sum()
        };
        self.cells.values().map(of).sum()
    }
}
