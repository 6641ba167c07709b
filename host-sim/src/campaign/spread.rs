//! How figures of an ensemble spread.

use serde::Serialize;

/// Median, 90th percentile and worst.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Half are at most this.
    pub median: f64,
    /// Nine in ten are at most this.
    pub p90: f64,
    /// The largest.
    pub worst: f64,
}

impl Spread {
    /// Of at least one value.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<_> = values.collect();
        values.sort_by(f64::total_cmp);
        // Nearest rank: the smallest value that at least this share do not exceed.
        let rank = |tenths: usize| values[(values.len() * tenths).div_ceil(10).max(1) - 1];
        Self { median: rank(5), p90: rank(9), worst: rank(10) }
    }

    /// The same in another unit.
    #[must_use]
    pub fn scaled(self, by: f64) -> Self {
        Self { median: self.median * by, p90: self.p90 * by, worst: self.worst * by }
    }
}
