//! Branch and bound over sequences of motions, on all cores.
//!
//! A partial sequence is dropped if its lower bound is above the best complete one known. At equal cost it is dropped
//! if its actions have the higher index. So the result does not depend on how the work is divided. It is the cheapest
//! sequence. Among those of equal (rounded) cost it is the first in the order of its actions.

use std::cmp::Ordering;
use std::sync::Mutex;
use std::sync::atomic::{self, AtomicI64, AtomicU64};

use anyhow::{Result, bail};
use planner_core::dynamics::Action;
use planner_core::{Reading, Sample};
use rayon::prelude::*;

use crate::output::notes::progress;
use crate::reference::instance::{Choice, Instance, Partial};
use crate::reference::relaxation::Relaxation;
use crate::world::in_order::in_order;

/// The least number of beginnings that are shared out to the cores, if there are as many.
const TASKS: usize = 1000;

/// Parts of sequences of each length that are followed to find a good sequence to begin with.
const BEAM: usize = 200;

/// Motions that a search may look at: some minutes on two cores.
pub const MOST_LOOKS: u64 = 3_000_000_000;

/// A sequence of motions and what it costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// The objective.
    pub cost: f64,
    /// Its actions.
    pub actions: Vec<Action>,
}

/// A beginning of a sequence.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    at: Partial,
    /// A lower bound on the cost of all sequences that begin like this.
    bound: f64,
    actions: Vec<Action>,
    /// The given samples, and those on the way.
    samples: Vec<Sample>,
}

/// One motion more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twig {
    at: Partial,
    /// What all sequences cost that go on like this, at least.
    bound: f64,
    action: Action,
    reading: Reading,
}

/// The state of a search.
pub(super) struct Search<'a> {
    instance: &'a Instance,
    relaxation: Relaxation<'a>,
    best: Mutex<Option<Sequence>>,
    /// The cost of the best sequence, as an integer of the same order.
    cost: AtomicI64,
    /// Motions that were looked at.
    looks: AtomicU64,
}

impl<'a> Search<'a> {
    /// A search that knows a good sequence, with the empty beginning; `None` if no sequence can keep the constraints.
    pub(super) fn begin(instance: &'a Instance) -> (Self, Option<Branch>) {
        let search = Self {
            instance,
            relaxation: Relaxation::of(instance),
            best: Mutex::new(None),
            cost: AtomicI64::new(in_order(f64::INFINITY)),
            looks: AtomicU64::new(0),
        };
        let root = search.root();
        if let Some(root) = &root {
            search.follow_best(root);
        }
        (search, root)
    }

    /// Goes through all sequences that begin like this, on all cores, with a progress bar on a terminal.
    ///
    /// # Errors
    /// Names the horizon if there are too many of them.
    pub(super) fn run(self, root: Branch) -> Result<Option<Sequence>> {
        let mut tasks = vec![root];
        while tasks.len() < TASKS && tasks.first().is_some_and(|task| task.at.left > 1) {
            tasks = tasks.iter().flat_map(|task| self.branches(task)).collect();
        }
        tasks.sort_by(Branch::by_bound);
        let bar = progress(tasks.len() as u64, "beginnings")?;
        tasks.into_par_iter().inspect(|_| bar.inc(1)).for_each(|task| self.descend(&task));
        bar.finish_and_clear();
        if self.is_too_long() {
            bail!(
                "--horizon: found {}, and no end after a look at {:.0e} motions, expected a shorter one or fewer \
                 actions (vehicle.step, vehicle.turn_step)",
                self.instance.horizon(),
                MOST_LOOKS as f64
            );
        }
        Ok(self.best.into_inner().ok().flatten())
    }

    fn root(&self) -> Option<Branch> {
        let at = self.instance.begin()?;
        let bound = self.instance.cost(&at, self.relaxation.least(&at)?);
        Some(Branch { at, bound, actions: Vec::new(), samples: self.instance.given().to_vec() })
    }

    /// Whether the search has used up its looks.
    fn is_too_long(&self) -> bool {
        self.looks.load(atomic::Ordering::Relaxed) > MOST_LOOKS
    }

    /// All motions from here that may lead to the best sequence, and how many were looked at.
    pub(super) fn twigs(&self, from: &Branch) -> (Vec<Twig>, u64) {
        let mut twigs = Vec::new();
        let looks = self.look(from, |twig| twigs.push(twig));
        (twigs, looks)
    }

    /// The same, in the order in which they are to be looked at.
    fn sorted_twigs(&self, from: &Branch) -> Vec<Twig> {
        let (mut twigs, _) = self.twigs(from);
        twigs.sort_by(|a, b| a.bound.total_cmp(&b.bound).then_with(|| a.action.cmp(&b.action)));
        twigs
    }

    /// Parts of sequences that are one motion longer.
    fn branches(&self, from: &Branch) -> Vec<Branch> {
        self.twigs(from).0.iter().map(|twig| from.followed_by(twig)).collect()
    }

    /// Calls `each` with every motion from here that may lead to the best sequence. Returns how many it has looked at.
    fn look(&self, from: &Branch, mut each: impl FnMut(Twig)) -> u64 {
        let (instance, at) = (self.instance, &from.at);
        let left = at.left - 1;
        let mut looks = 0;
        for &Choice { action, effort } in &instance.choices {
            let effort = at.effort + effort;
            // The line costs no less than before the motion.
            let at_least = |further| instance.cost(&Partial { effort, ..*at }, further);
            if in_order(at_least(0)) > self.cost.load(atomic::Ordering::Relaxed) {
                break; // and so do all choices after it
            }
            looks += 1;
            let Some(pose) = instance.target(at.pose, action) else { continue };
            let reading = instance.mission.world.reading(pose.site);
            let sum = at.sum + i32::from(reading.sign());
            let moved = Partial { pose, left, effort, sum, lines: at.lines };
            let Some(further) = self.relaxation.least(&moved) else { continue };
            // The line after it is looked at last, as that takes the longest.
            if self.is_beaten(at_least(further), from, action) {
                continue;
            }
            let Some(lines) = at.lines.with(&from.samples, pose.site, reading) else { continue };
            let at = Partial { lines, ..moved };
            let bound = instance.cost(&at, further);
            if !self.is_beaten(bound, from, action) {
                each(Twig { at, bound, action, reading });
            }
        }
        self.looks.fetch_add(looks, atomic::Ordering::Relaxed);
        looks
    }

    /// Whether no sequence that goes on with this action can be the best, if it costs at least `bound`.
    fn is_beaten(&self, bound: f64, from: &Branch, action: Action) -> bool {
        match in_order(bound).cmp(&self.cost.load(atomic::Ordering::Relaxed)) {
            Ordering::Less => false,
            Ordering::Greater => true,
            Ordering::Equal => {
                let best = self.best.lock().expect("no thread panicked");
                let beginning = from.actions.iter().chain([&action]);
                best.as_ref().is_some_and(|best| {
                    beginning.cmp(best.actions.iter().take(from.actions.len() + 1)).is_gt()
                })
            }
        }
    }

    /// Takes a whole sequence if it is the best so far.
    fn offer(&self, cost: f64, from: &Branch, action: Action) {
        let actions: Vec<_> = from.actions.iter().copied().chain([action]).collect();
        let mut best = self.best.lock().expect("no thread panicked");
        let is_better = best.as_ref().is_none_or(|best| {
            in_order(cost)
                .cmp(&in_order(best.cost))
                .then_with(|| actions.cmp(&best.actions))
                .is_lt()
        });
        if is_better {
            self.cost.store(in_order(cost), atomic::Ordering::Relaxed);
            *best = Some(Sequence { cost, actions });
        }
    }

    /// Looks at all sequences that begin like this, as far as they may be the best.
    fn descend(&self, from: &Branch) {
        if from.at.left == 1 {
            // No motion is left then, so the bound is the cost.
            self.look(from, |twig| self.offer(twig.bound, from, twig.action));
            return;
        }
        for twig in self.sorted_twigs(from) {
            if in_order(twig.bound) > self.cost.load(atomic::Ordering::Relaxed)
                || self.is_too_long()
            {
                return;
            }
            self.descend(&from.followed_by(&twig));
        }
    }

    /// Follows the most promising parts of sequences of each length, which makes a good one to begin with.
    fn follow_best(&self, root: &Branch) {
        let mut beam = vec![root.clone()];
        for _ in 1..root.at.left {
            let of = |branch| self.twigs(branch).0.into_iter().map(move |twig| (branch, twig));
            let mut longer: Vec<_> = beam.iter().flat_map(of).collect();
            longer.sort_by(|(_, a), (_, b)| a.bound.total_cmp(&b.bound)); // stable, so ties stay in order
            longer.truncate(BEAM);
            beam = longer.into_iter().map(|(branch, twig)| branch.followed_by(&twig)).collect();
        }
        for branch in &beam {
            self.descend(branch);
        }
    }
}

impl Branch {
    /// Motions left.
    pub(super) fn left(&self) -> u32 {
        self.at.left
    }

    pub(super) fn followed_by(&self, twig: &Twig) -> Self {
        let mut samples = self.samples.clone();
        if let Reading::Side(label) = twig.reading {
            samples.push(Sample { site: twig.at.pose.site, label });
        }
        let actions = self.actions.iter().copied().chain([twig.action]).collect();
        Self { at: twig.at, bound: twig.bound, actions, samples }
    }

    /// The order in which they are looked at: the most promising first.
    fn by_bound(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound).then_with(|| self.actions.cmp(&other.actions))
    }
}
