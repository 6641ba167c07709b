//! How a table takes in a label: it splits the hypotheses that the sample cuts, and weighs all.
//!
//! - *Full table.* Before a sample is taken in, the least likely hypotheses are dropped whole. A bound on the mass that
//!   they may have reached since is [`PosteriorView::pruned_mass`].
//! - *A cell with more edges than it can hold* keeps the lines that the sample would have cut off. That is an outer
//!   approximation, counted in [`outer_cells`](CellPosterior::outer_cells). With 15 edges it has not been seen to happen:
//!   over the tests' missions of 64 labels a cell has 9 at most.
//!
//! Where nobody knows the reliability of labels, a label multiplies the weight of a hypothesis by the chance that its counts
//! give to that label. The pruned mass is multiplied by the largest such chance that any lost hypothesis can have: of their
//! counts the smallest are kept. By the paper's prior it keeps its value, as the chances of both labels add up to one.
//!
//! Where positions err, the weight of a label does not change in a step from one side of its site to the other. Steps,
//! wherever they are placed, would claim more knowledge than there is. Instead, a hypothesis is weighed by the label's
//! mean likelihood over its lines. When a hypothesis splits, each part is weighed anew by all labels. So the narrower
//! the cells, the more closely the weights follow the likelihood. Each label is still one sample. The pruned mass keeps
//! the value that it had when it was lost.
//!
//! [`PosteriorView::pruned_mass`]: crate::belief::doubtful_labels::posterior_view::PosteriorView::pruned_mass

use crate::belief::ObservationError;
use crate::belief::cells::{Certainty, Constraint, DualCell};
use crate::belief::doubtful_labels::blur::{Blur, Doubt};
use crate::belief::doubtful_labels::cell_posterior::{CellPosterior, Hypothesis};
use crate::belief::list::List;
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Sample};
use crate::belief::tolerance::{Short, Tolerance};
use crate::belief::trust::{Tallies as _, Trust};
use crate::belief::weight::{LogWeight, Prior};
use crate::geometry::lattice::Site;

impl<const N: usize, const H: usize, const E: usize, R: Trust> CellPosterior<N, H, E, R> {
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
    /// reliable as the noise says. The same where nobody knows the reliability, unless the label is certain. The table is
    /// then as it was.
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
        if !self.expects(reliability, sample.site, tolerance) {
            return Err(ObservationError::Reliability);
        }
        if self.samples.is_full() {
            return Err(ObservationError::Full(sample));
        }
        let weights = self.weights(reliability);
        let doubtful = matches!(weights, (Some(_), Some(_)));
        if doubtful {
            self.make_room(sample.site);
        } else if !self.table.iter().any(|it| self.survives(it, sample, weights)) {
            return Err(ObservationError::Contradiction(sample));
        }
        let Ok(index) = self.samples.push(sample) else {
            return Err(ObservationError::Full(sample));
        };
        let _ = self.tolerances.push(Short::of(tolerance)); // there is as much room
        let mut doubts = List::filled(Doubt::NONE);
        self.doubts(&mut doubts);
        self.weigh_pruned(reliability);
        for k in 0..self.table.len() {
            self.update(k, Constraint::new(index, sample.label), reliability, &doubts);
        }
        if doubtful {
            self.tally.count();
        } else {
            self.table.retain(|hypothesis| !hypothesis.cell.edges().is_empty());
        }
        if self.noise.reliability.unknown().is_none() {
            self.pruned.split(reliability);
        }
        self.rescale();
        Ok(())
    }

    /// Whether lines of a hypothesis are left after a sample with these weights on its side and on the other.
    fn survives(
        &self,
        hypothesis: &Hypothesis<E, R>,
        sample: Sample,
        (agree, disagree): (Option<LogWeight>, Option<LogWeight>),
    ) -> bool {
        match self.certainty(hypothesis, sample.site) {
            Certainty::Certain(label) if label == sample.label => agree.is_some(),
            Certainty::Certain(_) => disagree.is_some(),
            Certainty::Uncertain => true,
        }
    }

    /// Whether a label at a site may have this reliability. Where positions err, or nobody knows the reliability, the noise
    /// alone says how reliable a label is, unless it is certain.
    fn expects(&self, reliability: Reliability, site: Site, tolerance: Tolerance) -> bool {
        let is_told = !self.is_blurred() || reliability == self.reliability_within(site, tolerance);
        let usual = self.noise.reliability;
        let is_free = usual.unknown().is_none() || reliability == Reliability::CERTAIN;
        is_told && (is_free || reliability == usual.nominal())
    }

    /// Updates the bound on the pruned mass before a label of an unknown reliability weighs the table.
    fn weigh_pruned(&mut self, reliability: Reliability) {
        if let Some(prior) = self.noise.reliability.unknown()
            && reliability != Reliability::CERTAIN
        {
            let most = prior.most(self.tally.labels(), self.tally.fewest());
            self.pruned.weigh_area(most);
        }
    }

    /// The weights of the lines on the label's side of a sample and on the other. Where positions err, both weights are
    /// alike, as each hypothesis is [weighed](Self::told_by) for itself.
    fn weights(&self, reliability: Reliability) -> (Option<LogWeight>, Option<LogWeight>) {
        if self.is_blurred() {
            return (Some(LogWeight::ZERO), Some(LogWeight::ZERO));
        }
        (reliability.agree(), reliability.disagree())
    }

    /// The weights of a label on either side for a hypothesis. Where nobody knows the reliability, a doubtful label has the
    /// weights of the hypothesis's counts.
    fn weights_for(
        &self,
        hypothesis: &Hypothesis<E, R>,
        reliability: Reliability,
    ) -> (Option<LogWeight>, Option<LogWeight>) {
        if let Some(prior) = self.noise.reliability.unknown()
            && reliability != Reliability::CERTAIN
        {
            let [agree, disagree] = prior.weights(self.counts(hypothesis));
            return (Some(agree), Some(disagree));
        }
        self.weights(reliability)
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
    fn told_by(&self, hypothesis: &Hypothesis<E, R>, labels: &[Doubt]) -> LogWeight {
        if labels.is_empty() {
            return LogWeight::ZERO;
        }
        Blur::<E>::of(self.lines(hypothesis)).told(labels)
    }

    /// Drops the least likely hypotheses until there is room for those that a sample at `q` splits off.
    fn make_room(&mut self, q: Site) {
        // Exact cells tile the starting polygon, and a line crosses at most one more of them than
        // there are other lines.
        if self.outer_cells == 0 && self.table.len() + self.taken() < H {
            return;
        }
        let splits = |it: &Self, h: &Hypothesis<E, R>| it.certainty(h, q) == Certainty::Uncertain;
        let mut more = self.table.iter().filter(|h| splits(self, h)).count();
        while self.table.len() > 1 && self.table.len() + more > H {
            let weights = self.table.iter().map(Hypothesis::weight).enumerate();
            let Some((least, _)) = weights.min_by_key(|(_, weight)| *weight) else { return };
            let Some(gone) = self.table.swap_remove(least) else { return };
            more -= usize::from(splits(self, &gone));
            self.give_up(&gone);
        }
    }

    fn give_up(&mut self, gone: &Hypothesis<E, R>) {
        let (weight, area) = (gone.weight(), self.log_area(gone));
        self.tally.drop_with(gone.disagree());
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
        let (agree, disagree) = self.weights_for(&whole, reliability);
        let (before, newest_doubt) = doubts.split_at(doubts.len().saturating_sub(1));
        let Certainty::Certain(label) = self.certainty(&whole, newest.site) else {
            let weight = LogWeight::ZERO - self.prior_weight(&whole) - self.told_by(&whole, before);
            let opposite = Constraint::new(edge.index() as u8, -edge.label());
            let mut part = |edge, by| self.part(&whole, edge, weight + by, doubts);
            let mut parts = [agree.map(|by| part(edge, by)), disagree.map(|by| part(opposite, by))];
            if let [_, Some(opposed)] = &mut parts {
                opposed.count();
            }
            return self.replace(k, parts);
        };
        let told = self.told_by(&whole, newest_doubt);
        let weight = if label == edge.label() { agree } else { disagree };
        match (weight, self.table.get_mut(k)) {
            (Some(weight), Some(place)) => {
                place.weigh(weight + told);
                if label != edge.label() {
                    place.count();
                }
            }
            (None, Some(place)) => place.cell = DualCell::NONE,
            (_, None) => {}
        }
    }

    /// The weight of a hypothesis before any label. A cell's measure is the same each time it is computed, and so is
    /// the weight of its labels. So quotients lose nothing.
    fn prior_weight(&self, hypothesis: &Hypothesis<E, R>) -> LogWeight {
        match self.prior {
            Prior::Area => self.log_area(hypothesis),
            Prior::Sequences => LogWeight::ZERO,
        }
    }

    /// Puts the first part that there is in the place of the `k`-th hypothesis, and adds the other.
    fn replace(&mut self, k: usize, parts: [Option<Hypothesis<E, R>>; 2]) {
        let mut parts = parts.into_iter().flatten();
        if let (Some(kept), Some(place)) = (parts.next(), self.table.get_mut(k)) {
            *place = kept;
        }
        if let Some(split_off) = parts.next() {
            self.add(k, split_off);
        }
    }

    /// Adds what was split off the `k`-th hypothesis.
    fn add(&mut self, k: usize, split_off: Hypothesis<E, R>) {
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
        whole: &Hypothesis<E, R>,
        edge: Constraint,
        weight: LogWeight,
        doubts: &[Doubt],
    ) -> Hypothesis<E, R> {
        let mut part = *whole;
        if part.cell.cut(&self.samples, edge).is_err() {
            self.outer_cells = self.outer_cells.saturating_add(1);
        }
        part.weigh(weight + self.told_by(&part, doubts) + self.prior_weight(&part));
        part
    }
}
