//! Look-ahead: the motion whose label, and the one after it, are expected to tell the most for their cost.
//!
//! A label tells most where it is as likely to be +1 as -1. Among the ends of all motions such places lie along a
//! curve. An agent can stay on this curve and avoid ends from which the next motion cannot reach it. It then learns
//! nearly as much as an agent that jumps anywhere. So a plan
//!
//! 1. looks for the motions whose ends are worth the most: the expected information of the label there, as a share of
//!    the most that a label can carry, less the [price](DrivingPrice) of `|u|^2`;
//! 2. looks one step further from the best of them, after either label, and makes the motion with the greatest worth of
//!    both steps together;
//! 3. considers turns in place as well, if no end is worth much;
//! 4. climbs the recovery ladder, as Algorithm 1 does, if there is no such motion.
//!
//! With a [`Goal`] it stops when that is met, after an [audit](crate::watch::Audit).
//!
//! The search is anytime: a plan evaluates at most [`EVALUATIONS`] ends and keeps the best found so far. The order of
//! the ends does not depend on the limit. So a higher limit never gives a worse motion by the plan's own measure.
//!
//! Look-ahead learns from a [`PredictiveBelief`]: the version space where labels are true, a [`NoisyBelief`] where they
//! may be wrong.

use crate::belief::Belief as _;
use crate::belief::ObservationError;
use crate::belief::goal::{Criterion, Goal, NoGoal};
use crate::belief::noise::Noise;
use crate::belief::observation_log::{FromLog, ReplayError};
use crate::belief::predictions::{NoisyBelief, Prediction as _, PredictiveBelief, Verdicts as _};
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::weight::Prior;
use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::audit::Audit;
use crate::planner::decision::Decision;
use crate::planner::setup::{Restart, SetupError, aimed_for, aimed_for_by};
use crate::planner::sight::{Near, Sight};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Kind, Persist, RestoreError, Snapshot, mark};
use crate::planner::{Motion, Plan, Planner, Stage, StopReason};
use crate::search::course::Course;
use crate::search::dead_end::{DeadEnd, is_broad};
use crate::search::direction_rule::ArcRule;
use crate::search::errand::Errand;
use crate::search::lookout::Lookout;
use crate::search::objective::{Effort, EffortWeight, LOOKS};
use crate::search::problem::Problem;
use crate::search::recovery::{Found, solve_or_recover};

/// What look-ahead pays for driving: in shares of a label for a unit of `|u|^2`, in [0, 1), to six decimal places.
///
/// A unit is a drive of a metre, or a turn of a radian. Lengths are scaled: the longest motion that plans usually
/// consider counts as 2 m, the paper's longest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DrivingPrice(EffortWeight);

impl DrivingPrice {
    /// With this price look-ahead works best. A drive of 2 m costs 0.008 labels.
    pub const USUAL: Self = Self(EffortWeight { millionths: 2_000 });

    /// The nearest price.
    ///
    /// # Errors
    /// [`ValueError`] outside [0, 1).
    pub fn new(value: f64) -> Result<Self, ValueError> {
        EffortWeight::new(value)
            .map(Self)
            .map_err(|_| ValueError("a price of driving is from 0 to below 1"))
    }

    /// The price as a number.
    pub fn value(self) -> f64 {
        self.0.value()
    }
}

/// The same number: on the wire one serves for either.
impl From<EffortWeight> for DrivingPrice {
    fn from(weight: EffortWeight) -> Self {
        Self(weight)
    }
}

impl From<DrivingPrice> for EffortWeight {
    fn from(DrivingPrice(weight): DrivingPrice) -> Self {
        weight
    }
}

impl Default for DrivingPrice {
    fn default() -> Self {
        Self::USUAL
    }
}

/// The most ends of motions that a plan evaluates. A plan needs some 100. Of 1,000 standard fields none needs more than
/// this limit in its first 30 steps. After that, 2 in 100 end because the limit is reached, as the strip of uncertain
/// ground is thinner than the lattice.
pub const EVALUATIONS: u32 = 512;

/// Motions are usually no longer than this part of the mean of the area's sides. Longer ones tell nothing more. They
/// also end near the border, where less is in reach.
const USUAL: f32 = 0.125;

/// The least expected information of a label that is worth its way, as a share of the most that a label can carry.
const LEAST: f32 = 0.15;

/// The look-ahead planner: `D` is the vehicle, `B` the belief that it learns from, `G` the area, and `C` what its
/// [`Goal`] asks of the line.
///
/// A plan looks two labels ahead.
#[derive(Clone, Debug)]
pub struct Lookahead<D, B: PredictiveBelief, G = Area, C = NoGoal, S: Sight = Near> {
    /// Where motions aim for.
    area: G,
    price: DrivingPrice,
    /// The rectangle around all of the area.
    bounds: Area,
    dynamics: D,
    belief: B,
    evaluations: u32,
    sight: S,
    goal: Option<Goal<C>>,
    /// What is seen before the goal's promise is made; `None` if it is made at once.
    audit: Option<Audit<B::Verdicts>>,
    silence: Silence,
    journey: S::Journey,
}

impl<D: Dynamics, B: PredictiveBelief, G: Workspace> Lookahead<D, B, G> {
    /// A planner with what is known so far.
    ///
    /// Motions end where the belief's tolerance cannot bring the robot out of the area.
    ///
    /// # Errors
    /// [`SetupError`].
    #[inline] // it is made where it stays, as it may be large
    pub fn new(area: G, dynamics: D, belief: B) -> Result<Self, SetupError> {
        let area = aimed_for_by(area, &dynamics, belief.belief())?;
        Ok(Self::of((area, dynamics), belief, None))
    }
}

impl<D: Dynamics, B: PredictiveBelief, G: Workspace, C: Criterion> Lookahead<D, B, G, C> {
    /// The same in the part of an area that motions [aim for](crate::planner::setup::aimed_for), and with a goal if there is
    /// one. A planner may be large, and a chip has no room for a copy of it.
    #[inline]
    pub fn of(of: (G, D), belief: B, goal: Option<Goal<C>>) -> Self {
        Self::with_all(of, belief, DrivingPrice::USUAL, EVALUATIONS, goal)
    }

    /// The same, with all that can be chosen.
    #[inline]
    pub(crate) fn with_all(
        (area, dynamics): (G, D),
        belief: B,
        price: DrivingPrice,
        evaluations: u32,
        goal: Option<Goal<C>>,
    ) -> Self {
        let bounds = area.bounds().whole();
        let goal = goal.map(|goal| goal.in_bounds_of(&area));
        let (audit, silence) = (Some(Audit::NONE), Silence::NONE);
        let (sight, journey) = (Near, ());
        Self {
            area,
            price,
            bounds,
            dynamics,
            belief,
            evaluations,
            sight,
            goal,
            audit,
            silence,
            journey,
        }
    }
}

impl<D: Dynamics, B: PredictiveBelief, G: Workspace, C: Criterion, S: Sight>
    Lookahead<D, B, G, C, S>
{
    /// The same with another goal and another sight.
    #[inline]
    fn with<W, T: Sight>(self, goal: Option<Goal<W>>, sight: T) -> Lookahead<D, B, G, W, T> {
        let Self { area, price, bounds, dynamics, belief, evaluations, audit, silence, .. } = self;
        let journey = T::Journey::default();
        Lookahead {
            area,
            price,
            bounds,
            dynamics,
            belief,
            evaluations,
            sight,
            goal,
            audit,
            silence,
            journey,
        }
    }

    /// The same, but labels are sought as far as the sight says: [`Far`](crate::planner::far::Far) sight is for areas
    /// that are large for the reach of one motion.
    #[must_use]
    #[inline]
    pub fn seeing<T: Sight>(self, sight: T) -> Lookahead<D, B, G, C, T> {
        let goal = self.goal;
        self.with(goal, sight)
    }

    /// The same, with another price of driving than [`DrivingPrice::USUAL`].
    #[must_use]
    #[inline]
    pub fn pricing(self, price: DrivingPrice) -> Self {
        Self { price, ..self }
    }

    /// The same, with a limit of `evaluations` ends of motions for each plan instead of [`EVALUATIONS`].
    #[must_use]
    #[inline]
    pub fn with_budget(self, evaluations: u32) -> Self {
        Self { evaluations, ..self }
    }

    /// The same, but it stops when the belief meets the goal and an [audit](crate::watch::Audit) has found no label
    /// against it. `None` means no goal. An audit takes further motions and labels: a car may need as many as until then. See
    /// [`without_audit`](Self::without_audit).
    #[must_use]
    #[inline]
    pub fn until<W: Criterion>(self, goal: impl Into<Option<Goal<W>>>) -> Lookahead<D, B, G, W, S> {
        let goal = goal.into().map(|goal| goal.in_bounds_of(&self.area));
        let sight = self.sight;
        self.with(goal, sight)
    }

    /// The same, but it stops as soon as the belief meets the goal. It then says `Known` also of a boundary that bends or
    /// moves. [`Goal::unaudited`] does the same by type, and leaves the audit's code out of a program.
    #[must_use]
    #[inline]
    pub fn without_audit(self) -> Self {
        Self { audit: None, ..self }
    }

    /// What the audit has seen so far; `None` if there is none.
    pub const fn audit(&self) -> Option<&Audit<B::Verdicts>> {
        self.audit.as_ref()
    }

    /// The belief, for example to take in a label that has its own reliability. The planner then forgets its turns
    /// since the last label, as after a label. A place of an audit counts as visited, and its label as not judged.
    pub fn belief_mut(&mut self) -> &mut B {
        self.silence = Silence::NONE;
        S::observe(&mut self.journey, true);
        if let Some(audit) = &mut self.audit {
            audit.pass();
        }
        &mut self.belief
    }

    /// The least expected information of a label that a user has asked for, as a share of the most that one can carry.
    fn least(&self) -> f32 {
        let bits = self.sight.least();
        if bits > 0.0 { bits / self.belief.capacity() } else { 0.0 }
    }

    /// Whether a label at a site is expected to carry so much.
    fn carries(&self, site: Site, least: f32) -> bool {
        let predictor = self.belief.predictor(site);
        predictor.information(site, predictor.share_above(site)) >= least
    }

    /// Whether a label is in sight that is expected to carry less than was asked for.
    fn sees_less(&self, pose: Pose, evaluations: u32) -> bool {
        let least = self.worthwhile();
        let mut lookout = Lookout { least, evaluations, ..self.lookout() };
        let mut journey = self.journey;
        self.sight.decide(&self.belief, &mut lookout, pose, (self.goal, &mut journey)).is_some()
    }

    /// The least expected information of a label that is worth its way, whatever was asked for.
    fn worthwhile(&self) -> f32 {
        // Where positions err, there is always one more label that tells next to nothing.
        let errs = self.belief.ground().shift != Vector::default();
        if errs { LEAST } else { 0.0 }
    }

    /// A label and how likely it is, if a promise depends on what speaks against the model.
    fn heard(&self, site: Site, reading: Option<Reading>) -> Option<(Sample, f32)> {
        let Some(Reading::Side(label)) = reading else { return None };
        let promises =
            B::Verdicts::HEARS && C::AUDITS && self.goal.is_some() && self.audit.is_some();
        promises.then(|| (Sample { site, label }, self.belief().chance_of(site, label)))
    }

    /// Takes a label as evidence.
    fn hear(&mut self, heard: Option<(Sample, f32)>) {
        if let (Some((sample, chance)), Some(audit)) = (heard, &mut self.audit) {
            audit.hear(sample, chance);
        }
    }

    /// What a plan looks for labels with.
    fn lookout(&self) -> Lookout<'_, D, G> {
        let Self { area, dynamics, evaluations, .. } = self;
        let grid = dynamics.grid();
        let most = (USUAL * area.bounds().mean_side() / grid.step_units()) as u16;
        let usual = grid.speeds().saturating_sub(1).min(most).max(1);
        let (asked, least) = (self.least(), self.worthwhile());
        Lookout {
            dynamics,
            area: *area,
            weight: self.price.0,
            usual,
            scale: 2_000.0 / grid.reach_mm(usual) as f32,
            least: if asked > least { asked } else { least },
            evaluations: *evaluations,
        }
    }

    /// What to do when the goal is met: the audit's next motion, or what it came to.
    fn conclude(&mut self, pose: Pose) -> Plan {
        let known = Plan::Stop(StopReason::Known);
        let Some(audit) = self.audit.as_mut().filter(|_| C::AUDITS) else { return known };
        let Some(estimate) = self.belief.belief().centre() else { return known };
        self.belief.prepare();
        let (dynamics, mut effort) = (&self.dynamics, Effort::within(&self.area, LOOKS));
        let with = (dynamics, &self.area);
        let Some(Errand { leg, arrives, .. }) =
            audit.plan(with, (&self.belief, estimate), pose, &mut effort)
        else {
            return known;
        };
        let found = Found::of(None, leg);
        let motion = Motion::of(Some(Stage::Audit), pose, &found, dynamics, effort);
        Plan::Move(Motion { wants_label: arrives, ..motion })
    }

    /// The motion that was decided on, with so many looks left.
    fn carry_out(&mut self, decision: &Decision, looks: u32, pose: Pose) -> Plan {
        let Decision { action, target, wants_label, is_far, .. } = *decision;
        let (dynamics, found) = (&self.dynamics, Found::of(None, (action, target)));
        let effort = Effort { looks, examined: self.evaluations - looks };
        let motion = Motion { wants_label, ..Motion::of(None, pose, &found, dynamics, effort) };
        self.silence.bears(false);
        if is_far {
            return Plan::Move(motion);
        }
        let mut course = self.silence.course();
        course.give_up_way();
        self.silence.keep(pose, motion, course, dynamics)
    }

    /// The ladder's motion where no label in reach is worth it, or why the mission ends.
    fn go_elsewhere(&mut self, (least, looks): (f32, u32), pose: Pose) -> Plan {
        let (asked, mut course) = (self.least(), self.silence.course());
        let (found, effort) = self.recover(pose, &mut course);
        let found = match found {
            Ok(found) => found,
            Err(_) if asked > 0.0 && self.sees_less(pose, looks) => {
                return Plan::Stop(StopReason::Worth);
            }
            Err(dead_end) => return Plan::Stop(dead_end.into()),
        };
        let mut motion = Motion::of(None, pose, &found, &self.dynamics, effort);
        // No label in reach is worth its way: this one is on the way to others.
        let is_dull = least > 0.0 && motion.wants_label;
        if asked > 0.0 && is_dull {
            motion.wants_label = self.carries(motion.target.site, asked);
        }
        let goes_on = self.silence.bears(is_dull);
        let is_barred = asked > 0.0 && !motion.wants_label && self.silence.is_dull();
        if !goes_on && !is_barred && !is_broad(self.belief.ground()) {
            return Plan::Stop(StopReason::Tolerance);
        }
        let plan = self.silence.keep(pose, motion, course, &self.dynamics);
        let ends = !goes_on || matches!(plan, Plan::Stop(_));
        if ends && is_barred { Plan::Stop(StopReason::Worth) } else { plan }
    }

    /// What the ladder finds where no label is in reach that is worth it.
    fn recover(&self, pose: Pose, course: &mut Course) -> (Result<Found, DeadEnd>, Effort) {
        let lines = self.belief.ground();
        let (area, weight) = (self.area, self.price.0);
        let rule = ArcRule::default();
        let problem = Problem { lines, area, weight, rule };
        let effort = Effort::within(&area, LOOKS - self.sight.looks());
        let mut search = problem.search(&self.dynamics, pose, effort);
        let search = search.open();
        let found = solve_or_recover(&problem, search, None, course);
        (found, search.effort)
    }
}

impl<D: Dynamics, G: Workspace, C: Criterion, S: Sight, const N: usize, const H: usize> Restart
    for Lookahead<D, NoisyBelief<N, H>, G, C, S>
{
    const ROOM: [usize; 2] = [N, H];

    fn restart(&mut self, given: &[Sample], prior: Prior, noise: Noise) -> Result<(), SetupError> {
        let area = aimed_for(self.area, &self.dynamics, noise.tolerance)?;
        self.belief.restart(given, prior, noise)?;
        (self.area, self.silence) = (area, Silence::NONE);
        self.journey = S::Journey::default();
        self.audit = self.audit.map(|_| Audit::NONE);
        Ok(())
    }
}

impl<D: Dynamics, B: PredictiveBelief, G: Workspace, C: Criterion, S: Sight> Planner
    for Lookahead<D, B, G, C, S>
{
    type Belief = B::Belief;

    fn plan(&mut self, pose: Pose) -> Plan {
        if let Some(goal) = self.goal {
            if C::AUDITS && self.audit.is_some_and(|audit| audit.refuted().is_some()) {
                return Plan::Stop(StopReason::NoLine);
            }
            if self.belief().meets(goal, self.bounds) {
                return self.conclude(pose);
            }
        }
        if self.belief().is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        self.belief.prepare();
        let (mut lookout, mut journey) = (self.lookout(), self.journey);
        let decision =
            self.sight.decide(&self.belief, &mut lookout, pose, (self.goal, &mut journey));
        let (least, looks) = (lookout.least, lookout.evaluations);
        self.journey = journey;
        match decision {
            Some(decision) => self.carry_out(&decision, looks, pose),
            None => self.go_elsewhere((least, looks), pose),
        }
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        let heard = self.heard(pose.site, reading);
        let goal = self.goal.filter(|_| C::AUDITS);
        let mut audit = goal.and_then(|goal| Some((self.audit.as_mut()?, goal.level)));
        let is_audited = tolerance <= self.belief.belief().tolerance()
            && audit.as_ref().is_some_and(|(audit, _)| audit.arrives());
        let seen = reading.filter(|_| is_audited).and_then(|reading| {
            let (label, reliability) = self.belief.sure_of(pose.site, reading, tolerance)?;
            Some((label, reliability, reading))
        });
        // Once the goal is met, a label for which there is no room is not missed.
        let is_spare = is_audited && self.belief.belief().is_full();
        if let Some(reading) = reading.filter(|_| seen.is_none() && !is_spare) {
            self.belief.observe_within(pose.site, reading, tolerance)?;
        }
        if let Some((audit, level)) = &mut audit {
            audit.observe(pose.site, seen, *level);
        }
        self.hear(heard);
        self.silence.observe(reading.is_some());
        S::observe(&mut self.journey, reading.is_some());
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let heard = self.heard(site, Some(reading));
        let is_kept = self.belief.observe_on_the_way(site, reading)?;
        if is_kept {
            self.hear(heard);
            self.silence.hear();
            S::forget(&mut self.journey);
        }
        Ok(is_kept)
    }

    fn belief(&self) -> &B::Belief {
        self.belief.belief()
    }
}

impl<D: Dynamics, B: PredictiveBelief + FromLog, G: Workspace, C: Criterion, S: Sight> Persist
    for Lookahead<D, B, G, C, S>
{
    type Snapshot = Snapshot<B::ObservationLog, (Silence, Audit<B::Verdicts>, S::Journey)>;

    fn snapshot(&self) -> Self::Snapshot {
        let mark = mark(Kind::Lookahead, (&self.dynamics, &self.area), self.belief.mark());
        let audit = self.audit.unwrap_or(Audit::NONE);
        Snapshot::new(mark, self.belief.log(), (self.silence, audit, self.journey))
    }

    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError> {
        let mark = mark(Kind::Lookahead, (&self.dynamics, &self.area), self.belief.mark());
        let (log, &(silence, audit, journey)) = snapshot.open(mark)?;
        if !audit.is_possible() {
            return Err(ReplayError::Spoilt.into());
        }
        self.belief.replay(log)?;
        (self.silence, self.journey) = (silence, journey);
        self.audit = self.audit.map(|_| audit);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::belief::cells::Certainty;
    use crate::belief::reliability::Reliability;
    use crate::belief::sample::Label;
    use crate::belief::true_labels::VersionSpace;
    use crate::geometry::heading::Heading;
    use crate::motion::unicycle::Unicycle;

    fn area() -> Area {
        Area::metres([0.0, 0.0], [20.0, 20.0]).unwrap()
    }

    /// A line through the middle of the area, and the oracle's points about it.
    #[derive(Clone, Copy)]
    struct TiltedField {
        angle: f64,
    }

    impl TiltedField {
        fn site(self, along: f64, off: f64) -> Site {
            let (sin, cos) = libm::sincos(self.angle);
            Site::metres([10.0 + along * cos - off * sin, 10.0 + along * sin + off * cos]).unwrap()
        }

        fn label(self, site: Site) -> Label {
            let (sin, cos) = libm::sincos(self.angle);
            let by = Point2::<f64>::from(site) - Point2::new(10.0, 10.0);
            // The line lies a little off the middle.
            if by.y * cos - by.x * sin > 0.3 { Label::Positive } else { Label::Negative }
        }

        fn given(self) -> [Sample; 4] {
            [(-6.0, -2.0), (-5.0, 3.0), (6.0, 2.5), (5.0, -3.5)].map(|(along, off)| {
                let site = self.site(along, off);
                Sample { site, label: self.label(site) }
            })
        }

        fn start(self) -> Pose {
            let heading = Heading::from_radians(7.0 * self.angle).unwrap();
            Pose { site: self.given()[0].site, heading }
        }

        fn true_labels<const N: usize>(self) -> Lookahead<Unicycle, VersionSpace<N>> {
            let space = VersionSpace::new(&self.given()).unwrap();
            Lookahead::new(area(), Unicycle::paper(), space).unwrap()
        }

        fn doubtful(self) -> Lookahead<Unicycle, NoisyBelief<36, 529>> {
            let noise = Noise {
                reliability: Reliability::new(0.8).unwrap(),
                trusted_radius: 0,
                tolerance: Tolerance::NONE,
            };
            let noisy = NoisyBelief::new(&self.given(), noise).unwrap();
            Lookahead::new(area(), Unicycle::paper(), noisy).unwrap()
        }

        /// Makes so many steps with true labels, and has each looked at before.
        fn fly<B: PredictiveBelief>(
            self,
            mut planner: Lookahead<Unicycle, B>,
            steps: u32,
            mut look: impl FnMut(&mut Lookahead<Unicycle, B>, Pose),
        ) {
            let mut pose = self.start();
            for _ in 0..steps {
                look(&mut planner, pose);
                let Plan::Move(motion) = planner.plan(pose) else { panic!("no motion") };
                pose = motion.target;
                let reading = motion.wants_label.then(|| self.label(pose.site).into());
                planner.observe(pose, reading).unwrap();
            }
        }
    }

    fn fields() -> impl Iterator<Item = TiltedField> {
        (0..24).map(|number| TiltedField { angle: 0.27 * f64::from(number) })
    }

    /// The budget is kept, and the worth of what is decided never falls as it grows.
    fn is_anytime<B: PredictiveBelief + Clone>(planner: &Lookahead<Unicycle, B>, pose: Pose) {
        let mut planner = planner.clone();
        planner.belief.prepare();
        let mut before = f32::NEG_INFINITY;
        for evaluations in [0, 1, 2, 5, 10, 20, 50, 100, 150, 200, 300, 400, 512, 1_000, 5_000] {
            planner.evaluations = evaluations;
            let mut lookout = planner.lookout();
            let with = (&planner.belief.predictor(pose.site), planner.belief.ground());
            let decision = Decision::of(with, &mut lookout, pose);
            assert!(lookout.evaluations <= evaluations);
            let worth = decision.map_or(f32::NEG_INFINITY, |decision| decision.worth);
            assert!(worth >= before, "{worth} with {evaluations}, {before} with fewer, {pose:?}");
            before = worth;
            if let Plan::Move(motion) = planner.clone().with_budget(evaluations).plan(pose) {
                let ladder = if worth > f32::NEG_INFINITY { evaluations } else { u32::MAX };
                assert!(motion.examined <= ladder);
            }
        }
    }

    #[test]
    fn more_evaluations_are_never_worse() {
        for field in fields() {
            field.fly(field.true_labels::<64>(), 16, |planner, pose| is_anytime(planner, pose));
        }
        for field in fields().step_by(6) {
            field.fly(field.doubtful(), 8, |planner, pose| is_anytime(planner, pose));
        }
    }

    #[test]
    fn a_plan_is_the_same_each_time_and_asks_on_uncertain_ground_alone() {
        fn look<B: PredictiveBelief + Clone>(planner: &mut Lookahead<Unicycle, B>, pose: Pose) {
            let plan = planner.plan(pose);
            assert_eq!(plan, planner.plan(pose));
            assert_eq!(plan, planner.clone().plan(pose));
            let Plan::Move(motion) = plan else { panic!("no motion") };
            let target = motion.target.site;
            assert!(area().contains(target));
            let certainty = planner.belief.ground().certainty(target);
            assert!(!motion.wants_label || certainty == Certainty::Uncertain);
        }
        for field in fields() {
            field.fly(field.true_labels::<64>(), 20, look);
            field.fly(field.doubtful(), 6, look);
        }
    }

    #[test]
    fn it_plans_where_lines_point_nearly_all_ways() {
        let lattice = |x, z| Site::new(x, z).unwrap();
        let given = [
            (lattice(0, 0), Label::Negative),
            (lattice(896, 0), Label::Negative),
            (lattice(283_160, -752), Label::Positive),
        ];
        let space = VersionSpace::<16>::new(&given.map(|(site, label)| Sample { site, label }));
        let area = Area::metres([-10.0, -10.0], [10.0, 10.0]).unwrap();
        let mut planner = Lookahead::new(area, Unicycle::default(), space.unwrap()).unwrap();
        let pose = Pose { site: lattice(-60_000, 40_000), heading: Heading::default() };
        assert!(matches!(planner.plan(pose), Plan::Move(_)));
    }

    #[test]
    fn an_audit_begins_in_an_area_of_any_size() {
        for field in fields() {
            let shortest = Unicycle::new(10_000, 1.5, 2, 1).unwrap();
            let area = Area::metres([-8_000.0, -8_000.0], [8_000.0, 8_000.0]).unwrap();
            let space = VersionSpace::<16>::new(&field.given()).unwrap();
            let goal = Goal::slope_within_degrees(89.0).unwrap();
            let planner = Lookahead::new(area, shortest, space).unwrap();
            let plan = planner.until(goal).plan(field.start());
            assert!(matches!(plan, Plan::Move(Motion { stage: Some(Stage::Audit), .. })));
        }
    }

    #[test]
    fn a_refused_label_leaves_an_audit_as_it_was() {
        for field in fields() {
            let (start, goal) = (field.start(), Goal::slope_within_degrees(89.0).unwrap());
            let mut planner = field.true_labels::<5>();
            let Plan::Move(motion) = planner.plan(start) else { panic!("no motion") };
            let label = field.label(motion.target.site);
            planner.observe(motion.target, Some(label.into())).unwrap();
            let mut planner = planner.until(goal);
            let plan = planner.plan(start);
            assert!(matches!(plan, Plan::Move(_)));
            let before = planner.snapshot();
            // It ended where nothing is certain, and there is no room.
            let middle = Site::try_from(Point2::new(10.0, 10.0)).unwrap();
            let places =
                (0..400).map(|n| middle.step(Vector::new((n % 20) << 13, (n / 20) << 13).unwrap()));
            let open =
                |site: &Site| planner.belief.ground().certainty(*site) == Certainty::Uncertain;
            let Some(site) = places.map(Result::unwrap).find(open) else { continue };
            let refused = planner.observe(Pose { site, ..start }, Some(Label::Positive.into()));
            assert!(matches!(refused, Err(ObservationError::Full(_))));
            assert_eq!(planner.snapshot(), before);
        }
    }

    #[test]
    fn it_stops_when_it_should() {
        for field in fields() {
            let start = field.start();
            let outside = Pose::at([-1.0, 10.0], start.heading).unwrap();
            let arc = |deg: f64| Goal::slope_within_degrees(deg).unwrap();
            let stops = |plan, reason| assert_eq!(plan, Plan::Stop(reason));
            let mut full = field.true_labels::<5>();
            let Plan::Move(motion) = full.plan(start) else { panic!("no motion") };
            let label = field.label(motion.target.site);
            full.observe(motion.target, Some(label.into())).unwrap();
            stops(full.plan(start), StopReason::SamplesFull);
            // What is known is known also where there is no more room, and outside.
            stops(full.until(arc(89.0).unaudited()).plan(outside), StopReason::Known);
            stops(field.doubtful().until(arc(89.0)).without_audit().plan(start), StopReason::Known);
            let few = |it: Plan| assert!(matches!(it, Plan::Move(_)));
            few(field.true_labels::<64>().until(arc(5.0)).plan(start));
            few(field.doubtful().until(arc(5.0)).plan(start));
            few(field.true_labels::<64>().plan(outside));
            few(field.doubtful().plan(outside));
        }
    }
}
