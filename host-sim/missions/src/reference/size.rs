//! The number of motions that a search will look at, estimated before it begins.
//!
//! By Knuth's method: go down at random from branch to branch, and multiply the numbers of choices on the way. The mean
//! over many such ways is right on average. The estimate treats the best sequence known beforehand as the optimum, so
//! it is rather too high. The ways are seeded, so an instance is refused always or never.

use anyhow::{Result, bail};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::reference::instance::Instance;
use crate::reference::search::{Branch, MOST_LOOKS, Search};

/// Ways that are gone down.
const WAYS: u64 = 400;

/// Whether a search will end.
///
/// # Errors
/// Names the horizon, what was estimated and what is possible.
pub(super) fn check(instance: &Instance, search: &Search<'_>, root: &Branch) -> Result<()> {
    let looks = estimate(search, root);
    if is_enough(looks) {
        return Ok(());
    }
    let possible =
        (1..instance.horizon()).take_while(|&horizon| ends(&instance.cut_to(horizon))).last();
    let possible = possible.map_or("none".to_owned(), |horizon| format!("{horizon} at most"));
    bail!(
        "--horizon: found {} motions of {} actions each, which takes a look at some {looks:.0e} motions where {:.0e} are \
         possible, expected {possible}, or fewer actions (vehicle.step, vehicle.turn_step)",
        instance.horizon(),
        instance.choices.len(),
        MOST_LOOKS as f64,
    );
}

fn ends(instance: &Instance) -> bool {
    let (search, root) = Search::begin(instance);
    root.is_none_or(|root| is_enough(estimate(&search, &root)))
}

fn is_enough(looks: f64) -> bool {
    looks <= MOST_LOOKS as f64
}

/// How many motions it will look at, about.
fn estimate(search: &Search<'_>, root: &Branch) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    (0..WAYS).map(|_| on_a_way(search, root, &mut rng)).sum::<f64>() / WAYS as f64
}

/// The estimate from one random way down.
fn on_a_way(search: &Search<'_>, from: &Branch, rng: &mut ChaCha8Rng) -> f64 {
    let (twigs, looks) = search.twigs(from);
    let looks = looks as f64;
    if from.left() == 1 || twigs.is_empty() {
        return looks;
    }
    let next = from.followed_by(&twigs[rng.random_range(0..twigs.len())]);
    looks + twigs.len() as f64 * on_a_way(search, &next, rng)
}
