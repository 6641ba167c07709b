//! The hypothesis table, [`CellPosterior`]: every separable sequence of true labels, with its weight, in fixed memory.
//!
//! Of the `2^t` sequences that `t` labels could have, only those matter that some line realises (Section III-B). Each
//! is a cell of the arrangement that the samples' lines draw on the starting polygon. So there are at most
//! `1 + t + t (t - 1) / 2`: 56 for 10 labels, 529 for 32, 2,081 for 64. A hypothesis is such a cell with a weight, 24
//! bytes in all. A sample splits the cells that it cuts and reweights the others. The table is the whole distribution,
//! exactly, until it is full.
//!
//! - *Full table.* Before a sample is taken in, the least likely hypotheses are dropped whole. A bound on the mass that
//!   they may have reached since is [`PosteriorView::pruned_mass`].
//! - *A cell with more edges than it can hold* keeps the lines that the sample would have cut off. That is an outer
//!   approximation, counted in [`outer_cells`](CellPosterior::outer_cells). With 15 edges it has not been seen to happen:
//!   over the tests' missions of 64 labels a cell has 9 at most.
//!
//! Where positions err, the weight of a label does not change in a step from one side of its site to the other. Steps,
//! wherever they are placed, would claim more knowledge than there is. Instead, a hypothesis is weighed by the label's
//! mean likelihood over its lines. When a hypothesis splits, each part is weighed anew by all labels. So the narrower
//! the cells, the more closely the weights follow the likelihood. Each label is still one sample. The pruned mass keeps
//! the value that it had when it was lost.
//!
//! [`PosteriorView::pruned_mass`]: crate::belief::doubtful_labels::posterior_view::PosteriorView::pruned_mass

use crate::belief::ObservationError;
use crate::belief::cells::{CellView, Certainty, Constraint, DualCell};
use crate::belief::doubtful_labels::blur::{Blur, Doubt, Scale};
use crate::belief::doubtful_labels::pruned::PrunedMass;
use crate::belief::estimate::area;
use crate::belief::list::List;
use crate::belief::noise::{Noise, Reliability};
use crate::belief::observation_log::{FromLog, ObservationLog, ReplayError};
use crate::belief::sample::{Label, Sample, SampleBuffer};
use crate::belief::tolerance::{Short, Tolerance};
use crate::belief::true_labels::{GivenError, VersionSpace};
use crate::belief::weight::{Coarse, LogWeight, Prior};
use crate::geometry::lattice::Site;

/// A sequence of true labels that some line realises: the cell of these lines, and the sequence's weight given the
/// labels seen. 24 bytes for `E = 15`.
#[derive(Clone, Copy, Debug)]
pub struct Hypothesis<const E: usize> {
    cell: DualCell<E>,
    /// The weight in two halves, or a hypothesis would be padded to a multiple of 8 bytes.
    high: i32,
    low: u32,
}

impl<const E: usize> Hypothesis<E> {
    /// A placeholder that no line realises. All its bytes are zero, so memory filled with it costs no flash.
    const NONE: Self = Self { cell: DualCell::NONE, high: 0, low: 0 };

    fn new(cell: DualCell<E>, LogWeight(units): LogWeight) -> Self {
        Self { cell, high: (units >> 32) as i32, low: units as u32 }
    }

    /// The lines that realise it.
    pub fn cell(&self) -> &DualCell<E> {
        &self.cell
    }

    /// Its weight by the table's prior, relative to the heaviest hypothesis.
    pub const fn weight(&self) -> LogWeight {
        LogWeight((self.high as i64) << 32 | self.low as i64)
    }

    fn weigh(&mut self, by: LogWeight) {
        *self = Self::new(self.cell, self.weight() + by);
    }
}

/// Up to `H` hypotheses over up to `N` samples, the given ones included; a cell has up to `E` edges.
///
/// `24 H + 14 N` bytes and 56 for `E = 15`: with the four given samples, 3,624 bytes for all
/// hypotheses of 16 labels (`H` = 137), 13,256 for 32 (529), 50,952 for 64 (2,081).
///
/// Weights are exact but for the logarithms of a label's odds (to 10^-10 each) and of a cell's measure
/// (to 10^-6), however certain labels are.
///
/// A table without room for one hypothesis does not compile:
///
/// ```compile_fail,E0080
/// use planner_core::CellPosterior;
/// let table = CellPosterior::<16, 0>::NONE;
/// ```
#[derive(Clone, Debug)]
pub struct CellPosterior<const N: usize, const H: usize, const E: usize = 15> {
    samples: SampleBuffer<N>,
    /// How far the position of each label taken in may be off.
    tolerances: List<Short, N>,
    given: u8,
    start: DualCell<E>,
    table: List<Hypothesis<E>, H>,
    prior: Prior,
    noise: Noise,
    pruned: PrunedMass,
    outer_cells: u16,
}

impl<const N: usize, const H: usize, const E: usize> CellPosterior<N, H, E> {
    /// No sample and no hypothesis: memory to [`restart`](Self::restart) in.
    pub const NONE: Self = {
        assert!(H >= 1, "a table holds at least one hypothesis");
        Self {
            samples: SampleBuffer::new(),
            tolerances: List::filled(Short::NONE),
            given: 0,
            start: DualCell::NONE,
            table: List::filled(Hypothesis::NONE),
            prior: Prior::Area,
            noise: Noise {
                reliability: Reliability::NONE,
                trusted_radius: 0,
                tolerance: Tolerance::NONE,
            },
            pruned: PrunedMass::NOTHING,
            outer_cells: 0,
        }
    };

    /// The one hypothesis that the given samples leave, which are certain. `prior` weighs those that
    /// labels will make of it, `noise` says how far these can be believed.
    ///
    /// # Errors
    /// [`GivenError`], and `TooMany` also when more than `E` of them bound the line.
    pub fn new(given: &[Sample], prior: Prior, noise: Noise) -> Result<Self, GivenError> {
        let mut hypotheses = Self::NONE;
        hypotheses.restart(given, prior, noise)?;
        Ok(hypotheses)
    }

    /// As [`new`](Self::new), in place: a table can be larger than the memory that is left beside it.
    ///
    /// # Errors
    /// As `new`, with the table as it was.
    pub fn restart(
        &mut self,
        given: &[Sample],
        prior: Prior,
        noise: Noise,
    ) -> Result<(), GivenError> {
        let space = VersionSpace::<N>::new(given)?;
        let start: DualCell<E> = space.cell().resized().ok_or(GivenError::TooMany)?;
        self.samples = space.into_samples();
        self.tolerances.clear();
        self.given = given.len() as u8;
        self.start = start;
        self.table.clear();
        // It has room for one.
        let _ = self.table.push(Hypothesis::new(start, LogWeight::ZERO));
        (self.prior, self.noise) = (prior, noise);
        self.pruned = PrunedMass::NOTHING;
        self.outer_cells = 0;
        Ok(())
    }

    /// The same hypotheses as another prior weighs them.
    #[must_use]
    pub fn weighed_by(&self, prior: Prior) -> Self {
        let mut other = self.clone();
        if prior != self.prior {
            other.prior = prior;
            for hypothesis in other.table.iter_mut() {
                let area = self.log_area(hypothesis);
                hypothesis.weigh(match prior {
                    Prior::Area => area,
                    Prior::Sequences => LogWeight::ZERO - area,
                });
            }
            other.rescale();
        }
        other
    }

    /// What hypotheses are weighed by before any label is seen.
    pub const fn prior(&self) -> Prior {
        self.prior
    }

    /// What is known of the noise.
    pub const fn noise(&self) -> Noise {
        self.noise
    }

    /// How far a label at a site can be believed.
    pub fn reliability(&self, site: Site) -> Reliability {
        self.noise.at(site, self.given())
    }

    /// The same for a position that may be off by so much.
    pub(crate) fn reliability_within(&self, site: Site, tolerance: Tolerance) -> Reliability {
        Noise { tolerance: self.rounded(tolerance), ..self.noise }.at(site, self.given())
    }

    /// A tolerance as it is kept.
    fn rounded(&self, tolerance: Tolerance) -> Tolerance {
        Short::of(tolerance).at_most(self.noise.tolerance)
    }

    /// The logarithm of the measure of a hypothesis's lines, radian metres, to 10^-6; at least -96.
    #[inline(never)] // called from many places
    pub fn log_area(&self, hypothesis: &Hypothesis<E>) -> LogWeight {
        Coarse::of(area(self.lines(hypothesis))).into()
    }

    /// All samples with the labels that were seen, the given ones first.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The samples that were given.
    pub fn given(&self) -> &[Sample] {
        self.samples.get(..usize::from(self.given)).unwrap_or(&[])
    }

    /// Labels taken in since.
    pub fn taken(&self) -> usize {
        self.samples.len() - self.given().len()
    }

    /// Whether another sample would be refused for want of room.
    pub(crate) fn is_full(&self) -> bool {
        self.samples.is_full()
    }

    /// What the given samples leave: the ground of P3 and P4.
    pub fn start(&self) -> CellView<'_> {
        self.start.lines(&self.samples)
    }

    /// The hypotheses that are held.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Hypothesis<E>> + Clone {
        self.table.iter()
    }

    /// The lines of a hypothesis of this table.
    pub fn lines<'a>(&'a self, hypothesis: &'a Hypothesis<E>) -> CellView<'a> {
        hypothesis.cell.lines(&self.samples)
    }

    /// How often a cell had no room for another edge and kept lines that it should have dropped.
    pub fn outer_cells(&self) -> u16 {
        self.outer_cells
    }

    /// An upper bound on the pruned mass, on the scale of the weights in the table.
    pub(crate) fn pruned_mass(&self) -> f64 {
        f64::from(self.pruned.mass(self.prior))
    }

    /// A weight such that the hypotheses of at least that weight have a probability of `level`, in millionths. Their
    /// set is a little larger than the smallest such set. `None` if too much mass has been given up.
    pub(crate) fn lightest_within(&self, level: u32) -> Option<LogWeight> {
        const BANDS: usize = 64;
        let mut bands = [0.0_f32; BANDS];
        for hypothesis in self.iter() {
            let weight = hypothesis.weight();
            let band = (weight.0.saturating_neg() / Self::BAND).clamp(0, BANDS as i64 - 1);
            if let Some(band) = bands.get_mut(band as usize) {
                *band += weight.exp_single();
            }
        }
        let all = bands.iter().sum::<f32>() + self.pruned.mass(self.prior);
        // Rounded up by more than the sums are off.
        let due = all * (level as f32 * 1e-6 + 1e-5);
        let mut held = 0.0;
        let band = bands.iter().position(|band| {
            held += band;
            held >= due
        })?;
        let is_last = band + 1 == BANDS;
        Some(LogWeight(if is_last { i64::MIN } else { -(band as i64 + 1) * Self::BAND + 1 }))
    }

    /// Weights in one band differ by a factor of `e^(1/2)` at most.
    const BAND: i64 = LogWeight::ONE / 2;

    fn certainty(&self, hypothesis: &Hypothesis<E>, q: Site) -> Certainty {
        self.lines(hypothesis).certainty(q)
    }

    /// The labels taken in since.
    pub(crate) fn labels(&self) -> &[Sample] {
        self.samples.get(usize::from(self.given)..).unwrap_or(&[])
    }

    /// How far the position of each of them may be off.
    pub(crate) fn tolerances(&self) -> impl Iterator<Item = Tolerance> + Clone {
        self.tolerances.iter().map(|it| it.at_most(self.noise.tolerance))
    }

    /// The weights of the lines on the label's side of a sample and on the other. Where positions err, both weights are
    /// alike, as each hypothesis is [weighed](Self::told_by) for itself.
    fn weights(&self, reliability: Reliability) -> (Option<LogWeight>, Option<LogWeight>) {
        if self.is_blurred() {
            return (Some(LogWeight::ZERO), Some(LogWeight::ZERO));
        }
        (reliability.agree(), reliability.disagree())
    }

    /// Whether the noise says that positions err.
    pub(crate) fn is_blurred(&self) -> bool {
        self.noise.tolerance != Tolerance::NONE
    }

    /// The probabilities that the true position is on the +1 side and on the -1 side if `site` is reported. Both are
    /// averages over the lines of a hypothesis.
    pub(crate) fn sides(&self, hypothesis: &Hypothesis<E>, site: Site) -> [f32; 2] {
        Blur::<E>::of(self.lines(hypothesis)).sides(site, Scale::by(self.noise.tolerance))
    }

    /// Fills a list with the labels, ready to weigh hypotheses by. Leaves it empty where positions do not err.
    #[inline(never)] // its list is not for all of the stack's time
    fn doubts(&self, doubts: &mut List<Doubt, N>) {
        if !self.is_blurred() {
            return;
        }
        for (&label, tolerance) in self.labels().iter().zip(self.tolerances()) {
            let reliability = self.reliability_within(label.site, tolerance);
            let _ = doubts.push(Doubt::new(label, reliability, tolerance)); // there is as much room
        }
    }

    /// The weight that some labels give a hypothesis where positions err.
    fn told_by(&self, hypothesis: &Hypothesis<E>, labels: &[Doubt]) -> LogWeight {
        if labels.is_empty() {
            return LogWeight::ZERO;
        }
        Blur::<E>::of(self.lines(hypothesis)).told(labels)
    }

    /// Whether a position may be off by so much.
    pub(crate) fn admits(&self, tolerance: Tolerance) -> Result<(), ObservationError> {
        let is_within = tolerance <= self.noise.tolerance;
        is_within.then_some(()).ok_or(ObservationError::Tolerance(tolerance))
    }

    /// Takes in a label that is read at a site, as far as it can be believed there.
    ///
    /// # Errors
    /// As [`take`](Self::take).
    pub fn read(&mut self, site: Site, label: Label) -> Result<(), ObservationError> {
        self.read_within(site, label, self.noise.tolerance)
    }

    /// As [`read`](Self::read), of a label whose own position may be off by so much.
    ///
    /// # Errors
    /// As [`take_within`](Self::take_within).
    pub fn read_within(
        &mut self,
        site: Site,
        label: Label,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        let reliability = self.reliability_within(site, tolerance);
        self.take_within(Sample { site, label }, reliability, tolerance)
    }

    /// Takes in a label of some reliability: splits the hypotheses that the sample cuts and reweights all.
    ///
    /// Cost: one orientation for each edge, in integers. At most `t + 1` hypotheses split, each at the cost of two cuts
    /// and two measures, in integers and single precision. Where positions err, each hypothesis is weighed by the
    /// distances of its vertices, and those that split by all labels anew. That costs some eight times as much.
    ///
    /// # Errors
    /// [`ObservationError::Contradiction`] when a label that is certain leaves no hypothesis,
    /// [`ObservationError::Full`], and where positions err [`ObservationError::Reliability`] unless the label is as
    /// reliable as the noise says. The table is then as it was.
    pub fn take(
        &mut self,
        sample: Sample,
        reliability: Reliability,
    ) -> Result<(), ObservationError> {
        self.take_within(sample, reliability, self.noise.tolerance)
    }

    /// As [`take`](Self::take), of a label whose own position may be off by so much: at most by the
    /// [noise](Self::noise)'s tolerance. The less it may be off, the more the label tells.
    ///
    /// # Errors
    /// As `take`, and [`ObservationError::Tolerance`]; the table is then as it was.
    pub fn take_within(
        &mut self,
        sample: Sample,
        reliability: Reliability,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        self.admits(tolerance)?;
        if self.is_blurred() && reliability != self.reliability_within(sample.site, tolerance) {
            return Err(ObservationError::Reliability);
        }
        let (agree, disagree) = self.weights(reliability);
        let weight = |label: Label| if label == sample.label { agree } else { disagree };
        let survives = |hypothesis: &Hypothesis<E>| match self.certainty(hypothesis, sample.site) {
            Certainty::Certain(label) => weight(label).is_some(),
            Certainty::Uncertain => true,
        };
        let doubtful = agree.is_some() && disagree.is_some();
        if self.samples.is_full() {
            return Err(ObservationError::Full(sample));
        }
        if !doubtful && !self.table.iter().any(survives) {
            return Err(ObservationError::Contradiction(sample));
        }
        if doubtful {
            self.make_room(sample.site);
        }
        let Ok(index) = self.samples.push(sample) else {
            return Err(ObservationError::Full(sample));
        };
        let _ = self.tolerances.push(Short::of(tolerance)); // there is as much room
        let mut doubts = List::filled(Doubt::NONE);
        self.doubts(&mut doubts);
        for k in 0..self.table.len() {
            self.update(k, Constraint::new(index, sample.label), reliability, &doubts);
        }
        if !doubtful {
            self.table.retain(|hypothesis| !hypothesis.cell.edges().is_empty());
        }
        self.pruned.split(reliability);
        self.rescale();
        Ok(())
    }

    /// Drops the least likely hypotheses until there is room for those that a sample at `q` splits off.
    fn make_room(&mut self, q: Site) {
        // Exact cells tile the starting polygon, and a line crosses at most one more of them than
        // there are other lines.
        if self.outer_cells == 0 && self.table.len() + self.taken() < H {
            return;
        }
        let splits = |it: &Self, h: &Hypothesis<E>| it.certainty(h, q) == Certainty::Uncertain;
        let mut more = self.table.iter().filter(|h| splits(self, h)).count();
        while self.table.len() > 1 && self.table.len() + more > H {
            let weights = self.table.iter().map(Hypothesis::weight).enumerate();
            let Some((least, _)) = weights.min_by_key(|(_, weight)| *weight) else { return };
            let Some(gone) = self.table.swap_remove(least) else { return };
            more -= usize::from(splits(self, &gone));
            self.give_up(&gone);
        }
    }

    fn give_up(&mut self, gone: &Hypothesis<E>) {
        let (weight, area) = (gone.weight(), self.log_area(gone));
        match self.prior {
            Prior::Area => self.pruned.add(weight, weight - area),
            Prior::Sequences => self.pruned.add(weight + area, weight),
        }
    }

    /// Weighs the `k`-th hypothesis by the newest sample, splitting it first if the sample cuts it.
    /// One that becomes impossible is left without edges.
    fn update(&mut self, k: usize, edge: Constraint, reliability: Reliability, doubts: &[Doubt]) {
        let Some(newest) = self.samples.get(edge.index()) else { return };
        let Some(whole) = self.table.get(k).copied() else { return };
        let (agree, disagree) = self.weights(reliability);
        let (before, newest_doubt) = doubts.split_at(doubts.len().saturating_sub(1));
        let Certainty::Certain(label) = self.certainty(&whole, newest.site) else {
            let weight = LogWeight::ZERO - self.prior_weight(&whole) - self.told_by(&whole, before);
            let opposite = Constraint::new(edge.index() as u8, -edge.label());
            let mut part = |edge, by| self.part(&whole, edge, weight + by, doubts);
            let parts = [agree.map(|by| part(edge, by)), disagree.map(|by| part(opposite, by))];
            return self.replace(k, parts);
        };
        let told = self.told_by(&whole, newest_doubt);
        let weight = if label == edge.label() { agree } else { disagree };
        match (weight, self.table.get_mut(k)) {
            (Some(weight), Some(place)) => place.weigh(weight + told),
            (None, Some(place)) => place.cell = DualCell::NONE,
            (_, None) => {}
        }
    }

    /// The weight of a hypothesis before any label. A cell's measure is the same each time it is computed, and so is
    /// the weight of its labels. So quotients lose nothing.
    fn prior_weight(&self, hypothesis: &Hypothesis<E>) -> LogWeight {
        match self.prior {
            Prior::Area => self.log_area(hypothesis),
            Prior::Sequences => LogWeight::ZERO,
        }
    }

    /// Puts the first part that there is in the place of the `k`-th hypothesis, and adds the other.
    fn replace(&mut self, k: usize, parts: [Option<Hypothesis<E>>; 2]) {
        let mut parts = parts.into_iter().flatten();
        if let (Some(kept), Some(place)) = (parts.next(), self.table.get_mut(k)) {
            *place = kept;
        }
        if let Some(split_off) = parts.next() {
            self.add(k, split_off);
        }
    }

    /// Adds what was split off the `k`-th hypothesis.
    fn add(&mut self, k: usize, split_off: Hypothesis<E>) {
        if let Err(mut refused) = self.table.push(split_off) {
            // Only a table of one hypothesis comes here: the likelier part stays.
            if let Some(place) = self.table.get_mut(k)
                && refused.weight() > place.weight()
            {
                core::mem::swap(place, &mut refused);
            }
            self.give_up(&refused);
        }
    }

    /// The part of a hypothesis on one side of a sample, weighed anew and by the measure of its lines if
    /// that is the prior.
    fn part(
        &mut self,
        whole: &Hypothesis<E>,
        edge: Constraint,
        weight: LogWeight,
        doubts: &[Doubt],
    ) -> Hypothesis<E> {
        let mut part = *whole;
        if part.cell.cut(&self.samples, edge).is_err() {
            self.outer_cells = self.outer_cells.saturating_add(1);
        }
        part.weigh(weight + self.told_by(&part, doubts) + self.prior_weight(&part));
        part
    }

    /// Makes the heaviest hypothesis the unit of all weights.
    fn rescale(&mut self) {
        let most = self.table.iter().map(Hypothesis::weight).max().unwrap_or(LogWeight::ZERO);
        if most != LogWeight::ZERO {
            self.table.iter_mut().for_each(|h| h.weigh(LogWeight::ZERO - most));
            self.pruned.rescale(most);
        }
    }
}

/// All labels count as reliable as the table's noise says. A [`NoisyBelief`] restores labels of other reliabilities.
///
/// [`NoisyBelief`]: crate::belief::predictions::NoisyBelief
impl<const N: usize, const H: usize, const E: usize> FromLog for CellPosterior<N, H, E> {
    type ObservationLog = ObservationLog<N>;

    fn log(&self) -> ObservationLog<N> {
        let labels = self.labels().iter().zip(self.tolerances());
        let believed = labels.map(|(label, it)| self.reliability_within(label.site, it));
        ObservationLog::new(self.given(), self.samples(), believed)
            .within(self.tolerances(), self.noise.tolerance)
    }

    fn replay(&mut self, log: &ObservationLog<N>) -> Result<(), ReplayError> {
        let labels = log.doubtful_labels(self.noise.tolerance)?;
        self.restart(log.given(), self.prior, self.noise)?;
        for (sample, reliability, tolerance) in labels {
            self.take_within(sample, reliability, tolerance)?;
        }
        Ok(())
    }
}
