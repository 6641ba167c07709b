//! A campaign: one mission in each of many standard fields, on all cores, and what is measured of it.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result};
use indicatif::{ParallelProgressIterator as _, ProgressBar, ProgressStyle};
use planner_core::belief::sample::Reading;
use planner_core::belief::tolerance::Tolerance;
use planner_core::belief::weight::Prior;
use planner_core::motion::any_vehicle::AnyVehicle;
use planner_core::planner::config::{Crossing, Following};
use planner_core::planner::scc::Policy;
use planner_core::robot::agent::Step;
use rayon::prelude::*;

use crate::campaign::standard_field;
use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::flight::Flown;
use crate::mission::read_out::ReadOut;
use crate::mission::results::{cost, recovery_name};
use crate::mission::scenario;
use crate::mission::vehicle::{self, Source};
use crate::world::errors::Errors;
use crate::world::noise::NoiseModel;

/// What to run.
#[derive(Clone, Copy, Debug)]
pub struct Campaign {
    /// Who plans.
    pub algorithm: Algorithm,
    /// Number of standard fields.
    pub fields: u64,
    /// Steps in each.
    pub steps: u32,
    /// Seed of the ensemble.
    pub seed: u64,
    /// How P1 looks for the opposite label.
    pub crossing: Crossing,
    /// How P2 follows the boundary.
    pub following: Following,
    /// What moves.
    pub vehicle: AnyVehicle,
    /// How labels are flipped; `None` when they are true.
    pub noise: Option<NoiseModel>,
    /// How robots err.
    pub errors: Errors,
    /// What planners are told of that.
    pub tolerance: Tolerance,
    /// How hypotheses choose an action together.
    pub policy: Policy,
    /// How they are weighed in that.
    pub prior: Prior,
}

/// How far a mission has come.
#[derive(Clone, Copy, Debug, Default)]
pub struct Progress {
    /// The field's number.
    pub field: u64,
    /// Steps made.
    pub steps: u32,
    /// Labels taken in.
    pub labels: u32,
    /// Control cost.
    pub control_cost: f64,
    /// Metres travelled.
    pub metres: f64,
}

/// What is measured of every mission of a campaign.
pub trait Measure: Sync {
    /// What is taken down at some stage of a mission.
    type Checkpoint: Send;

    /// The stages at which missions of so many steps are compared, in rising order.
    fn stages(&self, steps: u32) -> Vec<u32>;

    /// The stage that a mission has come to.
    fn stage(&self, progress: &Progress) -> u32;

    /// What is taken down when a mission comes to one of these stages.
    fn checkpoint(
        &self,
        mission: &Mission,
        belief: &dyn ReadOut,
        progress: &Progress,
    ) -> Self::Checkpoint;

    /// How far a mission that ended is to be taken to have come at a stage that it did not reach;
    /// `None` if it does not count there.
    fn held(&self, end: &Progress, stage: u32) -> Option<Progress>;
}

/// What came of a campaign.
#[derive(Clone, Debug)]
pub struct Ensemble<M> {
    /// What was taken down of each mission.
    pub checkpoints: Vec<Vec<M>>,
    /// How the missions went.
    pub tally: Tally,
}

/// How missions went.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// How many ended for which reason.
    pub ends: BTreeMap<&'static str, u64>,
    /// How many steps climbed to which rung of the recovery ladder.
    pub recoveries: BTreeMap<&'static str, u64>,
    /// Motions planned.
    pub plans: u64,
    /// Actions whose position they looked at.
    pub examined: u64,
    /// The most that one plan looked at.
    pub most_examined: u32,
}

impl Tally {
    fn count(&mut self, step: &Step) {
        self.plans += 1;
        self.examined += u64::from(step.motion.examined);
        self.most_examined = self.most_examined.max(step.motion.examined);
        if let Some(recovery) = step.motion.recovery {
            *self.recoveries.entry(recovery_name(recovery)).or_default() += 1;
        }
    }

    fn add(&mut self, other: Self) {
        for (mine, theirs) in
            [(&mut self.ends, other.ends), (&mut self.recoveries, other.recoveries)]
        {
            for (name, count) in theirs {
                *mine.entry(name).or_default() += count;
            }
        }
        self.plans += other.plans;
        self.examined += other.examined;
        self.most_examined = self.most_examined.max(other.most_examined);
    }
}

impl Campaign {
    /// Runs all fields on all cores, with a progress bar on a terminal.
    ///
    /// # Errors
    /// When the vehicle cannot move in the standard area. Names the field in which a sample contradicted what was
    /// known: never, as labels are true where they are trusted.
    pub fn run<M: Measure>(&self, measure: &M) -> Result<Ensemble<M::Checkpoint>> {
        vehicle::check_room(Source::Flags, &self.vehicle, &self.mission(0).config)?;
        let style = "{msg}  {bar:40} {pos}/{len} fields  {per_sec}  {eta} left";
        let bar = ProgressBar::new(self.fields)
            .with_style(ProgressStyle::with_template(style)?)
            .with_message(self.algorithm.title());
        let of_each: Vec<_> = (0..self.fields)
            .into_par_iter()
            .progress_with(bar.clone())
            .map(|number| self.measured(measure, number).with_context(|| format!("field {number}")))
            .collect::<Result<_>>()?;
        bar.finish_and_clear();
        let mut ensemble = Ensemble { checkpoints: Vec::new(), tally: Tally::default() };
        for (checkpoints, tally) in of_each {
            ensemble.checkpoints.push(checkpoints);
            ensemble.tally.add(tally);
        }
        Ok(ensemble)
    }

    /// The mission in the field with this number.
    fn mission(&self, number: u64) -> Mission {
        let mut mission = standard_field::standard(self.seed, number, self.algorithm, self.steps);
        (mission.config.crossing, mission.config.following) = (self.crossing, self.following);
        (mission.vehicle, mission.errors) = (self.vehicle, self.errors);
        mission.config.tolerance = self.tolerance;
        (mission.noise, mission.policy, mission.prior) = (self.noise, self.policy, self.prior);
        mission
    }

    fn measured<M: Measure>(
        &self,
        measure: &M,
        number: u64,
    ) -> Result<(Vec<M::Checkpoint>, Tally)> {
        let mission = self.mission(number);
        let (tolerance, area) = (mission.config.tolerance, mission.config.area);
        scenario::check_tolerance("--tolerance", tolerance, &mission.given, &area)?;
        let (mut checkpoints, mut tally) = (Vec::new(), Tally::default());
        let mut now = Progress { field: number, ..Progress::default() };
        let mut stages = measure.stages(self.steps).into_iter().peekable();
        let Flown { ending, belief } = mission.fly(|step, belief| {
            now.steps += 1;
            now.labels += u32::from(matches!(step.reading, Some(Reading::Side(_))));
            now.control_cost += cost(step.motion.control);
            now.metres += f64::from(step.motion.control.v);
            if stages.next_if_eq(&measure.stage(&now)).is_some() {
                checkpoints.push(measure.checkpoint(&mission, belief, &now));
            }
            tally.count(step);
        })?;
        let held = stages.filter_map(|stage| measure.held(&now, stage));
        checkpoints.extend(held.map(|progress| measure.checkpoint(&mission, &*belief, &progress)));
        tally.ends.insert(ending.name(), 1);
        Ok((checkpoints, tally))
    }
}
