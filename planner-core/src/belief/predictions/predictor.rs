//! The traits that look-ahead needs: what a label at a place is expected to tell, and the prediction after it.
//!
//! A [`PredictiveBelief`] is a belief that makes predictors. A [`Prediction`] says what the next label may tell. A
//! [`Predictor`] is the prediction of the present belief: it can also predict what follows that label.
//!
//! In the last two, `share` is the [`share_above`](Prediction::share_above) of a site.

use crate::belief::cells::CellView;
use crate::belief::predictions::spread::{Spread, Stretch};
use crate::belief::predictions::verdicts::Verdicts;
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Reading};
use crate::belief::tolerance::Tolerance;
use crate::belief::weight::LogWeight;
use crate::belief::{Belief, ObservationError};
use crate::geometry::lattice::Site;

/// A belief that can predict labels: what look-ahead plans with.
pub trait PredictiveBelief {
    /// What is known.
    type Belief: Belief;

    /// What the labels of an audit come to.
    type Verdicts: Verdicts;

    /// What predicts the next labels.
    type Predictor<'a>: Predictor
    where
        Self: 'a;

    /// What says how far lines lie apart.
    type Spread<'a>: Spread
    where
        Self: 'a;

    /// What is known.
    fn belief(&self) -> &Self::Belief;

    /// Takes in what was read at a site that may be off by so much.
    ///
    /// # Errors
    /// As [`Belief::observe_within`].
    fn observe_within(
        &mut self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError>;

    /// Takes in what was read at a site on the way of a motion, and returns whether it was kept.
    ///
    /// # Errors
    /// As [`Belief::observe_on_the_way`].
    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError>;

    /// Prepares the predictor. It stays valid until something is observed.
    fn prepare(&mut self);

    /// The predictor for questions asked from a site.
    fn predictor(&self, from: Site) -> Self::Predictor<'_>;

    /// How far the lines lie apart over a stretch. Ask it after [`prepare`](Self::prepare).
    fn spread(&self, over: &Stretch) -> Self::Spread<'_>;

    /// The most that a label can carry, bits.
    fn capacity(&self) -> f32;

    /// The lines on whose uncertain ground a label may tell something.
    fn ground(&self) -> CellView<'_>;

    /// Of which label the belief is sure at a site that may be off by so much, and how often that label is read there.
    /// `None` where it is not sure, and where the reading tells nothing.
    fn sure_of(
        &self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Option<(Label, Reliability)>;

    /// How far from a place the belief has to be sure, so that it is sure wherever a robot really is; lattice units.
    fn margin(&self) -> f32;

    /// How much farther from the lines a site has to be, about, so that the belief is sure within `due` around it;
    /// lattice units, and 0 where it is. `inner` lies so much nearer to the lines. Ask it after
    /// [`prepare`](Self::prepare).
    fn lacks(&self, site: Site, inner: Site, due: f32) -> f32;
}

/// A prediction of the label at a place, and of the information that it carries.
///
/// In single precision, and the same on every machine. A prediction chooses where to go; the belief decides what is
/// known.
pub trait Prediction {
    /// The share of the lines, by their probability, that have a site on their +1 side. Where all lines agree it may be
    /// below 0 or above 1, and further so the farther the site is from uncertain ground.
    fn share_above(&self, site: Site) -> f32;

    /// The expected information of a label at a site, as a share of the most that a label can carry. `share` is the
    /// site's [`share_above`](Self::share_above).
    fn information(&self, site: Site, share: f32) -> f32;

    /// How often a label at a site is true.
    fn reliability(&self, site: Site) -> f32;

    /// What a motion to a site brings, as a share of the most that one can bring. It is the `information` of the label there.
    /// Labels on the way add theirs.
    fn brings(&self, _site: Site, _share: f32, information: f32) -> f32 {
        information
    }

    /// The most that the labels of a motion can tell together, as a multiple of what one can.
    fn most(&self) -> f32 {
        1.0
    }

    /// Places that are asked for that: as many evaluations does the end of a motion take of a plan's limit.
    fn asks(&self) -> u32 {
        1
    }
}

/// A prediction that can also predict its own state after one more label.
pub trait Predictor: Prediction {
    /// The prediction when one more label is known.
    type After<'a>: Prediction
    where
        Self: 'a;

    /// The chance that a label read at a site is +1. `share` is the site's [`share_above`](Prediction::share_above).
    fn chance(&self, site: Site, share: f32) -> f32;

    /// The prediction after a label is read at a site.
    fn after(&self, site: Site, label: Label) -> Self::After<'_>;
}

/// The entropy of a coin that shows one side with this probability, bits. It is accurate to 10^-3; near one half, its
/// difference from one bit has that relative accuracy.
///
/// It is `1 - (x/1 + x^2/6 + x^3/15 + ...) / (2 ln 2)` with `x = (2p - 1)^2`; some higher powers stand for
/// the terms after the first.
pub(crate) fn entropy(p: f32) -> f32 {
    const HALF_LOG2_E: f32 = 0.5 * core::f32::consts::LOG2_E;
    let x = (2.0 * p - 1.0) * (2.0 * p - 1.0);
    let x2 = x * x;
    let x4 = x2 * x2;
    let x8 = x4 * x4;
    let x16 = x8 * x8;
    let x32 = x16 * x16;
    let higher = 0.122_157_23 * x2 + 0.113_838_27 * x4;
    let highest = 0.028_746_36 * x16 + 0.013_910_62 * (x32 * x32);
    1.0 - HALF_LOG2_E * x - higher - highest
}

/// The logarithm of a share to base 2; of next to none that of very little.
pub(crate) fn log2(share: f32) -> f32 {
    LogWeight::of(if share < 1e-6 { 1e-6 } else { share }) * core::f32::consts::LOG2_E
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entropy_is_that_of_a_coin() {
        for n in 0..=10_000 {
            let p = f64::from(n) / 10_000.0;
            let term = |p: f64| if p > 0.0 { -p * p.log2() } else { 0.0 };
            let (got, is) = (f64::from(entropy(p as f32)), term(p) + term(1.0 - p));
            assert!((got - is).abs() < 1e-3, "{p}: {got}, {is}");
            if (0.3..0.7).contains(&p) {
                assert!((got - is).abs() < 4e-3 * (1.0 - is) + 1e-6, "{p}: {got}, {is}");
            }
        }
    }
}
