//! A search by halves.

/// The greatest count that holds. None of the counts after it holds. 0 does, and `bad` does not.
pub(crate) fn last_good(mut bad: usize, holds: impl Fn(usize) -> bool) -> usize {
    let mut good = 0;
    while bad - good > 1 {
        let middle = good.midpoint(bad);
        *(if holds(middle) { &mut good } else { &mut bad }) = middle;
    }
    good
}
