//! Slow twins: the same answers by other means, for tests to compare.

pub mod brute;
pub mod exact_mean;
pub mod joint;
pub mod ladder;
pub mod probit;
