//! A planner that finds a front and goes along it, told nothing of how it bends.
//!
//! It learns from a [`Curve`], and looks one motion ahead. What it does depends on what is known:
//!
//! - **Search**: as long as nothing is known of the front, it drives along a route over the area (`quest.rs`).
//! - **Close**: the curve begins between two true labels that differ. If labels may be wrong, a grid of lines in a square
//!   about the place closes in first (`hunt.rs`).
//! - **Follow**: the robot goes to the best place along the front (`along.rs`).
//! - **Audit**: a follower reads where either label is as likely, so no label can surprise it. From time to time it reads
//!   one on certain ground, on either side in turn. Those tell a sensor that reads at random or the opposite.
//! - **Go round**: where a keep-out lies on the front, the robot goes to the first place beyond it.
//! - **Go back**: where the front leaves the area, it drives to where it began, without labels, and goes the other way.
//! - **Begin again**: an alarm of the curve's evidence says that the front bends more tightly than any gait, or is lost.
//!   The curve begins again at the last place that was passed. At the next alarm without a place, or where labels say that
//!   there is no front, it is sought near by, and then as at the start.
//!
//! A mission ends where no front is left to find, where there is no way on, where the robot is back at its last label, or
//! where it has [gone along all of the front](Track::until_closed).

use crate::belief::curve::{Curve, CurveMemory, MapPlace, nearest_pair};
use crate::belief::evidence::Alarm;
use crate::belief::field::{REMEMBERED, Seeking};
use crate::belief::front::{Beside, Front, FrontStretch, Waist};
use crate::belief::lines::{Lines, LinesMemory};
use crate::belief::noise::Noise;
use crate::belief::observation_log::{FromLog as _, ReplayError};
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::trust::AnyReliability;
use crate::belief::weight::Prior;
use crate::belief::{Belief as _, ObservationError};
use crate::geometry::approximate::{METRE, distance};
use crate::geometry::area::Area;
use crate::geometry::heading::Heading;
use crate::geometry::lattice::Site;
use crate::geometry::mark::Mark;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::aim::{Aim, Onward};
use crate::planner::along::{best_place, certain_place, sure_label, towards};
use crate::planner::front_state::FrontState;
use crate::planner::hunt::Hunt;
use crate::planner::lap::Lap;
use crate::planner::led::Led;
use crate::planner::one_label::OneLabel;
use crate::planner::quest::{QuestMemory, QuestPhase};
use crate::planner::scout::{BestEnd, FAINT, Scout};
use crate::planner::setup::{Restart, SetupError, aimed_for};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Kind, Persist, RestoreError, Snapshot};
use crate::planner::stretch::{FormerFront, PARTS, WatchedStretch};
use crate::planner::turns::Turns;
use crate::planner::{Plan, Planner, Stage, StopReason};

/// After so many alarms without a place in between it is lost.
const LOST: u8 = 2;

/// A front is lost where there is none with more than this probability.
const ELSEWHERE: f32 = 0.97;

/// The grid for labels that may be wrong, about where a front was crossed.
const DIRECTIONS: usize = 16;
const OFFSETS: usize = 16;

/// A front may have moved on by so many reaches where the robot drives back to it.
const MOVED: f32 = 2.0;

/// A planner that finds a front and goes along it: `D` is the vehicle, `G` the area.
///
/// ```
/// # use planner_core::{Area, Front, Heading, Label, Noise, Plan, Planner as _, Pose, Track, Unicycle};
/// # use planner_core::nalgebra::Point2;
/// let area = Area::metres([0.0, 0.0], [200.0, 200.0])?;
/// let mut planner = Track::new(area, Unicycle::default(), Front::BENDING, Noise::new(0.95)?)?;
/// let mut pose = Pose::at([100.0, 50.0], Heading::default())?;
/// for _ in 0..300 {
///     let Plan::Move(motion) = planner.plan(pose) else { break };
///     pose = motion.target;
///     // The front is a circle, and nobody says so.
///     let off = Point2::<f64>::from(pose.site) - Point2::new(100.0, 100.0);
///     let label = if off.norm() < 40.0 { Label::Positive } else { Label::Negative };
///     planner.observe(pose, motion.wants_label.then_some(label.into()))?;
/// }
/// let waist = planner.found().ok_or("lost")?;
/// let off = Point2::<f64>::from(waist.site) - Point2::new(100.0, 100.0);
/// assert!((off.norm() - 40.0).abs() < waist.half_width(0.999));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Track<D, G = Area, const N: usize = 0> {
    hunt: Hunt<D, DIRECTIONS, OFFSETS, G>,
    front: Front,
    curve: Curve,
    lap: Lap,
    /// What it goes along to and fro, if it has a part.
    stretch: WatchedStretch<N>,
    /// The pose at the last label that was read at the end of a motion.
    heard_at: Option<Pose>,
    turns: Turns,
    /// Whether it ends once the robot has gone along all of the front.
    ends: bool,
    /// How it is led; `None` if it plans itself.
    led: Option<Led>,
}

/// What a follower has to remember beside its curve.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TrackMemory<const N: usize = 0> {
    silence: Silence,
    lap: Lap,
    stretch: WatchedStretch<N>,
    heard_at: Option<Pose>,
    turns: Turns,
    quest: QuestMemory,
    /// Before the curve begins.
    closing: Option<LinesMemory<DIRECTIONS, OFFSETS>>,
}

/// A [`Track`] that stays with a stretch of the front, about the place where it finds it: it goes to and fro. It knows where
/// the front is [all along](Track::beside) the stretch, and does not end for a closed front.
pub type Guard<D, G = Area> = Track<D, G, PARTS>;

impl<D: Dynamics, G: Workspace> Track<D, G> {
    /// A planner that knows nothing yet but how fast a front may move, and how often labels are true. Patches may lie in the
    /// area unless the front is [straight](Front::STRAIGHT). The radius of a front does not count.
    ///
    /// Motions end where the tolerance cannot bring the robot out of the area. They are no longer than an eighth of the
    /// mean of its sides.
    ///
    /// # Errors
    /// [`SetupError`].
    #[inline] // it is made where it stays, as it may be large
    pub fn new(
        area: G,
        dynamics: D,
        front: Front,
        noise: impl Into<Noise<AnyReliability>>,
    ) -> Result<Self, SetupError> {
        Self::made((area, dynamics), (front, 0.0), noise.into())
    }

    /// The same in the part of an area that motions [aim for](crate::aimed_for), for one that is
    /// [restarted](Restart::restart) where it stays before it plans. It may [end](Self::until_closed).
    #[inline]
    pub fn of(of: (G, D), front: Front, ends: bool) -> Self {
        Self::blank(of, (front, 0.0), ends)
    }

    /// The same, but it ends once the robot has gone along all of the front: it is [closed](Self::is_closed), or it has been
    /// followed to the border at both ends. Of [several](Seeking::several) patches it seeks the next one first.
    #[must_use]
    pub fn until_closed(self) -> Self {
        Self { ends: true, ..self }
    }
}

impl<D: Dynamics, G: Workspace> Track<D, G> {
    /// The same, but it is led: another drives, back along the front as well. A plan only forgets the places that it has
    /// [mapped](Curve::mapped) so far.
    #[must_use]
    pub fn led(self) -> Self {
        Self { led: Some(Led::default()), ..self }
    }
}

impl<D: Dynamics, G: Workspace> Guard<D, G> {
    /// As [`Track::new`], for so much of the front.
    ///
    /// # Errors
    /// [`SetupError`].
    #[inline]
    pub fn watching(
        area: G,
        dynamics: D,
        (front, stretch): (Front, FrontStretch),
        noise: impl Into<Noise<AnyReliability>>,
    ) -> Result<Self, SetupError> {
        Self::made((area, dynamics), (front, stretch.length()), noise.into())
    }

    /// As [`Track::of`].
    #[inline]
    pub fn guard_of(of: (G, D), front: Front, stretch: FrontStretch) -> Self {
        Self::blank(of, (front, stretch.length()), false)
    }

    /// The middle of the stretch, and its direction. `None` before the front is found.
    pub fn stretch(&self) -> Option<Pose> {
        self.stretch.middle()
    }
}

impl<D: Dynamics, G: Workspace, const N: usize> Track<D, G, N> {
    #[inline]
    fn made(
        (area, dynamics): (G, D),
        told: (Front, f32),
        noise: Noise<AnyReliability>,
    ) -> Result<Self, SetupError> {
        let area = aimed_for(area, &dynamics, noise.tolerance)?;
        let mut track = Self::blank((area, dynamics), told, false);
        track.hunt.lines.restart(area.whole().bounds(), noise, &[]);
        track.begin_curve(noise);
        // The usual radius of a patch suits every area.
        track.begin(Seeking::USUAL)?;
        Ok(track)
    }

    /// A stretch of no length is not watched.
    #[inline]
    fn blank(of: (G, D), (front, stretch): (Front, f32), ends: bool) -> Self {
        Self {
            hunt: Hunt::of(of, Lines::blank()),
            front,
            curve: Curve::NONE,
            lap: Lap::NONE,
            stretch: WatchedStretch::new(stretch),
            heard_at: None,
            turns: Turns::default(),
            ends,
            led: None,
        }
    }

    /// Nothing is known of a front but how fast it moves.
    fn begin_curve(&mut self, noise: Noise<AnyReliability>) {
        let scout = &self.hunt.scout;
        let bounds = scout.area.whole().bounds();
        let map = ([bounds.min(), bounds.max()], scout.width());
        self.curve.restart((scout.reach() * METRE, self.front), map, noise);
    }

    /// What tells the mission from others.
    fn mark(&self) -> Mark {
        let (kind, curve) = (if N > 0 { Kind::Guard } else { Kind::Track }, self.curve.mark());
        self.hunt.scout.mark(kind, curve.and([self.stretch.length().to_bits()]))
    }

    fn begin(&mut self, seeking: Seeking) -> Result<(), SetupError> {
        self.hunt.scout.begin(seeking, self.front, (self.hunt.lines.reliability(), false))
    }

    /// Where the front is beside the robot, or where it drives back to; `None` as long as it is not found, and where it is
    /// lost.
    pub fn found(&self) -> Option<Waist> {
        self.curve.found(self.hunt.scout.width())
    }

    /// The half-width below which the front counts as found, metres: one and a half of the longest motion, or of the radius
    /// of the turning circle if that is longer.
    pub fn width(&self) -> f32 {
        self.hunt.scout.width()
    }

    /// The same with what is said of a front of which nothing is known.
    ///
    /// # Errors
    /// [`SetupError::Patch`] if patches of this radius do not suit the area.
    pub fn seeking(mut self, seeking: Seeking) -> Result<Self, SetupError> {
        self.begin(seeking)?;
        Ok(self)
    }

    /// The same after some points whose labels are known for sure, of one label or of both. Call it before the first
    /// plan, and after [`seeking`](Self::seeking).
    #[must_use]
    pub fn knowing(mut self, points: &[Sample]) -> Self {
        self.know(points);
        self
    }

    /// Two points that differ and are near each other are where it begins. Where labels may be wrong, points that are
    /// further apart are closed in on by the grid.
    fn know(&mut self, points: &[Sample]) {
        let Hunt { scout, lines } = &mut self.hunt;
        match nearest_pair(points) {
            Some(pair) if scout.is_bracket(pair) => {
                scout.quest.know(points);
                scout.quest.phase = QuestPhase::Follow;
                self.curve.begin(pair, points);
            }
            Some(_) if !lines.is_certain() => self.hunt.know(points),
            _ => scout.quest.know(points),
        }
    }

    /// The same, but it seeks the front along a route of your own first, up to 16 corners of it.
    #[must_use]
    pub fn surveying(mut self, corners: &[Site]) -> Self {
        self.hunt.scout.quest.survey(corners);
        self
    }

    /// The label that all of the area has, if it most likely has one; and what may be left of the other one. The planner
    /// ends with [`StopReason::OneLabel`] then.
    pub fn one_label(&self) -> Option<OneLabel> {
        self.hunt.scout.one_label()
    }

    /// Whether the robot has gone along all of a closed front, and came back to where it found it.
    pub fn is_closed(&self) -> bool {
        self.lap.is_closed() || self.hunt.scout.quest.has_mapped()
    }

    /// Goes on where a patch is mapped and there may be others. Labels about it tell nothing of these.
    fn seek_next(&mut self) {
        let Self { lap, hunt, curve, .. } = self;
        let about = (hunt.scout.width() / METRE) as i32;
        if self.ends && lap.is_closed() {
            let extent = lap.extent().grown(about);
            if hunt.scout.quest.map(extent) {
                lap.begin_again();
                curve.leave();
            }
        }
    }

    /// Where the front crosses the line through a site that is square to a heading, on average, and how well that is known.
    /// For a [`Guard`] all along its stretch. Of no meaning before the front [is found](Self::found).
    pub fn beside(&self, site: Site, heading: Heading) -> Beside {
        let of_stretch = self.stretch.beside(site, heading, self.front.pace());
        of_stretch.unwrap_or_else(|| self.curve.beside(site, heading))
    }

    /// Begins to follow the front between two true labels that differ, if the search has come near to it.
    #[inline(never)] // the labels are not on the stack of all that observes
    fn take_lead(&mut self, pose: Pose) {
        let Some(lead) = self.hunt.scout.take_lead(true, pose.site) else { return };
        let mut labels = heapless::Vec::<Sample, REMEMBERED>::new();
        for it in self.hunt.scout.quest.labels_near(&lead) {
            let _ = labels.push(it); // there is room
        }
        self.curve.begin(lead.between, &labels);
        self.follow_from(pose);
    }

    /// The curve has begun: the robot goes along it as it faced at the start.
    fn follow_from(&mut self, pose: Pose) {
        self.curve.face(self.lap.faced(pose));
        let scout = &mut self.hunt.scout;
        scout.quest.follow(pose.site, scout.near() / METRE);
    }

    /// Takes in the end of a motion where the front is sought.
    fn seek_on(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        self.hunt.observe(pose, reading, tolerance)?;
        if self.hunt.lines.is_certain() {
            self.take_lead(pose);
        } else if let Some(waist) = self.hunt.found() {
            self.curve.begin_at(waist, (false, 0.0));
            self.curve.doubt(self.hunt.lines.share_nowhere());
            self.follow_from(pose);
        }
        Ok(())
    }

    /// Goes on where labels speak against what is known of the front: it is sought near by first.
    fn judge(&mut self, pose: Pose) {
        if self.curve.doubts() < LOST && self.curve.share_nowhere() <= ELSEWHERE {
            return;
        }
        self.curve.lose();
        let scout = &mut self.hunt.scout;
        if self.hunt.lines.is_certain() {
            scout.quest.lose(&scout.area);
        } else {
            self.hunt.close_near(pose.site);
        }
    }

    /// Keeps the way along the front in mind, and turns where it leaves the area.
    fn keep_lap(&mut self, pose: Pose) {
        let (reach, found) = (self.hunt.scout.reach(), self.found());
        self.lap.observe(found, (reach * METRE, self.front.pace() * self.lap.age()));
        let curve = &mut self.curve;
        if let Some(first) = curve.mapped().iter().find(|it| it.begins) {
            self.lap.settle(first.waist);
        }
        if let Some(waist) = self.lap.back() {
            if distance(waist.site - pose.site) <= reach {
                curve.begin_at(waist, (curve.is_flipped(), self.lap.age()));
                self.lap.arrive();
            }
            return;
        }
        let Some(waist) = found else { return };
        let aim = Aim::new(waist, !curve.is_flipped());
        if aim.onward((&self.hunt.scout.area, reach), pose, 1) == Onward::Over {
            let moved = self.front.pace() * self.lap.age();
            let is_near = moved <= MOVED * reach * METRE;
            let is_flipped = !curve.is_flipped();
            self.lap.turn(is_near);
            match self.lap.back() {
                Some(begun) => curve.begin_at(begun, (is_flipped, self.lap.age())),
                None => curve.begin_at(waist, (is_flipped, 0.0)),
            }
        }
    }

    /// Keeps the stretch in mind, and turns at its ends, and where the front leaves the area.
    fn keep_stretch(&mut self, pose: Pose) {
        let (reach, found) = (self.hunt.scout.reach(), self.found());
        let is_along = !self.curve.is_flipped();
        let then = |MapPlace { waist, age, .. }| FormerFront { waist, age };
        let passed = self.curve.places_then().map(then);
        let is_at_end = self.stretch.observe(
            pose.site,
            (found, passed),
            (is_along, reach * METRE, self.front.pace()),
        );
        let is_over = |waist| {
            let aim = Aim::new(waist, is_along);
            aim.onward((&self.hunt.scout.area, reach), pose, 1) == Onward::Over
        };
        if is_at_end || found.is_some_and(is_over) {
            self.curve.turn_round();
            self.stretch.turn();
        }
    }

    /// The next motion where the front is sought.
    fn seek(&mut self, pose: Pose) -> Plan {
        if !self.hunt.lines.is_certain() {
            return self.hunt.seek(pose);
        }
        self.take_lead(pose); // between given points
        if self.curve.is_begun() {
            return self.follow(pose);
        }
        let search = self.hunt.scout.search(pose);
        search.unwrap_or(Plan::Stop(StopReason::Cornered))
    }

    /// The next motion along the front.
    fn follow(&mut self, pose: Pose) -> Plan {
        let (scout, curve) = (&self.hunt.scout, &self.curve);
        let (reach, radius) = (scout.reach(), scout.radius());
        let aim = Aim::new(curve.now(), !curve.is_flipped());
        let with = (&scout.area, reach);
        // A watch has no label to spare where the front moves.
        let audits = N == 0 && self.found().is_some();
        let due = self.turns.due().filter(|_| audits);
        let audit = due.and_then(|it| certain_place(&scout.area, curve, pose, it));
        let place = audit.or_else(|| best_place((&scout.area, radius), curve, pose));
        let leg = place.and_then(|it| towards((&scout.dynamics, &scout.area, radius), pose, it));
        let (best, examined) = match leg {
            Some((leg, examined)) => (Some(BestEnd { leg, worth: 0.0 }), examined),
            None => (None, 0),
        };
        // Where no label tells anything it goes on along the front, no nearer than it can turn.
        let about = ((radius / reach) as u16).max(1);
        let is_found = self.found().is_some();
        // In this order: the first to which there is a way.
        let (stage, places) = match aim.onward(with, pose, about) {
            // Beyond a keep-out it goes on no nearer than it can turn, if it is free there.
            Onward::Beyond(site) if is_found => {
                let far = (radius > 0.0).then(|| aim.first_free(with, pose, 2 * about)).flatten();
                (Stage::Pass, [far, Some(site)])
            }
            _ if best.is_some() => (Stage::Follow, [None; 2]),
            _ => (Stage::Return, [aim.first_free(with, pose, about), Some(aim.waist.site)]),
        };
        let best = best.map(|best| (best, Stage::Follow));
        let tells = |site: Site| curve.tells(curve.share_above(site));
        let plan = self.hunt.scout.go(pose, (stage, places), best, (FAINT, examined), tells);
        plan.unwrap_or_else(|| {
            // There is no way on along what is known: it is sought elsewhere.
            self.curve.lose();
            let scout = &mut self.hunt.scout;
            scout.quest.lose(&scout.area);
            self.hunt.scout.search(pose).unwrap_or(Plan::Stop(StopReason::Cornered))
        })
    }
}

impl<D: Dynamics, G: Workspace, const N: usize> Planner for Track<D, G, N> {
    type Belief = Curve;

    fn plan(&mut self, pose: Pose) -> Plan {
        self.curve.clear_mapped();
        if self.led.is_some() {
            return Plan::Stop(StopReason::Undecided);
        }
        self.seek_next();
        if self.ends && self.lap.is_over() {
            return Plan::Stop(StopReason::Closed);
        }
        // From each of two places the way to the other may look better: nothing has changed since it was here.
        if self.heard_at == Some(pose) && self.hunt.scout.silence.is_back() {
            return Plan::Stop(StopReason::Undecided);
        }
        if self.lap.face(pose.heading) {
            self.curve.face(pose.heading);
        }
        if let Some(plan) = self.hunt.scout.come_home(pose) {
            return plan;
        }
        if let Some(Waist { site, .. }) = self.lap.back() {
            let to = (Stage::Return, [Some(site), None]);
            if let Some(plan) = self.hunt.scout.go(pose, to, None, (FAINT, 0), |_| 0.0) {
                return plan;
            }
            return Plan::Stop(StopReason::Cornered);
        }
        match if self.curve.is_begun() { self.follow(pose) } else { self.seek(pose) } {
            Plan::Stop(StopReason::OneLabel) if self.hunt.scout.quest.has_mapped() => {
                Plan::Stop(StopReason::Closed)
            }
            plan => plan,
        }
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        if reading.is_some() && tolerance > self.curve.tolerance() {
            return Err(ObservationError::Tolerance(tolerance));
        }
        if reading.is_some() {
            self.heard_at = Some(pose);
        }
        if !self.curve.is_begun() {
            return self.seek_on(pose, reading, tolerance);
        }
        if self.lap.back().is_none() {
            self.curve.moved(pose.site, 1.0);
            if let Some(reading) = reading {
                let expected = sure_label(self.curve.share_above(pose.site));
                self.curve.observe_within(pose.site, reading, tolerance)?;
                self.turns.hear(reading, expected);
            }
            self.judge(pose);
        }
        let scout = &mut self.hunt.scout;
        if let Some(reading) = reading {
            scout.hear(pose.site, reading);
        }
        scout.silence.observe(reading.is_some());
        scout.quest.moved(pose.site, reading.is_some());
        match self.led {
            Some(led) => self.led = Some(led.to(pose.site, &mut self.curve)),
            None if N > 0 => self.keep_stretch(pose),
            None => self.keep_lap(pose),
        }
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        if self.lap.back().is_some() {
            return Ok(false);
        }
        if !self.curve.is_begun() {
            return self.hunt.observe_on_the_way(site, reading);
        }
        let is_kept = self.curve.observe_on_the_way(site, reading)?;
        if is_kept {
            self.hunt.scout.hear(site, reading);
            self.hunt.scout.silence.hear();
        }
        Ok(is_kept)
    }

    fn belief(&self) -> &Curve {
        &self.curve
    }

    fn alarm(&self) -> Option<Alarm> {
        self.curve.evidence().alarm()
    }

    fn front(&self) -> Option<FrontState> {
        Some(FrontState { waist: self.found(), is_closed: self.is_closed() })
    }
}

impl<D: Dynamics, G: Workspace, const N: usize> Restart for Track<D, G, N> {
    /// It stores no samples.
    const ROOM: [usize; 2] = [u16::MAX as usize, 1];

    /// Begins again in the rectangle around its area. Nothing is told of how likely fronts are.
    fn restart(&mut self, given: &[Sample], _: Prior, noise: Noise) -> Result<(), SetupError> {
        (self.lap, self.heard_at, self.turns) = (Lap::NONE, None, Turns::default());
        self.stretch = WatchedStretch::new(self.stretch.length());
        self.hunt.restart(noise, &[])?;
        self.begin_curve(noise.into());
        self.begin(self.hunt.scout.quest.seeking())?;
        self.know(given);
        Ok(())
    }
}

impl<D: Dynamics, G: Workspace, const N: usize> Persist for Track<D, G, N> {
    type Snapshot = Snapshot<CurveMemory, TrackMemory<N>>;

    fn snapshot(&self) -> Self::Snapshot {
        let Scout { silence, quest, .. } = &self.hunt.scout;
        let (silence, quest) = (*silence, quest.memory());
        let Self { lap, heard_at, turns, .. } = *self;
        let stretch = self.stretch.clone();
        let closing = (!self.curve.is_begun()).then(|| self.hunt.lines.log());
        let memory = TrackMemory { silence, lap, stretch, heard_at, turns, quest, closing };
        Snapshot::new(self.mark(), self.curve.log(), memory)
    }

    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError> {
        let (log, memory) = snapshot.open(self.mark())?;
        let is_possible =
            memory.lap.is_possible() && memory.stretch.is_possible() && memory.turns.is_possible();
        // It is part of the mission, and not of what is remembered.
        let is_stretch = memory.stretch.length().to_bits() == self.stretch.length().to_bits();
        if !is_possible || !is_stretch || !self.hunt.scout.quest.recall(&memory.quest) {
            return Err(ReplayError::Spoilt.into());
        }
        self.curve.replay(log)?;
        if let Some(closing) = &memory.closing {
            self.hunt.lines.replay(closing)?;
        }
        (self.lap, self.heard_at, self.turns) = (memory.lap, memory.heard_at, memory.turns);
        self.stretch = memory.stretch.clone();
        self.hunt.scout.silence = memory.silence;
        Ok(())
    }
}
