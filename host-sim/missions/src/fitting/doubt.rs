//! The weight that a label gives to a line if labels may be wrong and positions off.
//!
//! A label is true with probability `p`. The true position is spread about the recorded one, with a standard deviation
//! of a third of the tolerance. Let a line have the recorded position `s` metres on its +1 side. Then a label +1 has
//! the probability `p Phi(s / sigma) + (1 - p) Phi(-s / sigma)`. The weight is a logarithm, relative to a label that
//! surely lies on the likelier side.

use nalgebra::Point2;
use planner_core::{Label, Sample};

/// How far labels and positions can be believed.
#[derive(Debug)]
pub struct Doubt {
    /// The probability that a label is true, above 1/2 and below 1.
    p: f64,
    blur: Option<Blur>,
}

/// How positions are spread.
#[derive(Debug)]
struct Blur {
    /// Standard deviation, metres.
    sigma: f64,
    /// The weight of a label +1 by the distance in deviations: from -[`FAR`] on, [`NODES`] entries a deviation.
    told: Vec<Told>,
    /// Upper bounds on the first and the second derivative of the logarithm by the distance in metres, for either
    /// label. They are in bins of the distance in deviations, about 0.
    bounds: [[f64; 2]; BINS],
}

/// Bins of half a deviation, over all distances at which the side of a position is uncertain.
const BINS: usize = 28;

/// Places in each at which the bounds are found.
const STEPS: usize = 100;

/// Entries of the table of weights a deviation. Between them the weight is a cubic polynomial, to some 1e-9.
const NODES: f64 = 128.0;

/// The labels recorded at one position.
#[derive(Clone, Copy, Debug)]
pub struct Votes {
    /// Where.
    pub at: Point2<f64>,
    /// How many say +1 and may be wrong.
    positive: u32,
    /// How many say -1 and may be wrong.
    negative: u32,
    /// What it is for certain, if that is known.
    pub certain: Option<Label>,
}

/// A logarithm, and how it changes with the distance, per metre.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told {
    /// The logarithm.
    pub log: f64,
    /// Its derivative.
    pub slope: f64,
}

/// Beyond this many deviations a position is certainly on its side.
const FAR: f64 = BINS as f64 / 4.0;

fn normal_integral(t: f64) -> f64 {
    0.5 * libm::erfc(-t * std::f64::consts::FRAC_1_SQRT_2)
}

fn normal_density(t: f64) -> f64 {
    use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_SQRT_PI};
    0.5 * FRAC_2_SQRT_PI * FRAC_1_SQRT_2 * libm::exp(-0.5 * t * t)
}

impl Doubt {
    /// Labels that are true with a probability, and positions that are off by a tolerance in metres at most, which is
    /// three deviations.
    pub fn new(p: f64, tolerance: Option<f64>) -> Self {
        let Some(tolerance) = tolerance else { return Self { p, blur: None } };
        let sigma = tolerance / 3.0;
        let exactly = |t: f64| blurred_label(p, sigma, t);
        let step = 0.5 / STEPS as f64;
        let slope = |k: usize| exactly(k as f64 * step - FAR).slope;
        let mut bounds = [[0.0; 2]; BINS];
        for k in 0..BINS * STEPS {
            let (here, next) = (slope(k), slope(k + 1));
            // The maxima lie between the steps, by less than a hundredth above.
            let found = [1.01 * here.max(next), 1.01 * (next - here).abs() / (step * sigma)];
            // Of the other label it is the mirror image.
            for bin in [k / STEPS, BINS - 1 - k / STEPS] {
                let [steepest, sharpest]: &mut [f64; 2] = &mut bounds[bin];
                (*steepest, *sharpest) = (steepest.max(found[0]), sharpest.max(found[1]));
            }
        }
        let nodes = (2.0 * FAR * NODES) as usize;
        let told = (0..=nodes).map(|k| exactly(k as f64 / NODES - FAR)).collect();
        Self { p, blur: Some(Blur { sigma, told, bounds }) }
    }

    /// What a wrong label takes: the logarithm of the odds.
    fn odds(&self) -> f64 {
        libm::log(self.p) - libm::log1p(-self.p)
    }

    /// How far from a line the side of a position is uncertain, metres; 0 where positions are exact.
    pub fn blurred_within(&self) -> f64 {
        self.blur.as_ref().map_or(0.0, |blur| FAR * blur.sigma)
    }

    /// Upper bounds on the first and the second derivative by the distance, for any label. They hold for lines at this
    /// distance from the position, give or take `spread`, metres.
    pub fn bounds(&self, distance: f64, spread: f64) -> [f64; 2] {
        let Some(Blur { sigma, bounds, .. }) = &self.blur else { return [0.0; 2] };
        let bin = |at: f64| ((at / sigma + FAR) * 2.0).clamp(0.0, BINS as f64 - 1.0) as usize;
        let within = &bounds[bin(distance - spread)..=bin(distance + spread)];
        within.iter().fold([0.0; 2], |[a, b]: [f64; 2], it| [a.max(it[0]), b.max(it[1])])
    }

    /// The weight of a label +1 whose position is `distance` metres on the +1 side of a line.
    fn label(&self, distance: f64) -> Told {
        match &self.blur {
            None => {
                let log = if distance >= 0.0 { 0.0 } else { -self.odds() };
                Told { log, slope: 0.0 }
            }
            Some(blur) => blur.label(distance),
        }
    }

    /// The weight of all labels of a position that is `distance` metres on the +1 side of a line nearby.
    pub fn near(&self, votes: &Votes, distance: f64) -> Told {
        let mut told = Told::default();
        for (count, side) in [(votes.positive, 1.0), (votes.negative, -1.0)] {
            // Nearly all positions have one label.
            if count > 0 {
                let label = self.label(side * distance);
                told.log += f64::from(count) * label.log;
                told.slope += side * f64::from(count) * label.slope;
            }
        }
        told
    }

    /// The weight of all labels of a position that is certainly on a side of a line.
    pub fn on(&self, votes: &Votes, side: Label) -> f64 {
        if votes.certain.is_some_and(|certain| certain != side) {
            return f64::NEG_INFINITY;
        }
        let wrong = if side == Label::Positive { votes.negative } else { votes.positive };
        if wrong == 0 { 0.0 } else { -f64::from(wrong) * self.odds() }
    }
}

/// The weight of a label +1 whose position is `t` deviations on the +1 side of a line.
fn blurred_label(p: f64, sigma: f64, t: f64) -> Told {
    let gain = 2.0 * p - 1.0;
    let chance = 1.0 - p + gain * normal_integral(t);
    Told { log: libm::log(chance / p), slope: gain * normal_density(t) / (sigma * chance) }
}

impl Blur {
    /// The same from the table, by the distance in metres.
    fn label(&self, distance: f64) -> Told {
        let at = ((distance / self.sigma + FAR) * NODES).clamp(0.0, (self.told.len() - 1) as f64);
        let k = (at as usize).min(self.told.len() - 2);
        let (from, to) = (self.told[k], self.told[k + 1]);
        // Hermite's cubic polynomial through both values and slopes.
        let (u, apart) = (at - k as f64, self.sigma / NODES);
        let (rise, first, last) = (to.log - from.log, apart * from.slope, apart * to.slope);
        let (b, c) = (3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise);
        Told {
            log: from.log + u * (first + u * (b + u * c)),
            slope: (first + u * (2.0 * b + 3.0 * u * c)) / apart,
        }
    }
}

impl Votes {
    /// How many labels may be wrong.
    pub fn count(&self) -> f64 {
        f64::from(self.positive) + f64::from(self.negative)
    }

    /// The labels by position, relative to `middle`. `certain` has the indices of the samples whose labels are certain.
    ///
    /// # Errors
    /// The index of the second of two certain labels of one position that differ.
    pub fn of(
        samples: &[Sample],
        certain: &[usize],
        middle: Point2<f64>,
    ) -> Result<Vec<Self>, usize> {
        let mut order: Vec<usize> = (0..samples.len()).collect();
        order.sort_unstable_by_key(|&index| {
            (samples[index].site.x(), samples[index].site.z(), index)
        });
        let mut is_certain = vec![false; samples.len()];
        for &index in certain {
            is_certain[index] = true;
        }
        let mut all: Vec<Self> = Vec::new();
        let mut last = None;
        for index in order {
            let Sample { site, label } = samples[index];
            if last != Some(site) {
                let at = Point2::<f64>::from(site) - middle.coords;
                all.push(Self { at, positive: 0, negative: 0, certain: None });
                last = Some(site);
            }
            let Some(votes) = all.last_mut() else { continue };
            if !is_certain[index] {
                let count = if label == Label::Positive {
                    &mut votes.positive
                } else {
                    &mut votes.negative
                };
                *count += 1;
            } else if votes.certain.replace(label).is_some_and(|other| other != label) {
                return Err(index);
            }
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_what_a_label_tells_is_as_good_as_the_formula() {
        for (p, tolerance) in [(0.6, 0.3), (0.99, 10.0), (0.999_999, 2.0)] {
            let sigma = tolerance / 3.0;
            let doubt = Doubt::new(p, Some(tolerance));
            // Beyond, a position is on its side for certain.
            for k in -7_000..=7_000 {
                let t = f64::from(k) / 1_000.0;
                let (found, wanted) = (doubt.label(t * sigma), blurred_label(p, sigma, t));
                assert!((found.log - wanted.log).abs() < 1e-7, "{p}: {t}");
                assert!((found.slope - wanted.slope).abs() * sigma < 1e-5, "{p}: {t}");
            }
        }
    }
}
