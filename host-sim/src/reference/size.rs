//! How many motions a search will look at, before it begins.
//!
//! By Knuth's method: go down at random from branch to branch, and multiply up how many there were to choose from. The mean
//! over many such ways is right on average. It takes the best sequence known beforehand for the best, so it
//! counts rather too many. The ways are seeded, so an instance is refused always or never.

use anyhow::{Result, bail};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::reference::search::{Branch, Search};

/// Motions that a search may look at: some minutes on two cores.
pub const MOST_LOOKS: u64 = 3_000_000_000;

/// Ways that are gone down.
const WAYS: u64 = 400;

/// Whether a search will end.
///
/// # Errors
/// Names the horizon, what was estimated and what is possible.
pub(super) fn check(search: &Search<'_>, root: &Branch) -> Result<()> {
    let looks = estimate(search, root);
    if looks <= MOST_LOOKS as f64 {
        return Ok(());
    }
    bail!(
        "--horizon: found {} motions of {} actions each, which takes a look at some {looks:.0e} motions, expected at most \
         {MOST_LOOKS:.0e}: a shorter horizon, or fewer actions (--speed-step, --turn-step)",
        search.horizon(),
        search.actions(),
    );
}

/// How many motions it will look at, about.
fn estimate(search: &Search<'_>, root: &Branch) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    (0..WAYS).map(|_| on_a_way(search, root, &mut rng)).sum::<f64>() / WAYS as f64
}

/// What a way down from here makes of it.
fn on_a_way(search: &Search<'_>, from: &Branch, rng: &mut ChaCha8Rng) -> f64 {
    let looks = search.count(from) as f64;
    let branches = if from.left() > 1 { search.branches(from) } else { Vec::new() };
    if branches.is_empty() {
        return looks;
    }
    let next = &branches[rng.random_range(0..branches.len())];
    looks + branches.len() as f64 * on_a_way(search, next, rng)
}
