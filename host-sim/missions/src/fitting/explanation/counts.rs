//! How many labels disagree with a fitted line, if each label is true with a given probability.

/// A count is out of what is expected, to either side, with this probability at most.
const LEVEL: f64 = 0.001;

/// The least and the most of `n` labels that are expected to disagree with a straight line that is fitted to them. A label
/// disagrees with the true line with probability `q[0]` at least and `q[1]` at most.
///
/// The fitted line disagrees with no more labels than the true one, whose count is binomial. How few they may be is a sum
/// over all lines: positions divide these into `4 n^2 + 2` sets at most, also where only labels beyond a tolerance count.
pub(super) fn expected(n: usize, q: [f64; 2]) -> [usize; 2] {
    let all = n as f64;
    let chance = |count: usize, q: f64| {
        let count = count as f64;
        let [a, b, c] = [all, count, all - count].map(|it| libm::lgamma(it + 1.0));
        libm::exp(a - b - c + count * libm::log(q) + (all - count) * libm::log1p(-q))
    };
    // So many counts at an end are out of what is expected.
    let out = |counts: &mut dyn Iterator<Item = usize>, q: f64, level: f64| {
        let mut sum = 0.0;
        let sums = counts.map(|count| {
            sum += chance(count, q);
            sum
        });
        sums.take_while(|sum| *sum <= level).count()
    };
    let few = out(&mut (0..n), q[0], LEVEL / (4.0 * all * all + 2.0));
    [few, n - out(&mut (1..=n).rev(), q[1], LEVEL)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_that_are_not_expected_are_rare() {
        for (n, q) in [(3, 0.1_f64), (12, 0.05), (60, 0.3), (240, 0.2)] {
            let ways = |k: usize| (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product::<f64>();
            let term = |k: usize| ways(k) * q.powi(k as i32) * (1.0 - q).powi((n - k) as i32);
            let lines = 4.0 * (n * n) as f64 + 2.0;
            let [low, high] = expected(n, [q; 2]);
            let few = |count: usize| lines * (0..count).map(term).sum::<f64>();
            let many = |count: usize| (count..=n).map(term).sum::<f64>();
            assert!(few(low) <= LEVEL && LEVEL < few(low + 1), "{n}, {q}: {low}");
            assert!(many(high + 1) <= LEVEL && LEVEL < many(high), "{n}, {q}: {high}");
        }
    }
}
