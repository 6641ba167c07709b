//! What a label tells of a line when labels may be wrong, and positions off.
//!
//! A label is true with probability `p`. Where the true position is spread about the recorded one, with a standard
//! deviation of a third of the tolerance, a line that has the latter `s` metres on its +1 side reads +1 with
//! probability `p Phi(s / sigma) + (1 - p) Phi(-s / sigma)`. All is told as a logarithm, relative to a label that is
//! sure to lie on the likelier side.

use nalgebra::Point2;
use planner_core::belief::sample::{Label, Sample};

/// How far labels and positions can be believed.
#[derive(Debug)]
pub(crate) struct Doubt {
    /// The probability that a label is true, above 1/2 and below 1.
    p: f64,
    blur: Option<Blur>,
}

/// How positions are spread.
#[derive(Clone, Copy, Debug)]
struct Blur {
    /// Standard deviation, metres.
    sigma: f64,
    /// By bins of the distance in deviations, about 0: what the first and the second derivative of the logarithm by the
    /// distance in metres are at most there, whichever the label.
    bounds: [[f64; 2]; BINS],
}

/// Bins of half a deviation, as far as a position is on no side for certain.
const BINS: usize = 28;

/// Places in each at which the bounds are found.
const STEPS: usize = 100;

/// The labels recorded at one position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Votes {
    /// Where.
    pub(crate) at: Point2<f64>,
    /// How many say +1 and may be wrong.
    positive: u32,
    /// How many say -1 and may be wrong.
    negative: u32,
    /// What it is for certain, if that is known.
    pub(crate) certain: Option<Label>,
}

/// A logarithm, and how it changes with the distance, per metre.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Told {
    pub(crate) log: f64,
    pub(crate) slope: f64,
}

/// Beyond so many deviations a position is on its side for certain.
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
    pub(crate) fn new(p: f64, tolerance: Option<f64>) -> Self {
        let mut doubt = Self { p, blur: None };
        let Some(tolerance) = tolerance else { return doubt };
        let sigma = tolerance / 3.0;
        let mut blur = Blur { sigma, bounds: [[0.0; 2]; BINS] };
        doubt.blur = Some(blur);
        let step = 0.5 / STEPS as f64;
        let slope = |k: usize| doubt.label(sigma * (k as f64 * step - FAR)).slope;
        for k in 0..BINS * STEPS {
            let (here, next) = (slope(k), slope(k + 1));
            // The maxima lie between the steps, by less than a hundredth above.
            let found = [1.01 * here.max(next), 1.01 * (next - here).abs() / (step * sigma)];
            // Of the other label it is the mirror image.
            for bin in [k / STEPS, BINS - 1 - k / STEPS] {
                let [steepest, sharpest] = &mut blur.bounds[bin];
                (*steepest, *sharpest) = (steepest.max(found[0]), sharpest.max(found[1]));
            }
        }
        doubt.blur = Some(blur);
        doubt
    }

    /// What a wrong label takes: the logarithm of the odds.
    fn odds(&self) -> f64 {
        libm::log(self.p) - libm::log1p(-self.p)
    }

    /// How far from a line positions tell no side for certain; 0 where they are true.
    pub(crate) fn blurred_within(&self) -> f64 {
        self.blur.map_or(0.0, |blur| FAR * blur.sigma)
    }

    /// Bounds of the first and the second derivative by the distance, for a label of lines so far from it, or nearer or
    /// further by no more than `spread`, metres.
    pub(crate) fn bounds(&self, distance: f64, spread: f64) -> [f64; 2] {
        let Some(Blur { sigma, bounds }) = self.blur else { return [0.0; 2] };
        let bin = |at: f64| ((at / sigma + FAR) * 2.0).clamp(0.0, BINS as f64 - 1.0) as usize;
        let within = &bounds[bin(distance - spread)..=bin(distance + spread)];
        within.iter().fold([0.0; 2], |[a, b]: [f64; 2], it| [a.max(it[0]), b.max(it[1])])
    }

    /// A label +1 of a line that has its position so many metres on its +1 side.
    fn label(&self, distance: f64) -> Told {
        let Some(Blur { sigma, .. }) = self.blur else {
            let log = if distance >= 0.0 { 0.0 } else { -self.odds() };
            return Told { log, slope: 0.0 };
        };
        let t = distance / sigma;
        let gain = 2.0 * self.p - 1.0;
        let chance = 1.0 - self.p + gain * normal_integral(t);
        Told { log: libm::log(chance / self.p), slope: gain * normal_density(t) / (sigma * chance) }
    }

    /// All labels of a position near a line, so many metres on its +1 side.
    pub(crate) fn near(&self, votes: &Votes, distance: f64) -> Told {
        let (plus, minus) = (self.label(distance), self.label(-distance));
        let [positive, negative] = [votes.positive, votes.negative].map(f64::from);
        Told {
            log: positive * plus.log + negative * minus.log,
            slope: positive * plus.slope - negative * minus.slope,
        }
    }

    /// All labels of a position that is on a side of a line for certain.
    pub(crate) fn on(&self, votes: &Votes, side: Label) -> f64 {
        if votes.certain.is_some_and(|certain| certain != side) {
            return f64::NEG_INFINITY;
        }
        let wrong = if side == Label::Positive { votes.negative } else { votes.positive };
        if wrong == 0 { 0.0 } else { -f64::from(wrong) * self.odds() }
    }
}

impl Votes {
    /// How many labels may be wrong.
    pub(crate) fn count(&self) -> f64 {
        f64::from(self.positive) + f64::from(self.negative)
    }

    /// Of samples, some of which are certain by their indices; about a middle. A position whose certain labels differ is
    /// an error that names the second by its index.
    pub(crate) fn of(
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
