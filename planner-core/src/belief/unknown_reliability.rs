//! A reliability that nobody knows: a prior for the probability that a label is true.
//!
//! All doubtful labels share one unknown probability `p` with the prior Beta(a, b). Then the sum over `p` has a closed
//! form. If `k` of `t` labels agree with a line, and `d = t - k` do not, the labels have the likelihood
//!
//! ```text
//! B(a + k, b + d) / B(a, b) = product of (a + i) (b + j) / (a + b + m),   i < k, j < d, m < t
//! ```
//!
//! A line's weight so depends on its counts alone. The next label agrees with the line with probability
//! `(a + k) / (a + b + t)`, and the distribution of `p` for that line is Beta(a + k, b + d).
//!
//! `a` and `b` are whole thousandths, so each factor is a quotient of two integers. The logarithm of one is off by
//! 1.2 10^-10 at most, that of 128 labels by 1.5 10^-8.

use crate::belief::weight::LogWeight;
use crate::geometry::value::ValueError;

/// The prior of a reliability that nobody knows, Beta(a, b): as if `a` true labels and `b` false ones had been seen.
///
/// It weighs every separable sequence of labels by all probabilities `p` at once. So it is right on average over this
/// prior, and it learns `p` from the labels. For a single `p` in the tail of the prior, stated probabilities are off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UnknownReliability {
    /// In thousandths.
    a: u32,
    /// In thousandths.
    b: u32,
}

const PARAMETER: ValueError =
    ValueError("the parameters of a Beta prior are numbers from 0.5 to 1000");

const MEAN: ValueError =
    ValueError("the mean of a Beta prior, a / (a + b), is above one half: a is more than b");

/// Thousandths in 1.
const ONE: u32 = 1_000;

impl UnknownReliability {
    /// No prior: memory for one. All zeros.
    pub(crate) const NONE: Self = Self { a: 0, b: 0 };

    /// The prior Beta(a, b) of the probability that a label is true, its parameters to the nearest thousandth. Its mean
    /// is `a / (a + b)`. Beta(8, 2) has the mean 0.8 and the standard deviation 0.12.
    ///
    /// # Errors
    /// [`ValueError`] unless both are from 0.5 to 1,000, and the mean is above one half. With a mean of one half, lines
    /// would be as likely with their sides exchanged.
    pub fn beta(a: f64, b: f64) -> Result<Self, ValueError> {
        let thousandths = |it: f64| {
            let inside = (0.5..=1_000.0).contains(&it);
            inside.then_some(libm::round(it * f64::from(ONE)) as u32).ok_or(PARAMETER)
        };
        let [a, b] = [thousandths(a)?, thousandths(b)?];
        if a > b { Ok(Self { a, b }) } else { Err(MEAN) }
    }

    /// The parameters a and b.
    pub fn parameters(self) -> [f64; 2] {
        [self.a, self.b].map(|it| f64::from(it) / f64::from(ONE))
    }

    /// The mean of the prior.
    pub fn mean(self) -> f64 {
        self.agrees(Counts::default())
    }

    /// The chance that the next label agrees with a line of these counts: the mean of `p` for that line.
    pub(crate) fn agrees(self, counts: Counts) -> f64 {
        let [a, b] = self.after(counts);
        f64::from(a) / f64::from(a + b)
    }

    /// The mean of `p^2` for a line of these counts.
    pub(crate) fn square(self, counts: Counts) -> f64 {
        let [a, b] = self.after(counts);
        self.agrees(counts) * f64::from(a + ONE) / f64::from(a + b + ONE)
    }

    /// The logarithms of the chances that the next label agrees with a line of these counts, and that it does not.
    pub(crate) fn weights(self, counts: Counts) -> [LogWeight; 2] {
        let [a, b] = self.after(counts);
        [a, b].map(|it| logarithm(it, a + b))
    }

    /// The logarithms of the likelihoods of so many labels for lines with which 0, 1 and so on of them agree, up to all. They
    /// are relative to the first.
    pub(crate) fn likelihoods(self, labels: u8, mut each: impl FnMut(LogWeight)) {
        let mut sum = LogWeight::ZERO;
        each(sum);
        for agree in 0..labels {
            let [a, b] =
                [self.a + ONE * u32::from(agree), self.b + ONE * u32::from(labels - agree - 1)];
            sum = sum + logarithm(a, b);
            each(sum);
        }
    }

    /// An upper bound on the logarithm of the chance of the next label, whichever it is, for all lines of which at least
    /// so many of some labels agree and do not agree.
    pub(crate) fn most(self, labels: u8, [agree, disagree]: [u8; 2]) -> LogWeight {
        let bound = |disagree| self.after(Counts { labels, disagree });
        let [[a, _], [_, b]] = [bound(disagree), bound(labels.saturating_sub(agree))];
        let [c, d] = self.after(Counts { labels, disagree: 0 });
        logarithm(a.max(b), c + d)
    }

    /// The parameters of the distribution of `p` for a line of these counts, in thousandths.
    fn after(self, Counts { labels, disagree }: Counts) -> [u32; 2] {
        let agree = labels.saturating_sub(disagree);
        [self.a + ONE * u32::from(agree), self.b + ONE * u32::from(disagree)]
    }
}

fn logarithm(part: u32, whole: u32) -> LogWeight {
    LogWeight::from_log(libm::log(f64::from(part) / f64::from(whole)))
}

/// How many doubtful labels there are, and with how many of them a line disagrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) labels: u8,
    pub(crate) disagree: u8,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weight_of_counts_is_a_quotient_of_beta_functions() {
        let log_beta = |a: f64, b: f64| libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b);
        for (a, b) in [(8.0, 2.0), (0.75, 0.5), (1000.0, 250.0), (1.001, 1.0)] {
            let prior = UnknownReliability::beta(a, b).unwrap();
            assert_eq!(prior.parameters().map(f64::to_bits), [a, b].map(f64::to_bits));
            for last in 0..=128_u8 {
                // In any order: here those that agree come first, or last.
                for agrees_first in [true, false] {
                    let (mut weight, mut counts) = (LogWeight::ZERO, Counts::default());
                    for n in 0..128 {
                        let agrees = (n < last) == agrees_first;
                        weight = weight + prior.weights(counts)[usize::from(!agrees)];
                        counts.labels += 1;
                        counts.disagree += u8::from(!agrees);
                    }
                    let d = f64::from(counts.disagree);
                    let exact = log_beta(a + 128.0 - d, b + d) - log_beta(a, b);
                    // The twin's own functions are good to 10^-15 of 6,000.
                    assert!((weight.value() - exact).abs() < 3e-8, "{a} {b} {d}");
                }
            }
        }
    }

    #[test]
    fn likelihoods_are_those_of_label_after_label() {
        let prior = UnknownReliability::beta(8.0, 2.5).unwrap();
        for labels in [0, 1, 7, 124] {
            let mut all = heapless::Vec::<_, 128>::new();
            prior.likelihoods(labels, |it| all.push(it).unwrap());
            assert_eq!(all.len(), usize::from(labels) + 1);
            let of = |agree: u8| {
                let step = |sum, n| {
                    let counts = Counts { labels: n, disagree: n.saturating_sub(agree) };
                    sum + prior.weights(counts)[usize::from(n >= agree)]
                };
                (0..labels).fold(LogWeight::ZERO, step)
            };
            for (agree, got) in (0..=labels).zip(all) {
                let off = got.value() - (of(agree) - of(0)).value();
                assert!(off.abs() < 1e-7, "{agree} of {labels}: {off}");
            }
        }
    }

    #[test]
    fn the_bound_is_that_of_the_worst_line() {
        let prior = UnknownReliability::beta(4.0, 1.5).unwrap();
        for labels in 0..20_u8 {
            for (agree, disagree) in
                (0..=labels).flat_map(|k| (0..=labels - k).map(move |d| (k, d)))
            {
                let lines = (disagree..=labels - agree).map(|it| Counts { labels, disagree: it });
                let most = lines.flat_map(|counts| prior.weights(counts)).max().unwrap();
                assert_eq!(prior.most(labels, [agree, disagree]), most);
            }
        }
    }

    #[test]
    fn what_is_no_prior_is_refused() {
        for (a, b) in
            [(0.4, 0.4), (f64::NAN, 1.0), (8.0, -2.0), (1001.0, 2.0), (f64::INFINITY, 1.0)]
        {
            assert_eq!(UnknownReliability::beta(a, b), Err(PARAMETER));
        }
        for (a, b) in [(2.0, 8.0), (5.0, 5.0), (5.000_1, 5.0)] {
            assert_eq!(UnknownReliability::beta(a, b), Err(MEAN));
        }
    }
}
