//! The posterior over hypotheses: the probabilities that the labels seen give to the lines.
//!
//! The motions depend only on the labels seen, so they cancel in the paper's Equation 8. What is left is the weight
//! `p^agree (1 - p)^disagree`. `p` is the probability that a label is true. `agree` and `disagree` count the labels
//! outside the trusted balls that a hypothesis agrees with, and the others. A probability is this weight divided by the
//! sum over all separable sequences. Where nobody knows `p`, the weight is the mean of that over the prior of `p`, see
//! [`UnknownReliability`](crate::UnknownReliability). A bound on the effect of pruning is [`PosteriorView::pruned_mass`].

use crate::belief::cells::{CellView, Moments, intercepts};
use crate::belief::doubtful_labels::cell_posterior::{CellPosterior, Hypothesis};
use crate::belief::estimate::{Estimates, area, bisector, maximum_margin, share_above};
use crate::belief::goal::{Bounds, Criterion, Goal};
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Reading};
use crate::belief::tolerance::Tolerance;
use crate::belief::trust::Trust;
use crate::belief::weight::LogWeight;
use crate::belief::{Belief, ObservationError};
use crate::geometry::arc::SlopeArc;
use crate::geometry::area::Area;
use crate::geometry::lattice::Site;
use crate::geometry::line::Bound;
use crate::geometry::local_line::LocalLine;

/// The distribution over the hypotheses of a table, by its prior.
///
/// Building it and each read-out cost one exponential for each hypothesis.
#[derive(Clone, Copy, Debug)]
pub struct PosteriorView<'a, const N: usize, const H: usize, const E: usize, R: Trust = Reliability>
{
    hypotheses: &'a CellPosterior<N, H, E, R>,
    total: f64,
}

/// The paper's outcome: the most likely hypothesis (Section IV-B).
#[derive(Clone, Copy, Debug)]
pub struct MostLikely<'a, const E: usize, R = Reliability> {
    /// The hypothesis.
    pub hypothesis: &'a Hypothesis<E, R>,
    /// Its probability.
    pub probability: f64,
    /// The slopes of its lines.
    pub slope_arc: SlopeArc,
    /// The intercepts of its lines, metres; `None` when unbounded.
    pub intercept: Option<[f64; 2]>,
}

/// The smallest set of hypotheses that holds at least a stated probability.
#[derive(Clone, Copy, Debug)]
pub struct Credible {
    /// The probability that was asked for.
    pub level: f64,
    /// The probability of the set. It exceeds the level, as hypotheses are taken whole.
    pub probability: f64,
    /// Number of hypotheses.
    pub cells: usize,
    /// The arc that spans the slopes of their lines.
    pub slope_arc: SlopeArc,
    /// The range of the intercepts of their lines, metres; `None` when unbounded.
    pub intercept: Option<[f64; 2]>,
    /// The smallest weight in the set, and the number of hypotheses of that weight in the set.
    cut: Option<(LogWeight, usize)>,
}

/// What is known of the probability that a doubtful label is true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliabilityEstimate {
    /// Its mean: the chance that the next doubtful label is true.
    pub mean: f64,
    /// Its standard deviation; 0 where it is known.
    pub deviation: f64,
}

impl<const N: usize, const H: usize, const E: usize, R: Trust> Belief
    for CellPosterior<N, H, E, R>
{
    fn is_full(&self) -> bool {
        self.is_full()
    }

    fn tolerance(&self) -> Tolerance {
        self.noise().tolerance
    }

    /// A reading on the boundary agrees with both sides, and tells nothing here.
    fn observe_within(
        &mut self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        let Reading::Side(label) = reading else { return self.admits(tolerance) };
        self.read_within(site, label, tolerance)
    }

    /// A label is kept where the given samples leave it open.
    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let is_kept = self.keeps_on_the_way(site, reading);
        if is_kept {
            self.observe(site, reading)?;
        }
        Ok(is_kept)
    }

    /// Returns the bisector of the labels as they were seen, the posterior [mean](PosteriorView::mean), and the maximum
    /// margin of the most likely hypothesis.
    fn estimates(&self) -> Estimates {
        let best = most_likely(self).map(|best| self.lines(best));
        Estimates {
            bisector: bisector(self.samples()),
            centre: self.centre(),
            maximum_margin: best.and_then(maximum_margin),
        }
    }

    fn centre(&self) -> Option<LocalLine> {
        mean(self)
    }

    fn information(&self) -> f64 {
        PosteriorView::new(self).information()
    }

    /// Whether the lines of the heaviest hypotheses, which together have the goal's level as probability, meet it.
    fn meets<C: Criterion>(&self, goal: Goal<C>, area: Area) -> bool {
        let heaviest =
            self.lightest_within(goal.level).map(|least| Heaviest { table: self, least });
        heaviest.is_some_and(|heaviest| goal.accuracy.is_met(&heaviest, area))
    }

    fn chance(&self, site: Site) -> f64 {
        PosteriorView::new(self).chance(site)
    }

    fn chance_of(&self, site: Site, label: Label) -> f32 {
        let reliability = self.reliability(site);
        let is_unknown =
            self.noise().reliability.unknown().is_some() && reliability != Reliability::CERTAIN;
        let p = reliability.single();
        let above = self.mean_of(|hypothesis| {
            let above = if self.is_blurred() {
                self.sides(hypothesis, site)[0]
            } else {
                share_above(self.lines(hypothesis), site)
            };
            let p = if is_unknown { self.agreement(hypothesis) as f32 } else { p };
            p * above + (1.0 - p) * (1.0 - above)
        });
        if label == Label::Positive { above } else { 1.0 - above }
    }
}

/// The hypotheses of a table that weigh this much at least.
struct Heaviest<'a, const N: usize, const H: usize, const E: usize, R: Trust> {
    table: &'a CellPosterior<N, H, E, R>,
    least: LogWeight,
}

impl<const N: usize, const H: usize, const E: usize, R: Trust> Bounds for Heaviest<'_, N, H, E, R> {
    fn each(&self, mut f: impl FnMut(Bound)) {
        for hypothesis in self.table.iter().filter(|it| it.weight() >= self.least) {
            self.table.lines(hypothesis).bounds().for_each(&mut f);
        }
    }
}

impl<'a, const N: usize, const H: usize, const E: usize, R: Trust> PosteriorView<'a, N, H, E, R> {
    /// The posterior of a table.
    pub fn new(hypotheses: &'a CellPosterior<N, H, E, R>) -> Self {
        let total = hypotheses.iter().map(|h| h.weight().exp()).sum();
        Self { hypotheses, total }
    }

    /// The probability of a hypothesis of the table, to 10^-6 of it; what is less likely than 10^-37 is
    /// held to be about that.
    pub fn probability(&self, hypothesis: &Hypothesis<E, R>) -> f64 {
        hypothesis.weight().exp() / self.total
    }

    /// An upper bound on the probability of all hypotheses that were dropped because the table was full; 0 if none
    /// were. Every probability stated is too high by this share at most.
    pub fn pruned_mass(&self) -> f64 {
        let pruned = self.hypotheses.pruned_mass();
        pruned / (pruned + self.total)
    }

    /// The most likely hypothesis, the first of equals.
    pub fn best(&self) -> Option<MostLikely<'a, E, R>> {
        let hypothesis = most_likely(self.hypotheses)?;
        let lines = self.hypotheses.lines(hypothesis);
        Some(MostLikely {
            hypothesis,
            probability: self.probability(hypothesis),
            slope_arc: lines.slope_arc(),
            intercept: lines.intercepts(),
        })
    }

    /// The smallest set of hypotheses with at least this probability, taken by falling weight.
    /// `O(H)` comparisons for each hypothesis in the set.
    pub fn credible(&self, level: f64) -> Credible {
        let weights = || self.hypotheses.iter().map(Hypothesis::weight);
        let (mut probability, mut cells) = (0.0, 0);
        let mut cut = None;
        while probability < level {
            let next = weights().filter(|w| cut.is_none_or(|(above, _)| *w < above)).max();
            let Some(weight) = next else { break };
            let alike = weights().filter(|w| *w == weight).count();
            let each = weight.exp() / self.total;
            let enough = (1..alike).find(|&n| probability + n as f64 * each >= level);
            let taken = enough.unwrap_or(alike);
            probability += taken as f64 * each;
            cells += taken;
            cut = Some((weight, taken));
        }
        let lines = || self.down_to(cut).map(|h| self.hypotheses.lines(h));
        let directions = lines().flat_map(|c| c.bounds().map(|bound| bound.along));
        let slope_arc = SlopeArc::spanning(directions).unwrap_or_default();
        let intercept = intercepts(lines().flat_map(CellView::bounds));
        Credible { level, probability, cells, slope_arc, intercept, cut }
    }

    /// The hypotheses of a credible set of this posterior.
    pub fn members(&self, set: &Credible) -> impl Iterator<Item = &'a Hypothesis<E, R>> {
        self.down_to(set.cut)
    }

    /// The hypotheses above a weight, and the first so many of that weight.
    fn down_to(
        &self,
        cut: Option<(LogWeight, usize)>,
    ) -> impl Iterator<Item = &'a Hypothesis<E, R>> {
        let mut alike = cut.map_or(0, |(_, alike)| alike);
        self.hypotheses.iter().filter(move |h| {
            let Some((least, _)) = cut else { return false };
            let weight = h.weight();
            if weight == least && alike > 0 {
                alike -= 1;
                return true;
            }
            weight > least
        })
    }

    /// Shannon entropy over the hypotheses, bits.
    pub fn entropy(&self) -> f64 {
        let term = |p: f64| if p > 0.0 { -p * libm::log2(p) } else { 0.0 };
        self.hypotheses.iter().map(|h| term(self.probability(h))).sum()
    }

    /// The information of the labels about the line, bits: the divergence of this posterior from the uniform
    /// distribution over the starting lines. For noiseless labels it is `-log2` of the share of the starting lines that
    /// are left. Never below 0.
    pub fn information(&self) -> f64 {
        let area_of = |h| self.hypotheses.log_area(h).exp();
        let mut start = f64::from(area(self.hypotheses.start()));
        if self.hypotheses.outer_cells() > 0 {
            // Outer cells overlap, so their areas can come to more than the whole: shares are of their sum then.
            start = start.max(self.hypotheses.iter().map(area_of).sum());
        }
        let term = |h| {
            let p = self.probability(h);
            let share = area_of(h) / start;
            if p > 0.0 { p * libm::log2(p / share) } else { 0.0 }
        };
        let bits: f64 = self.hypotheses.iter().map(term).sum();
        // A divergence is 0 at least; areas are rounded, by some 3e-7 of themselves.
        if bits < 0.0 { 0.0 } else { bits }
    }

    /// The probability that a site lies on the +1 side.
    pub fn share_above(&self, site: Site) -> f64 {
        let share =
            |h| f64::from(share_above(self.hypotheses.lines(h), site)) * self.probability(h);
        self.hypotheses.iter().map(share).sum()
    }

    /// The distribution of the probability that a doubtful label is true, as far as labels have shown it.
    ///
    /// It is exact for the hypotheses that are held. Where the probability is known, it is that number.
    pub fn reliability(&self) -> ReliabilityEstimate {
        let trust = self.hypotheses.noise().reliability;
        let Some(prior) = trust.unknown() else {
            return ReliabilityEstimate { mean: trust.nominal().probability(), deviation: 0.0 };
        };
        let (mut mean, mut square) = (0.0, 0.0);
        for hypothesis in self.hypotheses.iter() {
            let (weight, counts) =
                (self.probability(hypothesis), self.hypotheses.counts(hypothesis));
            mean += weight * prior.agrees(counts);
            square += weight * prior.square(counts);
        }
        let variance = square - mean * mean;
        let deviation = libm::sqrt(if variance > 0.0 { variance } else { 0.0 });
        ReliabilityEstimate { mean, deviation }
    }

    /// The chance that a label read at a site is +1.
    fn chance(&self, site: Site) -> f64 {
        let table = self.hypotheses;
        let is_unknown = table.noise().reliability.unknown().is_some();
        if is_unknown && table.reliability(site) != Reliability::CERTAIN {
            let chance = |h| {
                let (above, p) = (f64::from(share_above(table.lines(h), site)), table.agreement(h));
                (above * p + (1.0 - above) * (1.0 - p)) * self.probability(h)
            };
            return table.iter().map(chance).sum();
        }
        let above = if table.is_blurred() {
            let above = |h| f64::from(table.sides(h, site)[0]) * self.probability(h);
            table.iter().map(above).sum()
        } else {
            self.share_above(site)
        };
        let p = table.reliability(site).probability();
        above * p + (1.0 - above) * (1.0 - p)
    }

    /// The posterior mean of the line: the point estimate to use. Each hypothesis adds its centre, as unit normals with
    /// their offsets, by its probability. The mean needs no choice of a hypothesis and moves smoothly as labels arrive.
    pub fn mean(&self) -> Option<LocalLine> {
        mean(self.hypotheses)
    }
}

impl<const N: usize, const H: usize, const E: usize, R: Trust> CellPosterior<N, H, E, R> {
    /// [`PosteriorView::share_above`] in single precision, to 10^-5.
    pub(crate) fn above(&self, site: Site) -> f32 {
        self.mean_of(|hypothesis| share_above(self.lines(hypothesis), site))
    }

    /// The mean of something over all hypotheses, in single precision.
    fn mean_of(&self, of: impl Fn(&Hypothesis<E, R>) -> f32) -> f32 {
        let (mut sum, mut all) = (0.0, 0.0);
        for hypothesis in self.iter() {
            let weight = hypothesis.weight().exp_single();
            all += weight;
            sum += weight * of(hypothesis);
        }
        sum / all
    }
}

fn most_likely<const N: usize, const H: usize, const E: usize, R: Trust>(
    hypotheses: &CellPosterior<N, H, E, R>,
) -> Option<&Hypothesis<E, R>> {
    hypotheses.iter().reduce(|best, next| if next.weight() > best.weight() { next } else { best })
}

/// [`PosteriorView::mean`], in the frame of the most likely hypothesis: in single precision, and without the sum
/// of all weights.
fn mean<const N: usize, const H: usize, const E: usize, R: Trust>(
    hypotheses: &CellPosterior<N, H, E, R>,
) -> Option<LocalLine> {
    let frame = Moments::of(hypotheses.lines(most_likely(hypotheses)?))?.frame();
    let mut all = Moments::none(frame);
    for hypothesis in hypotheses.iter() {
        if let Some(moments) = Moments::of(hypotheses.lines(hypothesis)) {
            all.add_means(&moments, hypothesis.weight().exp_single());
        }
    }
    all.mean()
}
