//! How figures of an ensemble spread.

use anyhow::{Context as _, Result};
use serde::Serialize;

use crate::campaign::sorting::Sorted;

/// Median, 90th percentile and worst.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Half are at most this.
    pub median: f64,
    /// Nine in ten are at most this.
    pub p90: f64,
    /// The largest.
    pub worst: f64,
}

impl Spread {
    /// The spread of the next `n` values, at least one.
    pub(crate) fn of(values: &mut Sorted, n: u64) -> Result<Self> {
        // Nearest rank: the smallest value that at least this share do not exceed.
        let ranks = [5, 9, 10].map(|tenths| (n * tenths).div_ceil(10).max(1));
        let mut spread = [0.0; 3];
        for rank in 1..=n {
            let value = values.next().context("a value is missing")?.number;
            for (figure, of) in spread.iter_mut().zip(ranks) {
                if rank == of {
                    *figure = value;
                }
            }
        }
        let [median, p90, worst] = spread;
        Ok(Self { median, p90, worst })
    }

    /// The same in another unit.
    #[must_use]
    pub fn scaled(self, by: f64) -> Self {
        Self { median: self.median * by, p90: self.p90 * by, worst: self.worst * by }
    }
}
