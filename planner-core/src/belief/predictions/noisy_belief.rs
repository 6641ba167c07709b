//! The belief for labels that may be wrong. A [`CellPosterior`], an exact table of hypotheses, contains what is known.
//! [`Columns`] are an approximate copy of its distribution, from which look-ahead predicts the next labels.
//!
//! Where nobody knows the reliability of labels, table and columns weigh lines by their counts of labels, which is exact.
//! Predictions take the next labels to be true with the mean of the reliability. That is an approximation: lines with which
//! more labels agree also give the next label a higher chance to be true. No read-out depends on it.

use crate::belief::ObservationError;
use crate::belief::cells::CellView;
use crate::belief::doubtful_labels::{CellPosterior, PosteriorView};
use crate::belief::list::List;
use crate::belief::noise::Noise;
use crate::belief::observation_log::{FromLog, ObservationLog, ReplayError};
use crate::belief::predictions::columns::{After, ColumnSpread, Columns};
use crate::belief::predictions::predictor::{Prediction, PredictiveBelief, Predictor, entropy};
use crate::belief::predictions::spread::{Covariance, Spread, Stretch};
use crate::belief::predictions::verdicts::Odds;
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::true_labels::GivenError;
use crate::belief::trust::{Mean as _, Trust};
use crate::belief::weight::Prior;
use crate::geometry::lattice::Site;
use crate::geometry::mark::Mark;

/// How much of the distribution may have the other label where the belief is sure of one.
const UNSURE: f32 = 0.0003;

/// The number of directions that represent all lines.
const DIRECTIONS: usize = 16;

/// The most label sequences that one line can produce at so many positions. A [`NoisyBelief`] with room for as many
/// hypotheses never drops one.
///
/// ```
/// # use planner_core::{NoisyBelief, sequences_of};
/// type Belief = NoisyBelief<40, { sequences_of(36) }>; // room for 4 given samples and 36 labels
/// # assert_eq!(sequences_of(36), 667);
/// ```
pub const fn sequences_of(labels: usize) -> usize {
    1 + labels + labels * labels.saturating_sub(1) / 2
}

/// The belief for labels that may be wrong: up to `H` hypotheses over up to `N` samples. It also predicts the next
/// labels, for look-ahead.
///
/// The given samples count among the `N`. [`sequences_of`] computes `H`.
#[derive(Clone, Debug)]
pub struct NoisyBelief<const N: usize, const H: usize, R: Trust = Reliability> {
    table: CellPosterior<N, H, 15, R>,
    /// The reliability of each label of the table.
    believed: List<Reliability, N>,
    columns: Columns<DIRECTIONS>,
}

impl<const N: usize, const H: usize, R: Trust> NoisyBelief<N, H, R> {
    /// No sample and no hypothesis: memory to [`restart`](Self::restart) in.
    pub const NONE: Self = Self {
        table: CellPosterior::NONE,
        believed: List::filled(Reliability::NONE),
        columns: Columns::NONE,
    };

    /// What the given samples leave, lines weighed by [`Prior::Area`]. [`restart`](Self::restart) takes another prior.
    /// The labels of given samples count as certain.
    ///
    /// # Errors
    /// As [`CellPosterior::new`].
    pub fn new(given: &[Sample], noise: Noise<R>) -> Result<Self, GivenError> {
        let mut belief = Self::NONE;
        belief.restart(given, Prior::Area, noise)?;
        Ok(belief)
    }

    /// As [`new`](Self::new), in place, with lines weighed by a prior.
    ///
    /// # Errors
    /// As there, with the belief as it was.
    pub fn restart(
        &mut self,
        given: &[Sample],
        prior: Prior,
        noise: Noise<R>,
    ) -> Result<(), GivenError> {
        self.table.restart(given, prior, noise)?;
        self.believed.clear();
        Ok(())
    }

    /// Takes in a label of some reliability, see [`CellPosterior::take`].
    ///
    /// # Errors
    /// As there, with the belief as it was.
    pub fn take(
        &mut self,
        sample: Sample,
        reliability: Reliability,
    ) -> Result<(), ObservationError> {
        self.take_within(sample, reliability, self.table.noise().tolerance)
    }

    /// As [`take`](Self::take), of a position that may be off by so much, see [`CellPosterior::take_within`].
    ///
    /// # Errors
    /// As there, with the belief as it was.
    pub fn take_within(
        &mut self,
        sample: Sample,
        reliability: Reliability,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        self.table.take_within(sample, reliability, tolerance)?;
        let _ = self.believed.push(reliability); // there is as much room
        Ok(())
    }
}

impl<const N: usize, const H: usize, R: Trust> FromLog for NoisyBelief<N, H, R> {
    type ObservationLog = ObservationLog<N>;

    fn log(&self) -> ObservationLog<N> {
        let believed = self.believed.iter().copied();
        let log = ObservationLog::new(self.table.given(), self.table.samples(), believed);
        log.within(self.table.tolerances(), self.table.noise().tolerance)
    }

    fn mark(&self) -> Mark {
        self.table.mark()
    }

    fn replay(&mut self, log: &ObservationLog<N>) -> Result<(), ReplayError> {
        let labels = log.doubtful_labels(self.table.noise().tolerance)?;
        self.restart(log.given(), self.table.prior(), self.table.noise())?;
        for (sample, reliability, tolerance) in labels {
            self.take_within(sample, reliability, tolerance)?;
        }
        Ok(())
    }
}

impl<const N: usize, const H: usize, R: Trust + 'static> PredictiveBelief for NoisyBelief<N, H, R> {
    type Belief = CellPosterior<N, H, 15, R>;
    type Verdicts = Odds;
    type Predictor<'a> = TablePredictor<'a, N, H, R>;
    type Spread<'a> = TableSpread<'a, N, H, R>;

    fn belief(&self) -> &CellPosterior<N, H, 15, R> {
        &self.table
    }

    fn observe_within(
        &mut self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        let Reading::Side(label) = reading else { return self.table.admits(tolerance) };
        let reliability = self.table.reliability_within(site, tolerance);
        self.take_within(Sample { site, label }, reliability, tolerance)
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let is_kept = self.table.keeps_on_the_way(site, reading);
        if is_kept {
            self.observe_within(site, reading, self.table.noise().tolerance)?;
        }
        Ok(is_kept)
    }

    fn prepare(&mut self) {
        self.columns.lay(&self.table, &self.believed);
    }

    fn predictor(&self, _: Site) -> TablePredictor<'_, N, H, R> {
        TablePredictor { labels: Labels::of(&self.table), columns: &self.columns }
    }

    fn spread(&self, over: &Stretch) -> TableSpread<'_, N, H, R> {
        TableSpread { labels: Labels::of(&self.table), columns: self.columns.spread(over) }
    }

    fn capacity(&self) -> f32 {
        Labels::of(&self.table).capacity
    }

    fn ground(&self) -> CellView<'_> {
        self.table.start()
    }

    fn sure_of(
        &self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Option<(Label, Reliability)> {
        // A reading on the boundary agrees with both sides.
        let label = side(self.table.above(site)).filter(|_| reading != Reading::Boundary)?;
        let told = self.table.reliability_within(site, tolerance);
        // Where nobody knows, as often as labels have shown so far.
        let is_unknown = self.table.noise().reliability.unknown().is_some();
        let shown = (is_unknown && told != Reliability::CERTAIN)
            .then(|| Reliability::new(PosteriorView::new(&self.table).reliability().mean));
        Some((label, shown.and_then(Result::ok).unwrap_or(told)))
    }

    fn margin(&self) -> f32 {
        self.table.noise().tolerance.units() as f32
    }

    fn lacks(&self, _: Site, inner: Site, due: f32) -> f32 {
        if side(self.columns.share_above(inner)).is_some() { 0.0 } else { due }
    }
}

/// The side of a place, by the share of the lines that have it on their +1 side; `None` where that is not sure.
fn side(above: f32) -> Option<Label> {
    match above {
        _ if above > 1.0 - UNSURE => Some(Label::Positive),
        _ if above < UNSURE => Some(Label::Negative),
        _ => None,
    }
}

/// How reliable labels are, and how much one can tell at most.
#[derive(Clone, Copy, Debug)]
struct Labels<'a, const N: usize, const H: usize, R: Trust> {
    table: &'a CellPosterior<N, H, 15, R>,
    /// How often one is true outside the trusted balls, if nobody knows.
    mean: R::Mean,
    /// What one can tell outside the trusted balls, bits.
    capacity: f32,
}

/// Predictions take labels to be true at least as often as this. Where the mean of an unknown reliability is less, no label
/// would be worth its way.
const LEAST: f64 = 0.51;

impl<'a, const N: usize, const H: usize, R: Trust> Labels<'a, N, H, R> {
    fn of(table: &'a CellPosterior<N, H, 15, R>) -> Self {
        let mean = R::Mean::of(|| {
            let mean = PosteriorView::new(table).reliability().mean;
            if mean > LEAST { mean as f32 } else { LEAST as f32 }
        });
        let capacity = 1.0 - entropy(usual(table, mean));
        Self { table, mean, capacity }
    }

    /// How often a label at a site is true.
    fn p(&self, site: Site) -> f32 {
        let reliability = self.table.reliability(site);
        let is_unknown = self.table.noise().reliability.unknown().is_some();
        if is_unknown && reliability != Reliability::CERTAIN {
            return self.mean.value();
        }
        reliability.single()
    }

    /// The expected information of a label, as a share of the most that a label can carry.
    fn information(&self, site: Site, share: f32) -> f32 {
        information(share, self.p(site), (usual(self.table, self.mean), self.capacity))
    }
}

/// How often a label outside the trusted balls is true; its mean, where nobody knows.
fn usual<const N: usize, const H: usize, R: Trust>(
    table: &CellPosterior<N, H, 15, R>,
    mean: R::Mean,
) -> f32 {
    let trust = table.noise().reliability;
    if trust.unknown().is_some() { mean.value() } else { trust.nominal().single() }
}

/// The expected information of a label that is true with probability `p`, as a share of the most that a label can
/// carry. `most` is the reliability of labels outside the trusted balls, and `capacity` the bits that one of them can
/// carry.
pub(crate) fn information(share: f32, p: f32, (most, capacity): (f32, f32)) -> f32 {
    if most < FAINT {
        // `1 - entropy` by its series, as no digits of that are left.
        let told = |bias: f32| bias * bias * (1.0 + bias * bias / 6.0);
        let bias = 2.0 * p - 1.0;
        return (told(bias) - told(bias * (2.0 * share - 1.0))) / told(2.0 * most - 1.0);
    }
    (entropy(chance(share, p)) - entropy(p)) / capacity
}

/// Labels that are true less often are faint.
const FAINT: f32 = 0.5625;

/// The chance of a label +1 where it is true with probability `p`.
fn chance(share: f32, p: f32) -> f32 {
    p * share + (1.0 - p) * (1.0 - share)
}

/// The predictor of a table of hypotheses.
#[derive(Clone, Copy, Debug)]
pub struct TablePredictor<'a, const N: usize, const H: usize, R: Trust = Reliability> {
    labels: Labels<'a, N, H, R>,
    columns: &'a Columns<DIRECTIONS>,
}

/// The prediction of that table when one more label is known.
#[derive(Clone, Copy, Debug)]
pub struct TablePredictorAfter<'a, const N: usize, const H: usize, R: Trust = Reliability> {
    labels: Labels<'a, N, H, R>,
    columns: After<'a, DIRECTIONS>,
}

/// How far the lines of that table lie apart over a stretch.
#[derive(Clone, Copy, Debug)]
pub struct TableSpread<'a, const N: usize, const H: usize, R: Trust = Reliability> {
    labels: Labels<'a, N, H, R>,
    columns: ColumnSpread<'a, DIRECTIONS>,
}

impl<const N: usize, const H: usize, R: Trust> Spread for TableSpread<'_, N, H, R> {
    fn covariance(&self) -> Covariance {
        self.columns.whole.covariance
    }

    fn lever(&self) -> f32 {
        self.columns.whole.lever
    }

    fn after(&self, site: Site) -> Covariance {
        self.columns.after(site, self.labels.p(site))
    }
}

impl<const N: usize, const H: usize, R: Trust> Prediction for TablePredictor<'_, N, H, R> {
    fn share_above(&self, site: Site) -> f32 {
        self.columns.share_above(site)
    }

    fn information(&self, site: Site, share: f32) -> f32 {
        self.labels.information(site, share)
    }

    fn reliability(&self, site: Site) -> f32 {
        self.labels.p(site)
    }
}

impl<const N: usize, const H: usize, R: Trust> Prediction for TablePredictorAfter<'_, N, H, R> {
    fn share_above(&self, site: Site) -> f32 {
        self.columns.share_above(site)
    }

    fn information(&self, site: Site, share: f32) -> f32 {
        self.labels.information(site, share)
    }

    fn reliability(&self, site: Site) -> f32 {
        self.labels.p(site)
    }
}

impl<const N: usize, const H: usize, R: Trust> Predictor for TablePredictor<'_, N, H, R> {
    type After<'a>
        = TablePredictorAfter<'a, N, H, R>
    where
        Self: 'a;

    fn chance(&self, site: Site, share: f32) -> f32 {
        chance(share, self.labels.p(site))
    }

    fn after(&self, site: Site, label: Label) -> TablePredictorAfter<'_, N, H, R> {
        let heights = self.columns.heights(site);
        let columns = self.columns.after(heights, label, self.labels.p(site));
        TablePredictorAfter { labels: self.labels, columns }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definition, in double precision; and at the bound both ways agree.
    #[test]
    fn faint_labels_tell_a_share_of_what_they_can() {
        let bits = |p: f64| -p * libm::log2(p) - (1.0 - p) * libm::log2(1.0 - p);
        for most in [0.500_001_f32, 0.500_1, 0.501, 0.52, 0.562_4, 0.562_6, 0.7] {
            let capacity = 1.0 - entropy(most);
            for k in 0..=20 {
                let share = k as f32 / 20.0;
                let got = f64::from(information(share, most, (most, capacity)));
                let (p, bias) = (f64::from(most), 2.0 * f64::from(share) - 1.0);
                let full = 1.0 - bits(p);
                // For the faintest the definition has no digits left either: by its first term.
                let is = if p < 0.51 {
                    1.0 - bias * bias
                } else {
                    (bits(0.5 + (p - 0.5) * bias) - bits(p)) / full
                };
                assert!((got - is).abs() < 0.02, "{most}, {share}: {got}, {is}");
            }
        }
    }
}
