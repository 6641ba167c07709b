//! What a sum of Gaussians says of the front at a place.

use crate::belief::curve::gaussian::Offset;
use crate::belief::curve::normal::Normal;
use crate::geometry::approximate::{inverse_sqrt, sqrt};

/// A Gaussian of less weight says nothing.
const FAINT: f32 = 5e-4;

/// A share is found to within this, in so many iterations at most.
const NEAR: f32 = 1e-3;
const ITERATIONS: u32 = 14;

/// A half-width is about so many deviations.
const FIRST: f32 = 1.6;

/// One of them: its inverse deviation beside its variance.
#[derive(Clone, Copy, Debug)]
struct Bell {
    weight: f32,
    mean: f32,
    variance: f32,
    per: f32,
}

/// The offsets at one place. Weights make 1 together.
#[derive(Clone, Debug)]
pub(crate) struct Mixture<const N: usize> {
    bells: heapless::Vec<Bell, N, u8>,
    mean: f32,
    deviation: f32,
}

impl<const N: usize> Mixture<N> {
    /// With a variance that is added to each.
    pub(crate) fn of(offsets: impl Iterator<Item = Offset>, blur: f32) -> Self {
        let mut bells = heapless::Vec::<Bell, N, u8>::new();
        let (mut whole, mut mean) = (0.0, 0.0);
        for it in offsets.filter(|it| it.weight > FAINT) {
            let variance = it.variance + blur;
            let bell =
                Bell { weight: it.weight, mean: it.mean, variance, per: inverse_sqrt(variance) };
            if bells.push(bell).is_ok() {
                whole += it.weight;
                mean += it.weight * it.mean;
            }
        }
        let each = if whole > 0.0 { 1.0 / whole } else { 1.0 };
        let mean = mean * each;
        let mut square = 0.0;
        for it in &mut bells {
            it.weight *= each;
            square += it.weight * (it.variance + (it.mean - mean) * (it.mean - mean));
        }
        Self { bells, mean, deviation: sqrt(square) }
    }

    /// The mean place.
    pub(crate) const fn mean(&self) -> f32 {
        self.mean
    }

    /// The standard deviation.
    pub(crate) const fn deviation(&self) -> f32 {
        self.deviation
    }

    /// How much lies below a place, and the density there.
    #[inline(never)] // it is called in many places
    fn at(&self, left: f32) -> [f32; 2] {
        let mut sums = [0.0; 2];
        for it in &self.bells {
            let Normal { below, hazard } = Normal::at((left - it.mean) * it.per);
            sums[0] += it.weight * below;
            sums[1] += it.weight * it.per * hazard * below;
        }
        sums
    }

    /// How much lies below a place.
    pub(crate) fn below(&self, left: f32) -> f32 {
        self.at(left)[0]
    }

    /// The mean distance of each Gaussian from a place.
    pub(crate) fn distance(&self, from: f32) -> f32 {
        let off = |it: &Bell| it.weight * sqrt(it.variance + (it.mean - from) * (it.mean - from));
        self.bells.iter().map(off).sum()
    }

    /// Half of it lies below this place.
    pub(crate) fn median(&self) -> f32 {
        let reach = 4.0 * self.deviation;
        let within = [self.mean - reach, self.mean + reach];
        found(within, self.mean, |place| {
            let [below, density] = self.at(place);
            [below - 0.5, density]
        })
    }

    /// So far on either side of a place lies this share.
    pub(crate) fn half_width(&self, about: f32, share: f32) -> f32 {
        let most = 4.0 * self.deviation + (self.mean - about).abs();
        found([0.0, most], FIRST * self.deviation, |half| {
            let ([above, left], [below, right]) = (self.at(about + half), self.at(about - half));
            [above - below - share, left + right]
        })
    }
}

/// Where a function that rises is 0, by Newton's method from a first place; by halves where that leads out of the bounds.
fn found([mut low, mut high]: [f32; 2], first: f32, of: impl Fn(f32) -> [f32; 2]) -> f32 {
    let mut at = first;
    for _ in 0..ITERATIONS {
        let [off, slope] = of(at);
        if off.abs() < NEAR {
            break;
        }
        if off < 0.0 {
            low = at;
        } else {
            high = at;
        }
        let next = at - off / slope;
        at = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;

    /// Against ten thousand steps.
    #[test]
    fn shares_are_those_of_small_steps() {
        for seed in 0..40 {
            let mut draws = Draws::new(seed);
            let mut unit = || draws.unit() as f32;
            let mut offsets = [Offset { weight: 0.0, mean: 0.0, variance: 1.0 }; 15];
            for it in &mut offsets {
                let variance = 0.001 + unit() * unit();
                *it = Offset { weight: unit() * unit() / 5.0, mean: 4.0 * unit() - 2.0, variance };
            }
            let mixture = Mixture::<15>::of(offsets.into_iter(), 0.0);
            let whole: f64 = offsets.iter().map(|it| f64::from(it.weight)).sum();
            let below = |x: f64| -> f64 {
                let of = |it: &Offset| {
                    let u = (x - f64::from(it.mean)) / f64::from(it.variance).sqrt();
                    f64::from(it.weight) / whole * 0.5 * libm::erfc(-u / 2.0_f64.sqrt())
                };
                offsets.iter().map(of).sum()
            };
            let median = f64::from(mixture.median());
            assert!((below(median) - 0.5).abs() < 5e-3, "{seed}: {median}");
            let half = f64::from(mixture.half_width(mixture.mean(), 0.9));
            let mean = f64::from(mixture.mean());
            let share = below(mean + half) - below(mean - half);
            assert!((share - 0.9).abs() < 5e-3, "{seed}: {half}, {share}");
            assert!((f64::from(mixture.below(0.3)) - below(f64::from(0.3_f32))).abs() < 5e-3);
        }
    }
}
