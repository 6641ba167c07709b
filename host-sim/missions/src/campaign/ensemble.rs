//! A campaign: one mission in each of many standard fields, on all cores, and what is measured of it.

use std::fmt::Debug;
use std::ops::Range;
use std::vec;

use anyhow::{Context as _, Result};
use planner_core::{
    AnyReliability, AnyVehicle, Crossing, Following, Policy, Prior, Reading, Tolerance,
};
use rayon::prelude::*;
use serde::Serialize;

use crate::campaign::course::Course;
use crate::campaign::drawn;
use crate::campaign::standard_field::{self, SIDE_M};
use crate::mission::algorithm::Algorithm;
use crate::mission::asking::Asking;
use crate::mission::definition::Mission;
use crate::mission::flight::Flown;
use crate::mission::given::Given;
use crate::mission::read_out::ReadOut;
use crate::mission::results::cost;
use crate::mission::scenario;
use crate::mission::vehicle::{self, Source};
use crate::output::notes::{ProgressBar, progress};
use crate::world::errors::Errors;
use crate::world::noise::NoiseModel;

/// Missions of a core in a block. With fewer, cores would wait for each other; with more, memory would hold more rows.
const BLOCK: u64 = 256;

/// What to run.
#[derive(Clone, Copy, Debug)]
pub struct Campaign {
    /// Who plans.
    pub algorithm: Algorithm,
    /// Number of standard fields.
    pub fields: u64,
    /// Steps in each.
    pub steps: u32,
    /// Readings of each motion, the label at its end included.
    pub readings: u32,
    /// Whether missions are measured after every step or label, and not only at the stages of the tables.
    pub every: bool,
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
    /// How often labels are true, as planners are told, if that is not the `p` of the noise.
    pub p_told: Option<AnyReliability>,
    /// Whether the `p` of each field's noise is drawn from the prior that planners are told.
    pub draws_p: bool,
    /// How robots err.
    pub errors: Errors,
    /// The tolerance of the planners.
    pub tolerance: Tolerance,
    /// How hypotheses choose an action together.
    pub policy: Policy,
    /// How hypotheses are weighed.
    pub prior: Prior,
    /// The sides of the fields, metres.
    pub sides: [f64; 2],
    /// Whether planners are given no points: they first seek the line.
    pub from_nothing: bool,
    /// What labels cost, what they are to bring, and how many there may be.
    pub asking: Asking,
}

/// How many readings a motion has, for titles; nothing if it is one.
pub fn readings_told(readings: Option<u32>) -> String {
    readings.map_or(String::new(), |readings| format!(", {readings} readings a motion"))
}

/// How far a mission has come.
#[derive(Clone, Copy, Debug, Default)]
pub struct Progress {
    /// The field's number.
    pub field: u64,
    /// Steps made.
    pub steps: u32,
    /// Labels taken in at the ends of motions.
    pub labels: u32,
    /// Bits that all labels were expected to carry, each by the belief before it, if the measure wants that.
    pub expected_bits: f64,
    /// Control cost.
    pub control_cost: f64,
    /// Metres travelled.
    pub metres: f64,
}

/// What a campaign measures. A *stage* is a number of steps or labels after which missions are compared.
pub trait Measure: Sync {
    /// What is taken down at some stage of a mission.
    type Checkpoint: Clone + Debug + Default + Send + Serialize;

    /// Whether it wants [`Progress::expected_bits`].
    const WANTS_EXPECTED: bool;

    /// The stages at which missions of so many steps are compared, in rising order.
    fn stages(&self, steps: u32) -> Vec<u32>;

    /// The stage that a mission has come to.
    fn stage(&self, progress: &Progress) -> u32;

    /// The row of a mission at one of these stages; `None` if it does not count.
    fn checkpoint(
        &self,
        mission: &Mission,
        belief: &dyn ReadOut,
        progress: &Progress,
    ) -> Option<Self::Checkpoint>;

    /// The progress that counts for a mission at a stage that it did not reach, as it ended before; `None` if it does
    /// not count there.
    fn held(&self, end: &Progress, stage: u32) -> Option<Progress>;
}

/// A row: what was known at some stage of a mission, and how it had gone so far.
#[derive(Clone, Debug)]
pub struct Measured<C> {
    /// What was known.
    pub checkpoint: C,
    /// How it had gone.
    pub course: Course,
}

impl Campaign {
    /// A planner with its usual settings in 1,000 standard fields of seed 1, with true labels: so many steps in each.
    pub fn of(algorithm: Algorithm, steps: u32) -> Self {
        Self {
            algorithm,
            fields: 1_000,
            steps,
            readings: 1,
            every: false,
            seed: 1,
            crossing: Crossing::default(),
            following: algorithm.following(),
            vehicle: algorithm.grid().into(),
            noise: None,
            p_told: None,
            draws_p: false,
            errors: Errors::default(),
            tolerance: Tolerance::NONE,
            policy: Policy::default(),
            prior: Prior::default(),
            sides: [SIDE_M; 2],
            from_nothing: false,
            asking: Asking::USUAL,
        }
    }

    /// Flies all fields on all cores, with a progress bar on a terminal.
    ///
    /// # Errors
    /// As [`fly`](Self::fly).
    pub fn run<'a, M: Measure>(&'a self, measure: &'a M) -> Result<Flight<'a, M>> {
        self.fly(measure, 0..self.fields)
    }

    /// Flies a block of fields.
    ///
    /// # Errors
    /// When the vehicle cannot move in the standard area.
    pub fn fly<'a, M: Measure>(
        &'a self,
        measure: &'a M,
        block: Range<u64>,
    ) -> Result<Flight<'a, M>> {
        self.check()?;
        let bar = progress(block.end - block.start, "fields")?.with_message(self.algorithm.title());
        Ok(Flight { campaign: self, measure, left: block, flown: Vec::new().into_iter(), bar })
    }

    /// The readings of a motion, if there are several.
    pub(super) fn several_readings(&self) -> Option<u32> {
        Some(self.readings).filter(|it| *it > 1)
    }

    /// Whether the vehicle can move in the standard area.
    ///
    /// # Errors
    /// Names it, the area, and how much it needs.
    pub fn check(&self) -> Result<()> {
        vehicle::check_room(Source::Flags, &self.vehicle, &self.mission(0).config)
    }

    /// The mission in the field with this number.
    pub fn mission(&self, number: u64) -> Mission {
        let (seed, algorithm, steps) = (self.seed, self.algorithm, self.steps);
        let mut mission = standard_field::stretched(self.sides, seed, number, algorithm, steps);
        mission.asking = self.asking;
        if self.from_nothing {
            mission.given = Given::open(Vec::new());
        }
        (mission.config.crossing, mission.config.following) = (self.crossing, self.following);
        (mission.vehicle, mission.errors) = (self.vehicle, self.errors);
        mission.config.tolerance = self.tolerance;
        (mission.noise, mission.policy, mission.prior) = (self.noise, self.policy, self.prior);
        (mission.p_told, mission.readings) = (self.p_told, self.readings);
        if let (true, Some(prior), Some(noise)) =
            (self.draws_p, mission.unknown_p(), mission.noise.as_mut())
        {
            noise.p = drawn::p(prior, mission.seed);
        }
        mission
    }

    /// Its last stage: so many labels, if they are limited, or steps.
    pub fn length(&self) -> u32 {
        self.asking.labels.unwrap_or(self.steps)
    }

    /// The stages at which its missions have rows.
    pub fn stages<M: Measure>(&self, measure: &M) -> Vec<u32> {
        if self.every { (1..=self.length()).collect() } else { measure.stages(self.length()) }
    }

    /// The rows of a field.
    fn measured<M: Measure>(
        &self,
        measure: &M,
        number: u64,
    ) -> Result<Vec<Measured<M::Checkpoint>>> {
        let mission = self.mission(number);
        let (tolerance, area) = (mission.config.tolerance, mission.config.area);
        let words = || format!("{} m", tolerance.metres());
        scenario::check_tolerance("--tolerance", tolerance, words, mission.given.lines(), &area)?;
        let (mut rows, mut course) = (Vec::new(), Course::default());
        let mut now = Progress { field: number, ..Progress::default() };
        let mut stages = self.stages(measure).into_iter().peekable();
        let mut before = M::WANTS_EXPECTED.then(|| mission.belief());
        let (Flown { ending, belief }, refused) = mission.fly_in_sight(|step, sight, belief| {
            now.steps += 1;
            let is_label = matches!(step.reading, Some(Reading::Side(_)));
            now.labels += u32::from(is_label);
            if let Some(before) = before.as_mut().filter(|_| is_label || !sight.passed.is_empty()) {
                for &(site, reading) in sight.passed {
                    let bits = before.expects(site).bits;
                    // The planner took it in, so this belief does.
                    if before.observe_on_the_way(site, reading) == Ok(true) {
                        now.expected_bits += bits;
                    }
                }
                if is_label {
                    now.expected_bits += before.expects(step.pose.site).bits;
                }
                *before = belief.boxed();
            }
            now.control_cost += cost(step.motion.control);
            now.metres += f64::from(step.motion.control.distance_m);
            course.count(step);
            if stages.next_if_eq(&measure.stage(&now)).is_some() {
                let checkpoint = measure.checkpoint(&mission, belief, &now);
                let row = checkpoint.map(|it| Measured { checkpoint: it, course: course.clone() });
                rows.extend(row);
            }
        });
        refused.map_or(Ok(()), Err)?;
        let held = stages.filter_map(|stage| measure.held(&now, stage));
        rows.extend(held.filter_map(|progress| {
            let checkpoint = measure.checkpoint(&mission, &*belief, &progress)?;
            Some(Measured { checkpoint, course: course.clone() })
        }));
        for row in &mut rows {
            ending.name().clone_into(&mut row.course.ended);
        }
        Ok(rows)
    }
}

/// A campaign that is being flown. It returns the rows in the order of the fields, or an error that names the field in
/// which a sample contradicted what was known. That happens only where robots err by more than the tolerance, as labels
/// are true where they are trusted.
#[derive(Debug)]
pub struct Flight<'a, M: Measure> {
    campaign: &'a Campaign,
    measure: &'a M,
    /// The fields that are still to be flown.
    left: Range<u64>,
    /// The rows of those flown last.
    flown: vec::IntoIter<Measured<M::Checkpoint>>,
    bar: ProgressBar,
}

impl<M: Measure> Flight<'_, M> {
    /// The rows of the next fields, flown on all cores.
    fn next_block(&mut self) -> Result<Vec<Measured<M::Checkpoint>>> {
        let fields = BLOCK * rayon::current_num_threads() as u64;
        let block = self.left.start..self.left.end.min(self.left.start.saturating_add(fields));
        self.left.start = block.end;
        let rows = block.into_par_iter().map(|number| {
            let rows = self.campaign.measured(self.measure, number);
            self.bar.inc(1);
            rows.with_context(|| format!("field {number}"))
        });
        let rows = rows.collect::<Result<Vec<_>>>()?;
        Ok(rows.into_iter().flatten().collect())
    }
}

impl<M: Measure> Iterator for Flight<'_, M> {
    type Item = Result<Measured<M::Checkpoint>>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(row) = self.flown.next() {
                return Some(Ok(row));
            }
            if self.left.is_empty() {
                self.bar.finish_and_clear();
                return None;
            }
            match self.next_block() {
                Ok(rows) => self.flown = rows.into_iter(),
                Err(error) => {
                    self.left.start = self.left.end;
                    return Some(Err(error));
                }
            }
        }
    }
}
