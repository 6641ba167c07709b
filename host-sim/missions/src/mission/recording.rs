//! A mission that is recorded, once: what each step was, what was expected of it, and what was known after it.
//!
//! Text, trace, flat rows, figures, pages and logs are made from the recording. None of them plans or observes again.

use anyhow::{Result, anyhow};
use nalgebra::Point2;
use planner_core::error::ObservationError;
use planner_core::parts::Hypothesis;
use planner_core::watch::{Alarm, Evidence};
use planner_core::{
    AnyReliability, Estimates, Line, Pose, PosteriorView, Prior, Reading, Reliability,
    ReliabilityEstimate, Sample, Site, Stage, Step, StopReason,
};

use crate::mission::allowance::tidy;
use crate::mission::definition::{Mission, SoughtLine, Table};
use crate::mission::diagnosis::DiagnosisRecord;
use crate::mission::flight::Flown;
use crate::mission::from_nothing::SeekRecord;
use crate::mission::front::{FrontTable, PassedRecord, VertexRecord};
use crate::mission::legs::{Leg, Legs};
use crate::mission::map::MapRecord;
use crate::mission::read_out::{Knowledge, LEVEL, ReadOut, is_unknown, rest};
use crate::mission::results::{
    AlarmRecord, BestRecord, CredibleRecord, End, Ending, EstimateRecords, FitRecord,
    KeepOutRecord, LineError, PTold, ReadingRecord, ReliabilityRecord, Results, Start, StepResult,
    VERSION, cost, mapped, recovery_name, stage_name,
};
use crate::mission::seeking::SeekTable;
use crate::mission::stop::{AuditRecord, GoalRecord};
use crate::mission::vehicle::VehicleTable;
use crate::world::World;

/// A mission that is over: its results, and what is known in the end.
#[derive(Debug)]
pub struct Recording {
    /// The mission.
    pub mission: Mission,
    /// The steps as the agent made them.
    pub steps: Vec<Step>,
    /// What came of it.
    pub results: Results,
    /// What was known before each step.
    pub before: Vec<Box<dyn ReadOut>>,
    /// What is known in the end.
    pub belief: Box<dyn ReadOut>,
}

/// A mission that is being recorded.
#[derive(Clone)]
pub struct Recorder {
    mission: Mission,
    steps: Vec<Step>,
    results: Vec<StepResult>,
    before: Vec<Box<dyn ReadOut>>,
    /// What is known now.
    belief: Box<dyn ReadOut>,
    /// What was read on the way of the step that is taken down next.
    passed: Vec<(Site, Reading)>,
    /// What the labels say against a straight, still line.
    evidence: Evidence,
    /// The most of it that was an alarm.
    alarm: Option<AlarmRecord>,
    /// A front is found where its half-width is below this, metres.
    width: Option<f32>,
}

impl Recorder {
    /// Nothing has happened yet.
    pub fn new(mission: Mission) -> Self {
        let belief = mission.belief();
        let (steps, results, before) = (Vec::new(), Vec::new(), Vec::new());
        let evidence = Evidence::NONE;
        let (passed, width) = (Vec::new(), mission.found_width());
        let read = (!mission.read_before.is_empty()).then(|| mission.clone());
        let mut it =
            Self { mission, steps, results, before, belief, passed, evidence, alarm: None, width };
        if let Some(mission) = read {
            mission.planner_told(&mut |known, site, reading| it.hear(known, site, reading));
        }
        it
    }

    /// Takes down what was read on the way of the step that comes next.
    pub fn pass(&mut self, passed: &[(Site, Reading)]) {
        self.passed = passed.to_vec();
    }

    /// Takes down a step, where the robot truly is after it, if it errs, and what is known.
    pub fn take(&mut self, step: &Step, true_pose: Option<Pose>, belief: &dyn ReadOut) {
        let Knowledge { slope_arcs, intercept, bits, doubt } = belief.knowledge();
        let motion = &step.motion;
        let before = std::mem::replace(&mut self.belief, belief.boxed());
        let (cost_before, metres_before) =
            self.last().map_or((0.0, 0.0), |last| (last.control_cost, last.metres));
        let reliability = belief.hypotheses().map(|table| table.reliability(step.pose.site));
        let readings = self.take_readings(step, &*before, belief);
        self.steps.push(*step);
        let alarm = self.evidence.alarm();
        let (number, most) = (self.steps.len(), self.alarm.map_or(0.0, |alarm| alarm.evidence));
        if let Some(Alarm { evidence, suspect }) = alarm.filter(|it| it.evidence > most) {
            self.alarm = Some(AlarmRecord { step: number, evidence, suspect });
        }
        // A front is sought anew then.
        if self.width.is_some() && alarm.is_some_and(|it| it.evidence >= Alarm::ALARM) {
            self.evidence = Evidence::NONE;
        }
        self.results.push(StepResult {
            step: self.steps.len(),
            problem: motion.stage.map(|stage| stage_name(stage).into()),
            recovery: motion.recovery.map(|recovery| recovery_name(recovery).into()),
            action: motion.into(),
            pose: step.pose.into(),
            target: (motion.target != step.pose).then(|| motion.target.into()),
            true_pose: true_pose.map(Into::into),
            label: step.reading.map(Reading::sign),
            readings,
            slope_arcs,
            intercept,
            bits,
            examined: motion.examined,
            proven: (!motion.proven).then_some(false),
            front: self.vertex(belief),
            mapped: self.mapped(belief),
            trusted: reliability.map(|it| it == Reliability::CERTAIN),
            hypotheses: doubt.map(|doubt| doubt.hypotheses),
            pruned_mass: doubt.map(|doubt| doubt.pruned_mass),
            entropy: doubt.map(|doubt| doubt.entropy),
            evidence: alarm.map(|alarm| alarm.evidence),
            flown: None,
            fact: self.fact(true_pose.unwrap_or(step.pose)),
            expected: motion.wants_label.then(|| before.expects(motion.target.site)),
            control_cost: cost_before + cost(motion.control),
            metres: metres_before + f64::from(motion.control.distance_m),
        });
        self.before.push(before);
    }

    /// Takes down the readings of a step, and what its labels say against the model. None are returned of a step that has
    /// one at most.
    fn take_readings(
        &mut self,
        step: &Step,
        before: &dyn ReadOut,
        after: &dyn ReadOut,
    ) -> Vec<ReadingRecord> {
        let passed = std::mem::take(&mut self.passed);
        let mut known = (!passed.is_empty()).then(|| before.boxed());
        let mut readings = Vec::new();
        for (site, reading) in passed {
            let Some(known) = &mut known else { break };
            let before = known.boxed();
            // The planner took it in, so this belief does.
            let taken = known.observe_on_the_way(site, reading);
            // As `Watched` counts.
            if taken != Ok(false) {
                self.hear(&*before, site, reading);
            }
            readings.push(ReadingRecord::of(site, reading, taken.unwrap_or(false)));
        }
        let known = known.as_deref().unwrap_or(before);
        if let Some(reading) = step.reading {
            self.hear(known, step.pose.site, reading);
        }
        if let Some(reading) = step.reading.filter(|_| !readings.is_empty()) {
            let support =
                |it: &dyn ReadOut| it.version_space().map(|it| it.support().collect::<Vec<_>>());
            let cuts = known.hypotheses().is_some() || support(known) != support(after);
            readings.push(ReadingRecord::of(step.pose.site, reading, cuts));
        }
        readings
    }

    /// Takes down what a label says against the model, where it says anything.
    fn hear(&mut self, known: &dyn ReadOut, site: Site, reading: Reading) {
        let front = known.front().map(|it| !it.is_begun());
        let may_be_nowhere = front.or_else(|| known.sought().map(SoughtLine::may_be_nowhere));
        if let (Reading::Side(label), None | Some(false)) = (reading, may_be_nowhere) {
            self.evidence.observe(label, known.chance_of(site, label));
        }
    }

    /// Where the front is known best, if it is found.
    fn vertex(&self, belief: &dyn ReadOut) -> Option<VertexRecord> {
        belief.front()?.found(self.width?).map(Into::into)
    }

    /// The places that the map has more, if a front is followed.
    fn mapped(&self, belief: &dyn ReadOut) -> Vec<PassedRecord> {
        let (mapped, step) = (belief.front().map_or(&[][..], |it| it.mapped()), self.steps.len());
        mapped.iter().map(|it| PassedRecord::of(*it, step)).collect()
    }

    /// What a perfect sensor reads at a pose at the end of the current step, if the boundary is known.
    fn fact(&self, at: Pose) -> Option<i8> {
        let world = self.mission.world.after(self.steps.len());
        world.is_known().then(|| world.reading(at.site).sign())
    }

    /// Takes down how a real vehicle made the steps so far.
    pub fn take_legs(&mut self, legs: &[Leg]) {
        for (step, leg) in self.results.iter_mut().zip(legs) {
            step.flown = Some(*leg);
        }
    }

    /// The mission.
    pub const fn mission(&self) -> &Mission {
        &self.mission
    }

    /// What is known now.
    pub fn belief(&self) -> &dyn ReadOut {
        &*self.belief
    }

    /// What the mission begins with.
    pub fn start(&self) -> Start {
        Start::of(&self.mission)
    }

    /// Steps so far.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// What came of the last of them.
    pub fn last(&self) -> Option<&StepResult> {
        self.results.last()
    }

    /// The error message for a sample that the planner refuses in the next step.
    pub fn refusal(&self, refused: &ObservationError) -> anyhow::Error {
        anyhow!("step {}: {}", self.steps.len() + 1, refusal(refused))
    }

    /// The mission is over.
    pub fn end(self, Flown { ending, belief }: Flown) -> Recording {
        let Self { mission, steps, results, before, alarm, .. } = self;
        let rest = belief.front().map(rest).unwrap_or_default();
        let rest: Vec<_> = rest.into_iter().map(|it| PassedRecord::of(it, steps.len())).collect();
        let doubted = belief.hypotheses().and_then(|table| doubted(table, &mission.world));
        let (best, credible) = doubted.unzip();
        let world = mission.world.after(steps.len());
        let estimates = match belief.front() {
            Some(_) => EstimateRecords::default(), // its map says it
            None => beside_truth(&mission, &world, belief.estimates()),
        };
        let seeks_line = mission.algorithm.seeks_line();
        let after: Vec<_> = before.iter().skip(1).chain([&belief]).map(|it| &**it).collect();
        let fit = || world.fit().filter(|_| world.line().is_none());
        let audit = audit((&steps, &results), &before, (ending, alarm.as_ref()));
        let is_by_alarm = audit.is_some_and(|it| it.is_by_alarm);
        // True labels on both sides of the line, at both its ends, prove it: what spoke against it was chance.
        let is_proven = ending == Ending::Stopped(StopReason::Known)
            && !mission.is_noisy()
            && audit.is_some_and(|it| it.refuted.is_none());
        let alarm = alarm.filter(|_| !is_proven);
        let diagnosis = || {
            let why = (ending, alarm.as_ref(), is_by_alarm);
            DiagnosisRecord::of(&mission, (&steps, &results), why, &*belief)
        };
        let is_alarmed = alarm.as_ref().is_some_and(|it| it.evidence >= Alarm::ALARM);
        let has_ended = |reason| ending == Ending::Stopped(reason);
        let map = || {
            MapRecord::of(&mapped(&results, &rest), &mission.world, has_ended(StopReason::Closed))
        };
        let labels: Vec<_> = results
            .iter()
            .scan(0, |labels, it| {
                *labels += it.passed().count() + usize::from(it.label.is_some());
                Some((*labels, it.metres))
            })
            .collect();
        let end = End {
            reason: ending.name().into(),
            mapped: rest.clone(),
            estimates,
            fit: seeks_line
                .then(fit)
                .flatten()
                .map(|fit| Box::new(FitRecord::beside(fit, &estimates))),
            best,
            credible,
            reliability: belief.hypotheses().filter(|it| is_unknown(it)).map(learnt),
            front: (!seeks_line).then(map),
            seek: SeekRecord::of(
                &mission,
                &labels,
                &after,
                (&read(&mission, &results, &steps), has_ended(StopReason::OneLabel)),
            ),
            goal: GoalRecord::of(&mission, &*belief, audit, is_alarmed),
            alarm,
            diagnosis: seeks_line.then(diagnosis).flatten().map(Box::new),
            flown: Legs::of(&results.iter().filter_map(|step| step.flown).collect::<Vec<_>>()),
        };
        let results = Results { start: Start::of(&mission), steps: results, end };
        Recording { mission, steps, results, before, belief }
    }
}

impl Recording {
    /// Flies a mission and records it.
    ///
    /// # Errors
    /// Names the sample that the planner refused.
    pub fn of(mission: &Mission) -> Result<Self> {
        let (recording, refusal) = Self::until_refusal(mission);
        refusal.map_or(Ok(recording), Err)
    }

    /// What was known at the start and after each step.
    pub fn known(&self) -> impl Iterator<Item = &dyn ReadOut> {
        self.before.iter().chain([&self.belief]).map(|belief| &**belief)
    }

    /// Flies a mission and records it as far as it goes. The error names the sample that the planner refused, if one
    /// broke the mission off.
    pub fn until_refusal(mission: &Mission) -> (Self, Option<anyhow::Error>) {
        Self::until_refusal_watched(mission, |_| ())
    }

    /// The same; `watch` sees all that is recorded after each step.
    pub fn until_refusal_watched(
        mission: &Mission,
        mut watch: impl FnMut(&Recorder),
    ) -> (Self, Option<anyhow::Error>) {
        let mut recorder = Recorder::new(mission.clone());
        let (flown, refused) = mission.fly_in_sight(|step, sight, belief| {
            recorder.pass(sight.passed);
            recorder.take(step, sight.true_pose, belief);
            watch(&recorder);
        });
        let refusal = refused.map(|it| recorder.refusal(&it));
        (recorder.end(flown), refusal)
    }
}

/// Why a sample is refused, in the words of scenario files.
pub fn refusal(refused: &ObservationError) -> String {
    let ObservationError::Contradiction(sample) = refused else { return refused.to_string() };
    let (at, label) = (Point2::<f64>::from(sample.site).map(tidy), sample.label.sign());
    format!(
        "label {label} at ({}, {}) contradicts the region of certainty it lies in: `tolerance` allows for positions that \
         err, `noise` for labels that are wrong",
        at.x, at.y,
    )
}

/// All labels, in order: those that were read before, and those of some steps.
fn read(mission: &Mission, results: &[StepResult], steps: &[Step]) -> Vec<Sample> {
    let of_step = |(result, step): (&StepResult, &Step)| {
        let end = step.reading.map(|it| (step.pose.site, it));
        result.passed().chain(end).collect::<Vec<_>>()
    };
    let sample = |(site, reading)| match reading {
        Reading::Side(label) => Some(Sample { site, label }),
        Reading::Boundary => None,
    };
    let before = mission.read_before.iter().copied();
    before.chain(results.iter().zip(steps).flat_map(of_step)).filter_map(sample).collect()
}

/// Estimates of a mission's line, each beside its world as that is at the time. Degrees are those to the true line, or to
/// the line that misclassifies least.
pub fn beside_truth(mission: &Mission, world: &World, estimates: Estimates) -> EstimateRecords {
    let error = |line: &Line| {
        Some(LineError {
            degrees: line.angle_to_deg(&world.fit()?.line),
            misclassified: world.misclassified(mission.config.area, line)?,
        })
    };
    EstimateRecords::beside(estimates, error)
}

impl Start {
    /// What a mission begins with.
    pub fn of(mission: &Mission) -> Self {
        Self {
            version: VERSION,
            algorithm: mission.algorithm,
            seed: mission.seed,
            varrho: mission.config.weight.value(),
            area: mission.config.area.into(),
            keep_out: mission.config.area.hulls().map(KeepOutRecord::from).collect(),
            oracle: mission.oracle().iter().map(Into::into).collect(),
            samples: mission.read_before.iter().map(Into::into).collect(),
            bounds: (!mission.bounds.is_empty()).then_some(mission.bounds),
            vehicle: VehicleTable::of(mission.vehicle),
            tolerance: mission.tolerance_record(),
            pose: mission.start.into(),
            truth: mission.world.line().map(|line| (*line).into()),
            boundary: mission.world.record(),
            sensor: mission.sensor.iter().map(Into::into).collect(),
            p: mission.noise.map_or(1.0, |noise| noise.p),
            p_told: mission.p_told.map(PTold::from),
            price: mission.asking.price,
            labels: mission.asking.labels,
            worth: (mission.asking.worth > 0.0).then_some(mission.asking.worth),
            labels_err: mission.noise.is_some(),
            readings: (mission.readings > 1).then_some(mission.readings),
            steps: mission.steps,
            seek: SeekTable::of(mission.seeking),
            front: (!mission.algorithm.seeks_line())
                .then(|| FrontTable::told(mission.front, mission.watch)),
            slope_arcs: mission
                .given
                .lines()
                .map_or(vec![[-90.0, 90.0]], |lines| lines.slope_arc().intervals_deg().to_vec()),
        }
    }
}

/// What the audit of a mission came to, by its steps, their results, what was known before each, and the alarm.
fn audit(
    (steps, results): (&[Step], &[StepResult]),
    before: &[Box<dyn ReadOut>],
    (ending, alarm): (Ending, Option<&AlarmRecord>),
) -> Option<AuditRecord> {
    let of_audit = || (0..steps.len()).filter(|k| steps[*k].motion.stage == Some(Stage::Audit));
    let agrees = |k: &usize| {
        let Some(Reading::Side(label)) = steps[*k].reading else { return None };
        Some(before[*k].chance_of(steps[*k].pose.site, label) > 0.5)
    };
    let is_refuted = ending == Ending::Stopped(StopReason::NoLine);
    let is_by_label = of_audit().next_back().is_some_and(|k| agrees(&k) == Some(false));
    let is_grave = alarm.is_some_and(|it| it.evidence >= Alarm::ALARM);
    let is_by_alarm = is_refuted && is_grave && !is_by_label;
    if of_audit().next().is_none() && !is_by_alarm {
        return None;
    }
    let labels = of_audit().filter_map(|k| agrees(&k));
    let (labels, agreed) = (labels.clone().count(), labels.filter(|it| *it).count());
    let metres = |k: usize| results[k].metres - k.checked_sub(1).map_or(0.0, |k| results[k].metres);
    Some(AuditRecord {
        agreed,
        disagreed: before.first()?.hypotheses().map(|_| labels - agreed),
        refuted: is_refuted.then_some(steps.len()),
        is_by_alarm,
        motions: of_audit().count(),
        metres: of_audit().map(metres).sum(),
    })
}

/// What labels have shown of a reliability that nobody knows.
fn learnt(table: &Table) -> ReliabilityRecord {
    let ReliabilityEstimate { mean, deviation } = PosteriorView::new(table).reliability();
    ReliabilityRecord { mean, deviation }
}

/// What labels that may err come to: the paper's outcome by the paper's prior, and the credible set by the chosen one.
fn doubted(table: &Table, world: &World) -> Option<(BestRecord, CredibleRecord)> {
    let holds =
        |hypothesis: &Hypothesis<15, AnyReliability>| world.is_among(table.lines(hypothesis));
    let by_sequences = table.weighed_by(Prior::Sequences);
    let best = PosteriorView::new(&by_sequences).best()?;
    let posterior = PosteriorView::new(table);
    let credible = posterior.credible(LEVEL);
    let members: Option<Vec<bool>> = posterior.members(&credible).map(holds).collect();
    let best = BestRecord {
        slope_arcs: best.slope_arc.intervals_deg().to_vec(),
        intercept: best.intercept,
        probability: best.probability,
        holds: holds(best.hypothesis),
    };
    let credible = CredibleRecord {
        level: credible.level,
        slope_arcs: credible.slope_arc.intervals_deg().to_vec(),
        intercept: credible.intercept,
        probability: credible.probability,
        cells: Some(credible.cells),
        hypotheses: table.iter().len(),
        holds: members.map(|members| members.contains(&true)),
    };
    Some((best, credible))
}
