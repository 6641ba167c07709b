//! How many labels disagree with a fitted line, if each label is true with a given probability.
//!
//! *Too many*: the fitted line disagrees with no more labels than the true line does. The true line's count is
//! binomial, so the binomial tail bounds the probability from above.
//!
//! *Too few*: a fitted line adapts to wrong labels, so its count falls below the binomial one. The bound is a sum over
//! all ways in which lines divide the positions. At most `n m` of these differ from the true line's in 1 to `m`
//! positions, for `m` below half of `n` positions (the bound on `m`-sets in the plane). Each label in which they differ
//! disagrees with probability `p` in place of `1 - p`.

/// The probability that `n` labels have `count` disagreeing ones or more, if each disagrees with probability `q`.
pub(crate) fn at_least(n: usize, q: f64, count: usize) -> f64 {
    let (most, least) = (n as f64, count as f64);
    if least <= most * q || q >= 1.0 {
        // At or below the mean: no evidence, and 1 is a bound.
        return 1.0;
    }
    if count > n || q <= 0.0 {
        return 0.0;
    }
    let mut log_ways = 0.0;
    for [number, sign] in [[most, 1.0], [least, -1.0], [most - least, -1.0]] {
        log_ways += sign * libm::lgamma(number + 1.0);
    }
    let first = libm::exp(log_ways + least * libm::log(q) + (most - least) * libm::log1p(-q));
    let (mut term, mut sum) = (1.0, 0.0);
    for k in count..=n {
        sum += term;
        term *= (n - k) as f64 / (k + 1) as f64 * q / (1.0 - q);
        if term < 1e-17 * sum {
            break;
        }
    }
    (first * sum).min(1.0)
}

/// A bound on the probability that some line disagrees with `count` of `n` labels or fewer, if each label disagrees
/// with the true line with probability `q` or more. `blurred`: only labels beyond a tolerance from the line count.
pub(crate) fn fitted_at_most(n: usize, q: f64, count: usize, blurred: bool) -> f64 {
    let (all, least) = (n as f64, count as f64);
    if n == 0 || least >= all * q {
        return 1.0;
    }
    // Chernoff's bound for the true line: the minimum over `s` of `s^-count (1 - q + q s)^n`.
    let s = least * (1.0 - q) / ((all - least) * q);
    let power = if count == 0 { 0.0 } else { -least * libm::log(s) };
    let base = libm::exp(power + all * libm::log(1.0 - q + q * s));
    if blurred {
        // Two borders for each position, so up to twice as many of them divide the lines.
        return (base * (4.0 * all * all + 2.0)).min(1.0);
    }
    // Each label that the fitted line has on the other side multiplies the bound by this.
    let ratio = (q + (1.0 - q) * s) / (1.0 - q + q * s);
    let near = 1.0 + all * ratio / (1.0 - ratio);
    let far = (0.5 * all * all + 2.0) * libm::pow(ratio, 0.5 * all);
    (base * (near + far)).min(1.0)
}

/// A bound on the probability of `run` disagreeing labels side by side or more, among `n` labels in any order of which
/// `disagreeing` disagree. It is the expected number of such runs, by `n` for the line that is fitted.
pub(crate) fn run_at_least(n: usize, disagreeing: usize, run: usize) -> f64 {
    if run == 0 || run > disagreeing {
        return 1.0;
    }
    let of = |k: usize| (disagreeing - k) as f64 / (n - k) as f64;
    let chance: f64 = (0..run).map(of).map(libm::log).sum();
    let places = (n - disagreeing + 1) as f64 * n as f64;
    libm::exp(chance + libm::log(places)).min(1.0)
}

/// The counts of disagreeing labels that are neither too many nor too few at a level each, of `n` labels. A label
/// disagrees with probability `q[0]` at least and `q[1]` at most.
pub(crate) fn expected(n: usize, q: [f64; 2], blurred: bool, level: f64) -> [usize; 2] {
    let first = |holds: &dyn Fn(usize) -> bool| {
        // The first count that holds; each after it holds as well, and so does `n`.
        let (mut low, mut high) = (0, n);
        while low < high {
            let middle = low.midpoint(high);
            if holds(middle) {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        high
    };
    let low = first(&|count| fitted_at_most(n, q[0], count, blurred) > level);
    let beyond = first(&|count| count == n || at_least(n, q[1], count + 1) <= level);
    [low, beyond]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ways(n: usize, k: usize) -> f64 {
        (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product()
    }

    #[test]
    fn the_tail_is_the_sum_of_the_binomial_terms() {
        for (n, q) in [(1, 0.3_f64), (12, 0.05), (40, 0.2), (100, 0.45)] {
            let term = |k: usize| ways(n, k) * q.powi(k as i32) * (1.0 - q).powi((n - k) as i32);
            for count in 0..=n {
                let wanted: f64 = (count..=n).map(term).sum();
                let found = at_least(n, q, count);
                if count as f64 > n as f64 * q {
                    assert!((found - wanted).abs() < 1e-9 * wanted, "{n} {q} {count}");
                } else {
                    assert!(found >= wanted - 1e-12);
                }
                // The bound for a fitted line is above the tail of the true one.
                let below: f64 = (0..=count).map(term).sum();
                assert!(fitted_at_most(n, q, count, false) >= below.min(1.0) - 1e-12);
            }
        }
    }

    #[test]
    fn the_bound_on_runs_is_above_the_share_of_orders_with_one() {
        // All orders of 3 to 6 disagreeing labels among 12.
        for disagreeing in 3..=6_u32 {
            let orders = (0..1_u32 << 12).filter(|it| it.count_ones() == disagreeing);
            for run in 1..=disagreeing as usize {
                let has =
                    |it: &u32| (0..12).any(|at| (it >> at) & ((1 << run) - 1) == (1 << run) - 1);
                let share =
                    orders.clone().filter(has).count() as f64 / orders.clone().count() as f64;
                assert!(run_at_least(12, disagreeing as usize, run) >= share.min(1.0));
            }
        }
    }

    #[test]
    fn counts_outside_of_what_is_expected_have_the_level() {
        for (n, q) in [(240, 0.05), (60, 0.3), (5, 0.05), (1_000_000, 0.1)] {
            let [low, high] = expected(n, [q; 2], false, 0.002);
            assert!(low <= high && (low as f64) < n as f64 * q && high as f64 >= n as f64 * q);
            assert!(low == 0 || fitted_at_most(n, q, low - 1, false) <= 0.002);
            assert!(fitted_at_most(n, q, low, false) > 0.002);
            assert!(high == n || at_least(n, q, high + 1) <= 0.002);
            assert!(at_least(n, q, high) > 0.002);
        }
    }
}
