//! Ensembles of missions: flown on all processors, with figures that are compared with their bounds.

use std::fmt::{Debug, Display};
use std::ops::RangeBounds;

use host_sim::mission::definition::Mission;
use host_sim::world::noise::{Extent, NoiseModel};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// What the missions with these numbers come to, in order.
pub fn fly<T: Send>(count: u64, one: impl Fn(u64) -> T + Sync + Send) -> Vec<T> {
    (0..count).into_par_iter().map(one).collect()
}

/// The same without the missions that return nothing.
pub fn fly_some<T: Send>(count: u64, one: impl Fn(u64) -> Option<T> + Sync + Send) -> Vec<T> {
    (0..count).into_par_iter().filter_map(one).collect()
}

/// The random numbers of the mission with this number.
pub fn rng(seed: u64, number: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}

/// The mission with labels that are true with probability `p` outside balls about the given points, `radius` metres.
pub fn noisy(mission: Mission, p: f64, radius: f64) -> Mission {
    Mission { noise: Some(NoiseModel { p, extent: Extent::OutsideBalls(radius) }), ..mission }
}

/// The value that this share of all values is less than; NaN if there is none.
pub fn quantile(share: f64, values: impl IntoIterator<Item = f64>) -> f64 {
    let mut sorted: Vec<_> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let at = (sorted.len() as f64 * share) as usize;
    sorted.get(at.min(sorted.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
}

/// The median; NaN if there is no value.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(0.5, values)
}

/// The mean; NaN if there is no value.
pub fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        (sum, count) = (sum + value, count + 1.0);
    }
    sum / count
}

/// How many of all are so, per cent; NaN if there is none.
pub fn percent<T>(all: &[T], is: impl Fn(&T) -> bool) -> f64 {
    mean(all.iter().map(|it| if is(it) { 100.0 } else { 0.0 }))
}

/// Prints a figure and compares it with its bounds.
///
/// # Panics
/// When it is outside of them, or NaN.
#[track_caller]
pub fn expect(what: impl Display, figure: f64, bounds: impl RangeBounds<f64> + Debug) {
    println!("{what}: {figure:.4} of {bounds:?}");
    assert!(bounds.contains(&figure), "{what}: {figure} is not in {bounds:?}");
}
