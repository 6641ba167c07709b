//! How figures of an ensemble spread.

use std::collections::BTreeMap;

use serde::Serialize;

/// What missions came to at each stage, in the order of their fields.
pub(crate) type Stages<C> = BTreeMap<u32, Vec<C>>;

/// The mean of a figure over missions.
pub(crate) fn mean<C>(missions: &[C], figure: impl Fn(&C) -> f64) -> f64 {
    missions.iter().map(figure).sum::<f64>() / missions.len() as f64
}

/// Numbers in rising order.
pub(crate) fn sorted(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<_> = numbers.collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

/// Where the smallest of so many sorted numbers is that at least this share, per cent, do not exceed.
pub(crate) fn rank(percent: usize, of: usize) -> usize {
    (of * percent).div_ceil(100).max(1) - 1
}

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
    /// The spread of a figure over missions, one at least.
    pub(crate) fn of<C>(missions: &[C], figure: impl Fn(&C) -> f64) -> Self {
        let sorted = sorted(missions.iter().map(figure));
        let rank = |percent| sorted[rank(percent, sorted.len())];
        Self { median: rank(50), p90: rank(90), worst: rank(100) }
    }

    /// The same in another unit.
    #[must_use]
    pub fn scaled(self, by: f64) -> Self {
        Self { median: self.median * by, p90: self.p90 * by, worst: self.worst * by }
    }
}
