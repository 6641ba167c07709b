//! A reliability that nobody knows, learnt from the labels.
//!
//! Its distribution is a Beta distribution: two counters, of labels that were true and of labels that were false. A
//! label that comes where a front is known counts as one or the other. One that comes where both are as likely says
//! nothing. Between the two, the distribution after the label is a mixture. It is replaced by the Beta distribution
//! with the same mean and variance.
//!
//! Lines are weighed by the mean at the time of each label. That is an approximation: labels that have come before are
//! not weighed anew.

/// What is known of the reliability: the two counters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Learnt([f32; 2]);

impl Learnt {
    /// Of no label: the parameters of the prior.
    pub(crate) const fn prior(parameters: [f32; 2]) -> Self {
        Self(parameters)
    }

    /// Whether it can be one that labels have led to.
    pub(crate) fn is_valid(self) -> bool {
        let Self([a, b]) = self;
        a > 0.0 && b > 0.0 && a < 1e6 && b < 1e6
    }

    /// The mean.
    pub(crate) fn mean(self) -> f32 {
        let Self([a, b]) = self;
        a / (a + b)
    }

    /// Takes in a label with which this share of the curves agreed before it was read.
    pub(crate) fn count(&mut self, agree: f32) {
        const MOST: f32 = 1e4;
        let Self([a, b]) = *self;
        let n = a + b;
        let (is_true, is_false) = (agree * a, (1.0 - agree) * b);
        let share = is_true / (is_true + is_false);
        let mean = (a + share) / (n + 1.0);
        let square = (a + 1.0) * (a + 2.0 * share) / ((n + 1.0) * (n + 2.0));
        let variance = square - mean * mean;
        if n < MOST && is_true + is_false > 0.0 && variance > 0.0 {
            let n = mean * (1.0 - mean) / variance - 1.0;
            *self = Self([mean * n, (1.0 - mean) * n]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_counts_and_what_is_open_does_not() {
        let mut learnt = Learnt::prior([8.0, 2.0]);
        for (agree, expected) in [(0.5, [8.0, 2.0]), (1.0, [9.0, 2.0]), (0.0, [9.0, 3.0])] {
            learnt.count(agree);
            let off: f32 = learnt.0.iter().zip(expected).map(|(it, is)| (it - is).abs()).sum();
            assert!(off < 1e-3, "{learnt:?}");
        }
    }

    /// By the mixture's density, summed up in double precision.
    #[test]
    fn mean_and_variance_are_those_of_the_mixture() {
        for (a, b, agree) in [(8.0, 2.0, 0.8), (3.0, 1.5, 0.1), (40.0, 20.0, 0.3)] {
            let mut learnt = Learnt::prior([a as f32, b as f32]);
            learnt.count(agree as f32);
            let mut sums = [0.0; 3];
            for k in 0..100_000 {
                let p = (f64::from(k) + 0.5) / 1e5;
                let density = libm::pow(p, a - 1.0) * libm::pow(1.0 - p, b - 1.0);
                let weight = density * (p * agree + (1.0 - p) * (1.0 - agree));
                (0..3)
                    .zip(&mut sums)
                    .for_each(|(n, sum)| *sum += weight * libm::pow(p, f64::from(n)));
            }
            let mean = sums[1] / sums[0];
            let n = mean * (1.0 - mean) / (sums[2] / sums[0] - mean * mean) - 1.0;
            let got = learnt.0.map(f64::from);
            assert!((got[0] - mean * n).abs() < 1e-3 * n, "{a} {b} {agree}: {got:?}");
            assert!((got[1] - (1.0 - mean) * n).abs() < 1e-3 * n, "{a} {b} {agree}: {got:?}");
        }
    }
}
