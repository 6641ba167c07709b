//! The hypothesis table: every separable sequence of true labels, with its weight, in fixed memory.
//!
//! Of the `2^t` sequences that `t` labels could have, those matter that some line realises (Section
//! III-B). Each is a cell of the arrangement that the samples' lines draw on the starting polygon, so
//! there are at most `1 + t + t (t - 1) / 2`: 56 for 10 labels, 529 for 32, 2,081 for 64. A hypothesis
//! is such a cell with a weight, 24 bytes in all, and a sample splits the cells that it cuts and weighs
//! the rest: the whole distribution, exactly, until the table is full.
//!
//! - *Full table.* The least likely hypotheses go, in whole, before a sample is taken in. What they
//!   can have come to since is bounded, see [`Posterior::lost`].
//! - *A cell with more edges than it can hold* keeps the lines that the sample would have cut off: an
//!   outer approximation, counted in [`outer_cells`](Hypotheses::outer_cells). With 15 edges it has
//!   not been seen to happen: over the tests' missions of 64 labels a cell has 9 at most.
//!
//! [`Posterior::lost`]: crate::posterior::Posterior::lost

use crate::candidates::{Candidates, Certainty};
use crate::cell::{Cell, Edge};
use crate::lattice::Site;
use crate::list::List;
use crate::lost::Lost;
use crate::measure::measure;
use crate::sample::{Label, Sample, SampleBuffer};
use crate::version_space::{NoVersionSpace, Refused, VersionSpace};
use crate::weight::{LogWeight, Reliability};

/// How hypotheses are weighed before any label is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Prior {
    /// By the measure of their lines, d(angle) d(offset): uniform over lines.
    #[default]
    Area,
    /// All alike: the paper's, uniform over separable sequences.
    Sequences,
}

/// A sequence of true labels that some line realises: the cell of the lines that do, and how likely
/// the labels seen are if it is the true one.
#[derive(Clone, Copy, Debug)]
pub struct Hypothesis<const E: usize> {
    cell: Cell<E>,
    /// Relative to the most likely hypothesis.
    likelihood: LogWeight,
    area: LogWeight,
}

impl<const E: usize> Hypothesis<E> {
    /// What no line realises. All its bytes are zero, so that memory is filled with it at no cost of
    /// flash.
    const NONE: Self =
        Self { cell: Cell::NONE, likelihood: LogWeight::ZERO, area: LogWeight::ZERO };

    /// The lines that realise it.
    pub fn cell(&self) -> &Cell<E> {
        &self.cell
    }

    /// Its weight under a prior, up to a factor that all hypotheses share.
    #[inline(never)] // or every loop over the table comes twice, once for each prior
    pub fn weight(&self, prior: Prior) -> LogWeight {
        match prior {
            Prior::Area => self.likelihood + self.area,
            Prior::Sequences => self.likelihood,
        }
    }

    /// The logarithm of its measure, radian metres.
    pub fn area(&self) -> LogWeight {
        self.area
    }
}

/// Up to `H` hypotheses over up to `N` samples, the given ones included; a cell has up to `E` edges.
///
/// `24 H + 12 N` bytes and some 40 for `E = 15`: with the four oracle points, 3,564 bytes for all
/// hypotheses of 16 labels (`H` = 137), 13,164 for 32 (529), 50,796 for 64 (2,081).
///
/// A table without room for one hypothesis does not compile:
///
/// ```compile_fail,E0080
/// use planner_core::hypotheses::{Hypotheses, Prior};
/// let table = Hypotheses::<16, 0>::new(&[], Prior::Area);
/// ```
#[derive(Clone, Debug)]
pub struct Hypotheses<const N: usize, const H: usize, const E: usize = 15> {
    samples: SampleBuffer<N>,
    given: u8,
    start: Cell<E>,
    table: List<Hypothesis<E>, H>,
    prior: Prior,
    lost: Lost,
    outer_cells: u16,
}

impl<const N: usize, const H: usize, const E: usize> Hypotheses<N, H, E> {
    /// No sample and no hypothesis: memory to [`restart`](Self::restart) in.
    pub const NONE: Self = {
        assert!(H >= 1, "a table holds at least one hypothesis");
        Self {
            samples: SampleBuffer::new(),
            given: 0,
            start: Cell::NONE,
            table: List::filled(Hypothesis::NONE),
            prior: Prior::Area,
            lost: Lost::NOTHING,
            outer_cells: 0,
        }
    };

    /// The one hypothesis that the given samples leave, which are certain. `prior` decides which
    /// hypotheses go when the table is full.
    ///
    /// # Errors
    /// [`NoVersionSpace`], and `TooMany` also when more than `E` of them bound the line.
    pub fn new(given: &[Sample], prior: Prior) -> Result<Self, NoVersionSpace> {
        let mut hypotheses = Self::NONE;
        hypotheses.restart(given, prior)?;
        Ok(hypotheses)
    }

    /// As [`new`](Self::new), in place: a table can be larger than the memory that is left beside it.
    ///
    /// # Errors
    /// As `new`, with the table as it was.
    pub fn restart(&mut self, given: &[Sample], prior: Prior) -> Result<(), NoVersionSpace> {
        let space = VersionSpace::<N>::new(given)?;
        let start: Cell<E> = space.cell().resized().ok_or(NoVersionSpace::TooMany)?;
        let area = LogWeight::of_single(measure(space.candidates()));
        self.samples = space.into_samples();
        self.given = given.len() as u8;
        self.start = start;
        self.table.clear();
        // It has room for one.
        let _ = self.table.push(Hypothesis { cell: start, likelihood: LogWeight::ZERO, area });
        self.prior = prior;
        self.lost = Lost::NOTHING;
        self.outer_cells = 0;
        Ok(())
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
    pub fn is_full(&self) -> bool {
        self.samples.is_full()
    }

    /// What the given samples leave: the ground of P3 and P4.
    pub fn start(&self) -> Candidates<'_> {
        self.start.candidates(&self.samples)
    }

    /// The hypotheses that are held.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Hypothesis<E>> + Clone {
        self.table.iter()
    }

    /// The candidate lines of a hypothesis of this table.
    pub fn candidates<'a>(&'a self, hypothesis: &'a Hypothesis<E>) -> Candidates<'a> {
        hypothesis.cell.candidates(&self.samples)
    }

    /// How often a cell could not hold another edge and kept lines that it should not have.
    pub fn outer_cells(&self) -> u16 {
        self.outer_cells
    }

    /// Mass given up, at most, under a prior, on the scale of the weights held.
    pub(crate) fn lost(&self, prior: Prior) -> f64 {
        f64::from(self.lost.mass(prior))
    }

    fn certainty(&self, hypothesis: &Hypothesis<E>, q: Site) -> Certainty {
        self.candidates(hypothesis).certainty(q)
    }

    /// Takes in a label of some reliability: splits the hypotheses that the sample cuts and weighs
    /// all. One orientation an edge, and for each of the at most `t + 1` that split two cuts and two
    /// measures, in integers and single precision.
    ///
    /// # Errors
    /// [`Refused::Contradiction`] when a label that is certain leaves no hypothesis, and
    /// [`Refused::Full`]; the table is then as it was.
    pub fn observe(&mut self, sample: Sample, reliability: Reliability) -> Result<(), Refused> {
        let Reliability { agree, disagree } = reliability;
        let weight = |label: Label| if label == sample.label { agree } else { disagree };
        let survives = |hypothesis: &Hypothesis<E>| match self.certainty(hypothesis, sample.site) {
            Certainty::Certain(label) => weight(label).is_some(),
            Certainty::Uncertain => true,
        };
        let doubtful = agree.is_some() && disagree.is_some();
        if self.samples.is_full() {
            return Err(Refused::Full(sample));
        }
        if !doubtful && !self.table.iter().any(survives) {
            return Err(Refused::Contradiction(sample));
        }
        if doubtful {
            self.make_room(sample.site);
        }
        let Ok(index) = self.samples.push(sample) else { return Err(Refused::Full(sample)) };
        for k in 0..self.table.len() {
            self.update(k, Edge::new(index, sample.label), reliability);
        }
        if !doubtful {
            self.table.retain(|hypothesis| !hypothesis.cell.edges().is_empty());
        }
        self.rescale(reliability.most());
        Ok(())
    }

    /// Gives up the least likely hypotheses until those that a sample at `q` splits find room.
    fn make_room(&mut self, q: Site) {
        // Exact cells tile the starting polygon, and a line crosses at most one more of them than
        // there are other lines.
        if self.outer_cells == 0 && self.table.len() + self.taken() < H {
            return;
        }
        let splits = |it: &Self, h: &Hypothesis<E>| it.certainty(h, q) == Certainty::Uncertain;
        let mut more = self.table.iter().filter(|h| splits(self, h)).count();
        while self.table.len() > 1 && self.table.len() + more > H {
            let weights = self.table.iter().map(|h| h.weight(self.prior)).enumerate();
            let Some((least, _)) = weights.min_by_key(|(_, weight)| *weight) else { return };
            let Some(gone) = self.table.swap_remove(least) else { return };
            more -= usize::from(splits(self, &gone));
            self.lost.add(&gone);
        }
    }

    /// Weighs the `k`-th hypothesis by the newest sample, splitting it first if the sample cuts it.
    /// One that becomes impossible is left without edges.
    fn update(&mut self, k: usize, edge: Edge, reliability: Reliability) {
        let Reliability { agree, disagree } = reliability;
        let Some(site) = self.samples.get(edge.index()).map(|s| s.site) else { return };
        let Some(whole) = self.table.get_mut(k) else { return };
        match whole.cell.candidates(&self.samples).certainty(site) {
            Certainty::Certain(certain) => {
                let weight = if certain == edge.label() { agree } else { disagree };
                match weight {
                    Some(weight) => whole.likelihood = whole.likelihood + weight,
                    None => whole.cell = Cell::NONE,
                }
            }
            Certainty::Uncertain => {
                let whole = *whole;
                let opposite = Edge::new(edge.index() as u8, -edge.label());
                let agreeing = agree.map(|weight| self.part(&whole, edge, weight));
                let other = disagree.map(|weight| self.part(&whole, opposite, weight));
                let (kept, split_off) =
                    if agreeing.is_some() { (agreeing, other) } else { (other, None) };
                if let (Some(kept), Some(place)) = (kept, self.table.get_mut(k)) {
                    *place = kept;
                }
                if let Some(split_off) = split_off {
                    self.add(k, split_off);
                }
            }
        }
    }

    /// Adds what was split off the `k`-th hypothesis.
    fn add(&mut self, k: usize, split_off: Hypothesis<E>) {
        if let Err(mut refused) = self.table.push(split_off) {
            // Only a table of one hypothesis comes here: the likelier part stays.
            let prior = self.prior;
            if let Some(place) = self.table.get_mut(k)
                && refused.weight(prior) > place.weight(prior)
            {
                core::mem::swap(place, &mut refused);
            }
            self.lost.add(&refused);
        }
    }

    /// The part of a hypothesis on one side of a sample.
    fn part(&mut self, whole: &Hypothesis<E>, edge: Edge, weight: LogWeight) -> Hypothesis<E> {
        let mut part = *whole;
        if part.cell.cut(&self.samples, edge).is_err() {
            self.outer_cells = self.outer_cells.saturating_add(1);
        }
        part.likelihood = whole.likelihood + weight;
        part.area = LogWeight::of_single(measure(self.candidates(&part)));
        part
    }

    /// Makes the most likely hypothesis the unit of all weights.
    fn rescale(&mut self, most: LogWeight) {
        let best = self.table.iter().map(|h| h.likelihood).max().unwrap_or(LogWeight::ZERO);
        for hypothesis in self.table.iter_mut() {
            hypothesis.likelihood = hypothesis.likelihood.relative_to(best);
        }
        self.lost.rescale(most, best);
    }
}
