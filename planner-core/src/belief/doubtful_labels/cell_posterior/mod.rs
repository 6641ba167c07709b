//! The hypothesis table, [`CellPosterior`]: every separable sequence of true labels, with its weight, in fixed memory.
//!
//! Of the `2^t` sequences that `t` labels could have, only those matter that some line realises (Section III-B). Each
//! is a cell of the arrangement that the samples' lines draw on the starting polygon. So there are at most
//! `1 + t + t (t - 1) / 2`: 56 for 10 labels, 529 for 32, 2,081 for 64. A hypothesis is such a cell with a weight, 24
//! bytes in all. A sample splits the cells that it cuts and reweights the others. The table is the whole distribution,
//! exactly, until it is full (`taking`).

mod taking;

use core::marker::PhantomData;

use crate::belief::ObservationError;
use crate::belief::cells::{CellView, Certainty, DualCell};
use crate::belief::doubtful_labels::blur::{Blur, Scale};
use crate::belief::doubtful_labels::pruned::PrunedMass;
use crate::belief::estimate::area;
use crate::belief::list::List;
use crate::belief::noise::Noise;
use crate::belief::observation_log::{FromLog, ObservationLog, ReplayError};
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Reading, Sample, SampleBuffer};
use crate::belief::tolerance::{Short, Tolerance};
use crate::belief::true_labels::{GivenError, VersionSpace};
use crate::belief::trust::{Tallies, Trust, counts};
use crate::belief::unknown_reliability::Counts;
use crate::belief::weight::{Coarse, LogWeight, Prior};
use crate::geometry::lattice::Site;
use crate::geometry::mark::Mark;

/// A sequence of true labels that some line realises: the cell of these lines, and the sequence's weight given the
/// labels seen. 24 bytes for `E = 15`.
///
/// Where nobody knows the reliability of labels, it also counts those that disagree with it. The count is in the lowest
/// byte of the 64 bits. The weight has the others: 128 labels need 49 of them.
#[derive(Clone, Copy, Debug)]
pub struct Hypothesis<const E: usize, R = Reliability> {
    cell: DualCell<E>,
    /// The weight in two halves, or a hypothesis would be padded to a multiple of 8 bytes.
    high: i32,
    low: u32,
    trust: PhantomData<R>,
}

impl<const E: usize, R: Trust> Hypothesis<E, R> {
    /// A placeholder that no line realises. All its bytes are zero, so memory filled with it costs no flash.
    const NONE: Self = Self { cell: DualCell::NONE, high: 0, low: 0, trust: PhantomData };

    fn new(cell: DualCell<E>, LogWeight(units): LogWeight) -> Self {
        Self::of(cell, units << R::BITS)
    }

    fn of(cell: DualCell<E>, bits: i64) -> Self {
        Self { cell, high: (bits >> 32) as i32, low: bits as u32, trust: PhantomData }
    }

    const fn bits(&self) -> i64 {
        (self.high as i64) << 32 | self.low as i64
    }

    /// The lines that realise it.
    pub fn cell(&self) -> &DualCell<E> {
        &self.cell
    }

    /// Its weight by the table's prior, relative to the heaviest hypothesis.
    pub const fn weight(&self) -> LogWeight {
        LogWeight(self.bits() >> R::BITS)
    }

    fn weigh(&mut self, by: LogWeight) {
        *self = Self::of(self.cell, self.bits() + (by.0 << R::BITS));
    }

    /// One more label disagrees.
    fn count(&mut self) {
        if R::BITS > 0 {
            *self = Self::of(self.cell, self.bits() + 1);
        }
    }

    /// The number of doubtful labels that disagree, where labels are counted.
    fn disagree(&self) -> u8 {
        (self.bits() & ((1 << R::BITS) - 1)) as u8
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
/// `R` says how far labels can be believed: with a [`Reliability`] that is known, or an
/// [`UnknownReliability`](crate::UnknownReliability). With the latter a hypothesis has the weight of its counts of
/// labels, summed over all probabilities, and the table takes four bytes more. A label then costs two logarithms in
/// double precision for each hypothesis.
///
/// A table without room for one hypothesis does not compile:
///
/// ```compile_fail,E0080
/// use planner_core::CellPosterior;
/// let table: CellPosterior<16, 0> = CellPosterior::NONE;
/// ```
#[derive(Clone, Debug)]
pub struct CellPosterior<
    const N: usize,
    const H: usize,
    const E: usize = 15,
    R: Trust = Reliability,
> {
    samples: SampleBuffer<N>,
    /// How far the position of each label taken in may be off.
    tolerances: List<Short, N>,
    given: u8,
    start: DualCell<E>,
    table: List<Hypothesis<E, R>, H>,
    prior: Prior,
    noise: Noise<R>,
    pruned: PrunedMass,
    outer_cells: u16,
    tally: R::Tally,
}

impl<const N: usize, const H: usize, const E: usize, R: Trust> CellPosterior<N, H, E, R> {
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
            noise: Noise { reliability: R::NONE, trusted_radius: 0, tolerance: Tolerance::NONE },
            pruned: PrunedMass::NOTHING,
            outer_cells: 0,
            tally: R::Tally::NONE,
        }
    };

    /// The one hypothesis that the given samples leave, which are certain. `prior` weighs those that
    /// labels will make of it, `noise` says how far these can be believed.
    ///
    /// # Errors
    /// [`GivenError`], and `TooMany` also when more than `E` of them bound the line. `Reliability` if positions err and
    /// the reliability is unknown.
    pub fn new(given: &[Sample], prior: Prior, noise: Noise<R>) -> Result<Self, GivenError> {
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
        noise: Noise<R>,
    ) -> Result<(), GivenError> {
        if noise.reliability.unknown().is_some() && noise.tolerance != Tolerance::NONE {
            return Err(GivenError::Reliability);
        }
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
        self.tally = R::Tally::NONE;
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
    pub const fn noise(&self) -> Noise<R> {
        self.noise
    }

    /// How far a label at a site can be believed. Where nobody knows, it is [`Trust::nominal`].
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
    pub fn log_area(&self, hypothesis: &Hypothesis<E, R>) -> LogWeight {
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

    /// Whether a reading on the way of a motion may tell something, and leaves room for the label at the motion's end.
    pub(crate) fn keeps_on_the_way(&self, site: Site, reading: Reading) -> bool {
        reading != Reading::Boundary
            && self.samples.len() + 2 <= N
            && self.start().certainty(site) == Certainty::Uncertain
    }

    /// What the given samples leave: the ground of P3 and P4.
    pub fn start(&self) -> CellView<'_> {
        self.start.lines(&self.samples)
    }

    /// The hypotheses that are held.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Hypothesis<E, R>> + Clone {
        self.table.iter()
    }

    /// The lines of a hypothesis of this table.
    pub fn lines<'a>(&'a self, hypothesis: &'a Hypothesis<E, R>) -> CellView<'a> {
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

    /// The chance that the next doubtful label agrees with the lines of a hypothesis: the reliability, or its mean for these
    /// lines where nobody knows it. The more labels agree with a line, the higher it is.
    pub fn agreement(&self, hypothesis: &Hypothesis<E, R>) -> f64 {
        let trust = self.noise.reliability;
        trust.unknown().map_or_else(
            || trust.nominal().probability(),
            |prior| prior.agrees(self.counts(hypothesis)),
        )
    }

    /// The counts of labels of a hypothesis, where labels are counted.
    pub(crate) fn counts(&self, hypothesis: &Hypothesis<E, R>) -> Counts {
        counts(&self.tally, hypothesis.disagree())
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

    fn certainty(&self, hypothesis: &Hypothesis<E, R>, q: Site) -> Certainty {
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

    /// Whether the noise says that positions err.
    pub(crate) fn is_blurred(&self) -> bool {
        self.noise.tolerance != Tolerance::NONE
    }

    /// The probabilities that the true position is on the +1 side and on the -1 side if `site` is reported. Both are
    /// averages over the lines of a hypothesis.
    pub(crate) fn sides(&self, hypothesis: &Hypothesis<E, R>, site: Site) -> [f32; 2] {
        Blur::<E>::of(self.lines(hypothesis)).sides(site, Scale::by(self.noise.tolerance))
    }

    /// Whether a position may be off by so much.
    pub(crate) fn admits(&self, tolerance: Tolerance) -> Result<(), ObservationError> {
        let is_within = tolerance <= self.noise.tolerance;
        is_within.then_some(()).ok_or(ObservationError::Tolerance(tolerance))
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
impl<const N: usize, const H: usize, const E: usize, R: Trust> FromLog
    for CellPosterior<N, H, E, R>
{
    type ObservationLog = ObservationLog<N>;

    fn log(&self) -> ObservationLog<N> {
        let labels = self.labels().iter().zip(self.tolerances());
        let believed = labels.map(|(label, it)| self.reliability_within(label.site, it));
        ObservationLog::new(self.given(), self.samples(), believed)
            .within(self.tolerances(), self.noise.tolerance)
    }

    fn mark(&self) -> Mark {
        self.noise.mark().and([self.prior as u32])
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
