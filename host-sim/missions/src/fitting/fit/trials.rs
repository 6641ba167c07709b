//! Whether few labels show a bend or a drift: by trials.
//!
//! For few labels the [bounded odds](crate::fitting::fit::shapes) are weak. So the labels are drawn anew, many times, as
//! the fitted line and the file's own share of wrong labels would have them. Each time a line and an arc (or a moving
//! line) are fitted. The p-value is the share of trials in which the arc gains as much as it does in the file. Seeds are
//! fixed. Trials end when ten have gained as much (Besag and Clifford 1991), so most files need few.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::fitting::fit::labels::Labels;
use crate::fitting::fit::shapes::Lift;
use crate::fitting::fit::sweep::{Directed, line};

/// The most labels with which trials are worth their time. More show by bounded odds what they show.
const MOST: usize = 600;

/// Trials at most.
const TRIALS: usize = 999;

/// Trials end when so many have gained as much as the file.
const ENOUGH: usize = 10;

/// The p-value of what a bend or drift gains over the straight and still line. `share` of the labels are wrong.
pub(crate) fn p_value(labels: &Labels, from: Directed, share: f64, lift: Lift) -> f64 {
    if labels.count() > MOST {
        return 1.0;
    }
    let found = gain(labels, from, lift);
    if found <= 0.0 {
        return 1.0;
    }
    let height = from.heights(labels);
    let chances: Vec<_> = (0..labels.count())
        .map(|index| {
            let side = labels.side(index, height(index));
            let true_chance = share + (1.0 - 2.0 * share) * side;
            if labels.is_positive[index] { true_chance } else { 1.0 - true_chance }
        })
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(25);
    let mut trial = labels.clone();
    let mut reached = 0;
    for count in 1..=TRIALS {
        for (label, chance) in trial.is_positive.iter_mut().zip(&chances) {
            *label = rng.random_range(0.0..1.0) < *chance;
        }
        if gain(&trial, from, lift) >= found - 1e-9 {
            reached += 1;
            if reached == ENOUGH {
                return ENOUGH as f64 / count as f64;
            }
        }
    }
    (reached + 1) as f64 / (TRIALS + 1) as f64
}

/// How much more likely the labels are with the lift than without, as a logarithm, each with its own share of wrong
/// labels.
fn gain(labels: &Labels, from: Directed, lift: Lift) -> f64 {
    let all: Vec<_> = (0..labels.count()).collect();
    let (straight, against) = line(labels, &all, Some(from.angle));
    let lifted = lift.fewest(labels, straight);
    log_likelihood(all.len(), lifted) - log_likelihood(all.len(), against)
}

/// Of so many labels of which some disagree.
fn log_likelihood(count: usize, against: usize) -> f64 {
    let log = |part: usize| {
        let share = part as f64 / count as f64;
        if part == 0 { 0.0 } else { part as f64 * libm::log(share) }
    };
    log(against) + log(count - against)
}
