//! The probability with which a field's labels are true, drawn from a Beta prior, and the mean over such a prior.

use planner_core::UnknownReliability;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The stream of a mission's seed from which `p` is drawn. Faults of its sensor have those from 3 on, one each.
const STREAM: u64 = u64::MAX;

/// The `p` of the mission with this seed.
pub fn p(prior: UnknownReliability, seed: u64) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(STREAM);
    let [a, b] = prior.parameters().map(|shape| gamma(&mut rng, shape));
    a / (a + b)
}

/// A number with the gamma distribution of this shape (Marsaglia and Tsang, 2000).
fn gamma(rng: &mut ChaCha8Rng, shape: f64) -> f64 {
    if shape < 1.0 {
        let more = gamma(rng, shape + 1.0);
        return more * libm::pow(1.0 - rng.random_range(0.0..1.0), 1.0 / shape);
    }
    let d = shape - 1.0 / 3.0;
    let c = 1.0 / libm::sqrt(9.0 * d);
    loop {
        let x = normal(rng);
        let v = libm::pow(1.0 + c * x, 3.0);
        let u: f64 = 1.0 - rng.random_range(0.0..1.0);
        if v > 0.0 && libm::log(u) < 0.5 * x * x + d - d * v + d * libm::log(v) {
            return d * v;
        }
    }
}

/// A number with the standard normal distribution.
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - rng.random_range(0.0..1.0)));
    radius * libm::cos(std::f64::consts::TAU * rng.random_range(0.0..1.0))
}

/// The mean of a function of `p` over a prior, by a sum over 2,000 probabilities.
pub fn mean(prior: UnknownReliability, of: impl Fn(f64) -> f64) -> f64 {
    const POINTS: u32 = 2_000;
    let [a, b] = prior.parameters();
    // With p = sin^2 of an angle the density is bounded. The logarithm is relative to about its maximum.
    let log = |p: f64| (a - 0.5) * libm::log(p) + (b - 0.5) * libm::log1p(-p);
    let most = log(prior.mean());
    let angles =
        (0..POINTS).map(|n| std::f64::consts::FRAC_PI_2 * (f64::from(n) + 0.5) / f64::from(POINTS));
    let weighed = angles.map(|angle| {
        let sin = libm::sin(angle);
        let p = sin * sin;
        (libm::exp(log(p) - most), p)
    });
    let (total, sum) = weighed
        .fold((0.0, 0.0), |(total, sum), (weight, p)| (total + weight, sum + weight * of(p)));
    sum / total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_has_the_moments_of_the_prior() {
        for (a, b) in [(8.0, 2.0), (1.5, 0.5), (1000.0, 10.0)] {
            let prior = UnknownReliability::beta(a, b).expect("a prior");
            let mean_is = a / (a + b);
            let variance_is = a * b / ((a + b) * (a + b) * (a + b + 1.0));
            let drawn: Vec<_> = (0..40_000).map(|seed| p(prior, seed)).collect();
            let mean_got = drawn.iter().sum::<f64>() / 4e4;
            let variance = drawn.iter().map(|p| (p - mean_is) * (p - mean_is)).sum::<f64>() / 4e4;
            assert!((mean_got - mean_is).abs() < 4.0 * (variance_is / 4e4).sqrt(), "{a} {b}");
            assert!((variance / variance_is - 1.0).abs() < 0.05, "{a} {b}: {variance}");
            assert!((mean(prior, |p| p) - mean_is).abs() < 1e-6, "{a} {b}");
            let square = mean(prior, |p| (p - mean_is) * (p - mean_is));
            assert!((square / variance_is - 1.0).abs() < 1e-4, "{a} {b}: {square}");
        }
    }
}
