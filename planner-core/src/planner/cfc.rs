//! Algorithm 1, control for classification (CFC): noiseless labels.
//!
//! As printed, it solves P1 until the label flips, then P2 once, and repeats. Three points are settled here:
//!
//! - *The memory* that a flip is compared with is the label of the past position, as in the paper's text. The listing
//!   does not change `Label` after P2. Over the standard fields the two hardly differ.
//! - *P2 with no feasible action* is skipped: the listing runs it once and advances its counter "even if the objective
//!   is not met". P1 with no feasible action climbs the recovery ladder.
//! - *P2's direction* is restricted to the bisector of the slope arc, see
//!   [`Following`](crate::planner::options::Following). Over 4,000 standard fields this learns 0.65 bits a step in 10
//!   steps, and P2 as printed learns 0.56.

use crate::belief::Belief as _;
use crate::belief::ObservationError;
use crate::belief::cells::{CellView, Certainty};
use crate::belief::observation_log::{FromLog as _, ObservationLog};
use crate::belief::sample::{Label, Reading};
use crate::belief::tolerance::Tolerance;
use crate::belief::true_labels::VersionSpace;
use crate::geometry::arc::SlopeArc;
use crate::geometry::area::Area;
use crate::geometry::lattice::Site;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::options::{Options, first_to_second};
use crate::planner::setup::{SetupError, aimed_for_by};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Kind, Persist, RestoreError, Snapshot, mark};
use crate::planner::{Motion, Plan, Planner, Stage, StopReason};
use crate::search::course::Course;
use crate::search::dead_end::DeadEnd;
use crate::search::direction_rule::ArcRule;
use crate::search::objective::{Choice, Effort, LOOKS};
use crate::search::problem::Problem;
use crate::search::recovery::{Found, solve_or_recover, turn_round};

/// Where Algorithm 1 stands.
///
/// ```text
///            no flip
///            +----+
///            v    |         flip
///          +----------+ ------------> +-----------+
///  start ->| Crossing |               | Following |
///          | (P1)     | <------------ | (P2)      |
///          +----------+   a sample,   +-----------+
///                       or infeasible
/// ```
///
/// A flip is a label opposite to that of the past position. A reading on the boundary is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// Solve P1 until the label flips.
    Crossing,
    /// Solve P2 once.
    Following,
}

/// Algorithm 1 for `D`'s dynamics with room for `N` samples, the given ones included.
#[derive(Clone, Debug)]
pub struct Cfc<D, const N: usize, G = Area> {
    /// Where motions aim for.
    area: G,
    options: Options,
    dynamics: D,
    space: VersionSpace<N>,
    phase: Phase,
    /// The phase with which the next plan begins. A plan does not change it, so a plan asked for twice is the same.
    due: Phase,
    /// The label of the past position.
    past: Label,
    silence: Silence,
}

impl<D: Dynamics, const N: usize, G: Workspace> Cfc<D, N, G> {
    /// A planner that knows the given samples; its past label is that of the first of them. It has [`Options::CFC`].
    ///
    /// # Errors
    /// [`SetupError`].
    pub fn new(area: G, dynamics: D, space: VersionSpace<N>) -> Result<Self, SetupError> {
        let area = aimed_for_by(area, &dynamics, &space)?;
        Ok(Self::of((area, dynamics), space, Options::CFC))
    }

    /// The same in the part of an area that motions aim for.
    pub(crate) fn of((area, dynamics): (G, D), space: VersionSpace<N>, options: Options) -> Self {
        let past = space.first_label();
        let (phase, due, silence) = (Phase::Crossing, Phase::Crossing, Silence::NONE);
        Self { area, options, dynamics, space, phase, due, past, silence }
    }

    /// The same with other options.
    #[must_use]
    pub fn with(self, options: Options) -> Self {
        Self { options, ..self }
    }

    /// Where the algorithm stands.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The one-step problem of the present phase.
    pub fn problem(&self) -> Problem<'_, ArcRule, G> {
        self.problem_of(self.phase, self.space.slope_arc(), self.space.lines())
    }

    fn problem_of<'a>(
        &self,
        phase: Phase,
        slopes: SlopeArc,
        lines: CellView<'a>,
    ) -> Problem<'a, ArcRule, G> {
        let (area, weight) = (self.area, self.options.weight);
        let rule = match phase {
            Phase::Crossing => {
                self.options.crossing_rule(slopes, first_to_second(self.space.samples()))
            }
            Phase::Following => self.options.following_rule(slopes),
        };
        Problem { lines, area, weight, rule }
    }

    /// The motion to make, its phase, and the effort of finding it. Where positions err, there may be no place left at
    /// which either label would cut. Then a place is enough at which one of the labels would.
    fn find(&self, pose: Pose, course: &mut Course) -> (Result<Found, DeadEnd>, Phase, Effort) {
        let lines = self.space.lines();
        if self.space.expected() == Tolerance::NONE {
            return self.find_among(lines, pose, LOOKS, course);
        }
        let found = self.find_among(lines, pose, LOOKS / 2, course);
        if found.0.is_err() {
            *course = self.silence.course();
            return self.find_among(lines.loosely(), pose, LOOKS / 2, course);
        }
        found
    }

    fn find_among(
        &self,
        lines: CellView<'_>,
        pose: Pose,
        looks: u32,
        course: &mut Course,
    ) -> (Result<Found, DeadEnd>, Phase, Effort) {
        let slopes = self.space.slope_arc();
        let problem = self.problem_of(self.due, slopes, lines);
        let mut search = problem.search(&self.dynamics, pose, Effort::within(&self.area, looks));
        let search = search.open();
        let mut followed = None;
        if self.due == Phase::Following {
            // The rest is for the ladder.
            let kept = search.effort.keep_back(search.effort.looks / 2);
            let findings = search.best(&problem.rule, None);
            search.effort.give_back(kept);
            if let Some((Choice { action, target, .. }, _)) = findings.best {
                let found = Found::of(None, (action, target));
                return (Ok(found), Phase::Following, search.effort);
            }
            if let Some(turned) = turn_round(&problem, search) {
                course.give_up_way();
                return (Ok(turned), Phase::Following, search.effort);
            }
            followed = Some(findings);
        }
        let crossing = self.problem_of(Phase::Crossing, slopes, lines);
        let found = solve_or_recover(&crossing, search, followed, course);
        (found, Phase::Crossing, search.effort)
    }
}

impl<D: Dynamics, const N: usize, G: Workspace> Planner for Cfc<D, N, G> {
    type Belief = VersionSpace<N>;

    fn plan(&mut self, pose: Pose) -> Plan {
        if self.space.is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        let mut course = self.silence.course();
        let (found, phase, effort) = self.find(pose, &mut course);
        self.phase = phase;
        let stage = match phase {
            Phase::Crossing => Some(Stage::P1),
            Phase::Following => Some(Stage::P2),
        };
        match found {
            Ok(found) => {
                let motion = Motion::of(stage, pose, &found, &self.dynamics, effort);
                self.silence.keep(pose, motion, course, &self.dynamics)
            }
            Err(dead_end) => Plan::Stop(dead_end.into()),
        }
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        let Some(reading) = reading else {
            // Ground that was merely crossed: its label is known where it is certain.
            if let Certainty::Certain(label) = self.space.certainty(pose.site) {
                self.past = label;
            }
            self.silence.observe(false);
            self.due = self.phase;
            return Ok(());
        };
        self.space.take_within(pose.site, reading, self.past, tolerance)?;
        self.silence.observe(true);
        let crossing = core::mem::replace(&mut self.phase, Phase::Crossing) == Phase::Crossing;
        if let Reading::Side(label) = reading {
            if crossing && label != self.past {
                self.phase = Phase::Following;
            }
            self.past = label;
        }
        self.due = self.phase;
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let is_kept = self.space.observe_on_the_way(site, reading)?;
        if is_kept {
            self.silence.hear();
        }
        Ok(is_kept)
    }

    fn belief(&self) -> &VersionSpace<N> {
        &self.space
    }
}

/// It remembers its phase, the label of the past position, how it turned since, and the way that is under way.
impl<D: Dynamics, const N: usize, G: Workspace> Persist for Cfc<D, N, G> {
    type Snapshot = Snapshot<ObservationLog<N>, ([Phase; 2], Label, Silence)>;

    fn snapshot(&self) -> Self::Snapshot {
        let mark = mark(Kind::Cfc, (&self.dynamics, &self.area), self.space.mark());
        Snapshot::new(mark, self.space.log(), ([self.phase, self.due], self.past, self.silence))
    }

    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError> {
        let mark = mark(Kind::Cfc, (&self.dynamics, &self.area), self.space.mark());
        let (log, &([phase, due], past, silence)) = snapshot.open(mark)?;
        self.space.replay(log)?;
        (self.phase, self.due, self.past, self.silence) = (phase, due, past, silence);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::sample::Sample;
    use crate::geometry::heading::Heading;
    use crate::motion::unicycle::Unicycle;
    use crate::search::recovery::Recovery;

    fn pose(x: f64, z: f64) -> Pose {
        Pose::at([x, z], Heading(0)).unwrap()
    }

    /// The oracle's corners of a square around z = 5, and no more room than asked for.
    fn planner<const N: usize>() -> Cfc<Unicycle, N> {
        let corners = [[0.0, 0.0], [0.0, 10.0], [10.0, 10.0], [10.0, 0.0]];
        let sample = |[x, z]: [f64; 2]| {
            let label = if z > 5.0 { Label::Positive } else { Label::Negative };
            Sample::at([x, z], label).unwrap()
        };
        let area = Area::metres([0.0, 0.0], [10.0, 10.0]).unwrap();
        let space = VersionSpace::new(&corners.map(sample)).unwrap();
        Cfc::new(area, Unicycle::paper(), space).unwrap()
    }

    fn see<const N: usize>(planner: &mut Cfc<Unicycle, N>, x: f64, z: f64, label: Label) -> Phase {
        planner.observe(pose(x, z), Some(label.into())).unwrap();
        planner.phase()
    }

    #[test]
    fn p1_until_the_label_flips_then_p2_once() {
        let mut planner = planner::<16>();
        assert_eq!(planner.phase(), Phase::Crossing);
        assert_eq!(see(&mut planner, 4.0, 2.0, Label::Negative), Phase::Crossing);
        assert_eq!(see(&mut planner, 4.0, 6.0, Label::Positive), Phase::Following);
        // Whatever P2 finds, P1 resumes and remembers the label of where it does.
        assert_eq!(see(&mut planner, 6.0, 4.0, Label::Negative), Phase::Crossing);
        assert_eq!(see(&mut planner, 6.0, 4.5, Label::Negative), Phase::Crossing);
        assert_eq!(see(&mut planner, 6.0, 5.5, Label::Positive), Phase::Following);
    }

    #[test]
    fn a_reading_on_the_boundary_is_no_flip() {
        let mut planner = planner::<16>();
        planner.observe(pose(4.0, 5.0), Some(Reading::Boundary)).unwrap();
        assert_eq!(planner.phase(), Phase::Crossing);
        assert_eq!(planner.belief().samples().len(), 5);
        assert_eq!(see(&mut planner, 4.0, 5.5, Label::Positive), Phase::Following);
    }

    #[test]
    fn a_reading_on_the_boundary_is_never_refused_when_it_is_true() {
        // The line z = 5 passes through all of these; (5, 5) stays on the border of certain ground.
        let mut planner = planner::<16>();
        let on = |x| pose(x, 5.0);
        planner.observe(on(5.0), Some(Reading::Boundary)).unwrap();
        assert_eq!(see(&mut planner, 2.0, 5.5, Label::Positive), Phase::Following);
        assert_eq!(see(&mut planner, 2.0, 5.25, Label::Positive), Phase::Crossing);
        for x in [5.0, 2.0, 8.0, 5.0, 8.0, 0.0, 10.0] {
            let past = planner.past;
            assert_eq!(planner.observe(on(x), Some(Reading::Boundary)), Ok(()), "at {x}");
            assert_eq!((planner.past, planner.phase), (past, Phase::Crossing));
        }
        // And refused when it is false.
        let refused = planner.observe(pose(5.0, 9.0), Some(Reading::Boundary));
        let contrary = Sample::at([5.0, 9.0], Label::Negative).unwrap();
        assert_eq!(refused, Err(ObservationError::Contradiction(contrary)));
    }

    #[test]
    fn a_contradiction_changes_nothing() {
        let mut planner = planner::<16>();
        see(&mut planner, 4.0, 3.0, Label::Negative);
        let before = (planner.phase(), planner.past, planner.space.samples().len());
        let wrong = Sample::at([4.0, 1.0], Label::Positive).unwrap();
        let refused = planner.observe(pose(4.0, 1.0), Some(Label::Positive.into()));
        assert_eq!(refused, Err(ObservationError::Contradiction(wrong)));
        assert_eq!((planner.phase(), planner.past, planner.space.samples().len()), before);
        assert_eq!(see(&mut planner, 4.0, 4.0, Label::Negative), Phase::Crossing);
    }

    #[test]
    fn certain_ground_that_is_crossed_without_a_sample_sets_the_past_label() {
        let mut planner = planner::<16>();
        see(&mut planner, 4.0, 3.0, Label::Negative);
        see(&mut planner, 4.0, 7.0, Label::Positive);
        assert_eq!(see(&mut planner, 4.0, 6.0, Label::Positive), Phase::Crossing);
        // Below (4, 3) all is negative: coming from there, a positive label is a flip.
        planner.observe(pose(4.0, 2.0), None).unwrap();
        assert_eq!((planner.past, planner.phase()), (Label::Negative, Phase::Crossing));
        assert_eq!(see(&mut planner, 4.0, 5.5, Label::Positive), Phase::Following);
        // Uncertain ground says nothing.
        planner.observe(pose(4.0, 4.0), None).unwrap();
        assert_eq!((planner.past, planner.phase()), (Label::Positive, Phase::Following));
    }

    #[test]
    fn a_full_buffer_ends_the_mission() {
        let mut planner = planner::<5>();
        assert!(matches!(planner.plan(pose(1.0, 1.0)), Plan::Move(_)));
        see(&mut planner, 4.0, 3.0, Label::Negative);
        assert_eq!(planner.plan(pose(4.0, 3.0)), Plan::Stop(StopReason::SamplesFull));
        let refused = planner.observe(pose(4.0, 4.0), Some(Label::Negative.into()));
        assert!(matches!(refused, Err(ObservationError::Full(_))));
    }

    #[test]
    fn from_outside_it_comes_back() {
        let mut planner = planner::<16>();
        let area = planner.area;
        for n in 0..400_u32 {
            let (sin, cos) = libm::sincos(f64::from(n));
            let heading = Heading(n.wrapping_mul(2_654_435_761));
            let off = 7.1 + f64::from(n) / 10.0;
            let mut pose = Pose { heading, ..pose(5.0 + off * cos, 5.0 + off * sin) };
            // Two turns, and drives of two metres by an eighth of which it comes nearer at least.
            let mut motions = 0;
            while !area.contains(pose.site) {
                let Plan::Move(motion) = planner.plan(pose) else { panic!("{n}: no way back") };
                assert!(!motion.wants_label || area.contains(motion.target.site));
                (pose, motions) = (motion.target, motions + 1);
                assert!(motions <= 3 + n / 10, "{n}: {motions}");
            }
        }
    }

    #[test]
    fn p1_and_p2_hold_their_directions() {
        let mut planner = planner::<16>();
        let direction = |motion: Motion, from: Site| motion.target.site - from;
        let from = pose(0.0, 0.0);
        let Plan::Move(motion) = planner.plan(from) else { panic!("P1 is feasible") };
        assert_eq!((motion.stage, motion.recovery), (Some(Stage::P1), None));
        assert!(!planner.belief().slope_arc().contains(direction(motion, from.site)));
        see(&mut planner, 1.0, 3.0, Label::Negative);
        see(&mut planner, 1.0, 7.0, Label::Positive);
        let from = pose(1.0, 7.0);
        let Plan::Move(motion) = planner.plan(from) else { panic!("P2 is feasible") };
        assert_eq!((motion.stage, motion.recovery), (Some(Stage::P2), None));
        assert!(planner.belief().slope_arc().middle().contains(direction(motion, from.site)));
    }

    #[test]
    fn ground_that_is_all_certain_ahead_makes_it_turn_and_far_from_all_else_it_drives() {
        let mut planner = planner::<16>();
        for (x, z, label) in [
            (0.0, 4.9, Label::Negative),
            (10.0, 4.9, Label::Negative),
            (0.0, 5.1, Label::Positive),
            (10.0, 5.1, Label::Positive),
        ] {
            see(&mut planner, x, z, label);
        }
        let quarter = Heading(1 << 30);
        // Facing away from the strip, one metre above it.
        let away = Pose { heading: quarter, ..pose(5.0, 6.1) };
        let Plan::Move(motion) = planner.plan(away) else { panic!("there is a turn") };
        assert_eq!((motion.recovery, motion.wants_label), (Some(Recovery::Reorient), false));
        assert_eq!(motion.target.site, away.site);
        assert!(motion.control.turn_rad > 0.0, "left and right are alike: left");
        // Facing it from five metres below.
        let facing = Pose { heading: quarter, ..pose(5.0, 0.1) };
        let Plan::Move(motion) = planner.plan(facing) else { panic!("there is a transit") };
        assert_eq!((motion.recovery, motion.wants_label), (Some(Recovery::Transit), false));
        assert!(motion.target.site.z() > facing.site.z());
    }

    #[test]
    fn a_strip_thinner_than_the_grid_can_hit_ends_the_mission() {
        let mut planner = planner::<16>();
        let lattice = |x, z| Pose { site: Site::new(x, z).unwrap(), ..pose(0.0, 0.0) };
        for (x, z, label) in [
            (0, 5 << 16, Label::Negative),
            (10 << 16, 5 << 16, Label::Negative),
            (0, (5 << 16) + 1, Label::Positive),
            (10 << 16, (5 << 16) + 1, Label::Positive),
        ] {
            planner.observe(lattice(x, z), Some(label.into())).unwrap();
        }
        assert_eq!(planner.plan(pose(5.0, 5.5)), Plan::Stop(StopReason::Resolution));
    }
}
