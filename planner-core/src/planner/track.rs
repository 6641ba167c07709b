//! A planner that finds a front and goes along it.
//!
//! It learns from a [`Tracker`], and looks one motion ahead. What it does depends on what is known:
//!
//! - **Seek**: as long as nothing is known of the front, it drives along a route over the area (`quest.rs`). Close to the
//!   front, a place is worth the information of its label over a price and the way there.
//! - **Follow**: once the front is found, an end of the next motion is worth the information of its label, and the
//!   progress along the front as a share of the reach, the way that the robot faced at the start. What else it drives
//!   costs as much as that. Where the front is not known well, progress counts less, and in the end not at all. So the
//!   robot stops to look where it must. A vehicle that cannot turn on the spot is judged by the place where it would have
//!   turned along the front again, and pays for its way there instead.
//! - **Go round**: where a keep-out lies on the front, the robot goes to the first place beyond it. Where the front
//!   leaves the area, it goes back in the other direction.
//! - **Come home**: where no label in reach would tell anything, the robot goes to the front, a reach ahead. If it has
//!   turned all round on such ways without a label, it reads one where it arrives.
//! - **Begin again**: an alarm of the tracker's evidence says that the front bends more tightly than was told, or is
//!   lost. Then it is sought anew nearby. It is sought all over the area, as at the start, if it is most likely not
//!   where it was.
//!
//! A plan looks at [`LOOKED_AT`] places at most. A mission ends where no front is left to find, where there is no way on,
//! where the robot is back at its last label, or where [a closed front](Track::until_closed) is to end it.

use crate::belief::ObservationError;
use crate::belief::evidence::Alarm;
use crate::belief::field::Seeking;
use crate::belief::front::{FrontMemory, FrontStretch, NINETY, Tracker, Unit, Waist};
use crate::belief::noise::Noise;
use crate::belief::observation_log::{FromLog as _, ReplayError};
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::weight::Prior;
use crate::geometry::approximate::{METRE, distance, sqrt};
use crate::geometry::area::Area;
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::front_state::FrontState;
use crate::planner::guard::Guard;
use crate::planner::lap::Lap;
use crate::planner::one_label::OneLabel;
use crate::planner::quest::QuestMemory;
use crate::planner::scout::{Ends, FAINT, FOUND, LOOKED_AT, Scout};
use crate::planner::setup::{Restart, SetupError};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Kind, Persist, RestoreError, Snapshot};
use crate::planner::{Plan, Planner, Stage, StopReason};

/// How a vehicle goes along a front.
struct Gait {
    /// The ends of motions that a plan looks at.
    ends: Ends,
    /// Progress counts in full where the half-width is below this share of the [span](Scout::span). It does not count
    /// where the front would not count as found.
    full: f32,
    /// What it drives besides its progress costs so many times as much as that.
    besides: f32,
}

/// It turns on the spot: it looks beside the best end, where a label tells less, and comes back soon.
const ON_THE_SPOT: Gait =
    Gait { ends: Ends { circles: 3, beside: 4, most: LOOKED_AT }, full: 0.7, besides: 1.0 };

/// It needs a turning circle, and pays for its way back to the front.
const IN_CIRCLES: Gait =
    Gait { ends: Ends { circles: 3, beside: 0, most: LOOKED_AT }, full: 0.5, besides: 0.0 };

/// Where the front would not count as found, progress counts so much the other way: the robot rather goes back.
const BACK: f32 = 0.02;

/// A vehicle that goes along the front is to stay within this share of its half-width.
const LANE: f32 = 0.5;

/// A keep-out on the front is passed if it is no longer than so many reaches.
const BEYOND: u16 = 10;

/// Radians in a unit of an angle.
const RADIAN: f32 = core::f32::consts::PI / (1_u32 << 31) as f32;

/// A planner that finds a front and goes along it: `D` is the vehicle, `G` the area; the rest are the
/// [`Tracker`]'s.
///
/// ```
/// # use planner_core::{
/// #     Area, Front, Heading, Label, Noise, Plan, Planner as _, Pose, Track, Tracker, Unicycle,
/// # };
/// # use planner_core::nalgebra::Point2;
/// let area = Area::metres([0.0, 0.0], [200.0, 200.0])?;
/// let front = Front::bending(40.0)?;
/// let start = Area::metres([90.0, 50.0], [110.0, 70.0])?; // it crosses this part
/// let tracker = Tracker::<16, 16, 3>::new(start, front, Noise::new(0.95)?);
/// let mut planner = Track::new(area, Unicycle::default(), tracker)?;
/// let mut pose = Pose::at([100.0, 58.0], Heading::default())?;
/// for _ in 0..150 {
///     let Plan::Move(motion) = planner.plan(pose) else { break };
///     pose = motion.target;
///     // The front is a circle.
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
pub struct Track<D, const K: usize, const M: usize, const L: usize, G = Area> {
    scout: Scout<D, K, M, L, G>,
    lap: Lap,
    /// The pose at the last label that was read at the end of a motion.
    heard_at: Option<Pose>,
    /// Whether it ends once the front is closed.
    ends: bool,
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace>
    Track<D, K, M, L, G>
{
    /// A planner with what is known so far.
    ///
    /// Motions end where the tracker's tolerance cannot bring the robot out of the area. They are no longer than an
    /// eighth of the tightest bend's radius.
    ///
    /// # Errors
    /// [`SetupError`].
    #[inline] // it is made where it stays, as it may be large
    pub fn new(area: G, dynamics: D, tracker: Tracker<K, M, L>) -> Result<Self, SetupError> {
        Ok(Self::with(Scout::new(area, dynamics, tracker)?))
    }

    /// The same in the part of an area that motions [aim for](crate::planner::setup::aimed_for).
    #[inline]
    pub(crate) fn of((area, dynamics): (G, D), tracker: Tracker<K, M, L>) -> Self {
        Self::with(Scout::of((area, dynamics), tracker))
    }

    #[inline]
    fn with(scout: Scout<D, K, M, L, G>) -> Self {
        Self { scout, lap: Lap::NONE, heard_at: None, ends: false }
    }

    /// Where the front is known best; `None` as long as it is not found, and where it is lost.
    pub fn found(&self) -> Option<Waist> {
        self.scout.found()
    }

    /// The [half-width](Tracker::found) below which the front counts as found, metres: one and a half of the longest
    /// motion, or of the radius of the turning circle if that is longer.
    pub fn width(&self) -> f32 {
        self.scout.width()
    }

    /// After an alarm the front is sought within so many metres: six of the longest motions.
    pub fn near(&self) -> f32 {
        self.scout.near()
    }

    /// The same, but it ends once the front [is closed](Self::is_closed).
    #[must_use]
    pub fn until_closed(self) -> Self {
        Self { ends: true, ..self }
    }

    /// The planner that does not go along the front, but stays with so many metres of it, about the place where it finds
    /// it. It learns where the front is all along them, and does not end for a closed front.
    ///
    /// # Errors
    /// [`ValueError`] unless the length is from 0.1 to 10,000 m.
    pub fn watching(self, metres: f64) -> Result<Guard<D, K, M, L, G>, ValueError> {
        Ok(Guard::of(self.scout, FrontStretch::metres(metres)?))
    }

    /// The same with what is said of a front of which nothing is known.
    ///
    /// # Errors
    /// [`SetupError::Patch`] if patches of this radius do not suit the area.
    pub fn seeking(mut self, seeking: Seeking) -> Result<Self, SetupError> {
        self.scout.begin(seeking)?;
        Ok(self)
    }

    /// The same after some points whose labels are known for sure, of one label or of both. Call it before the first
    /// plan, and after [`seeking`](Self::seeking).
    #[must_use]
    pub fn knowing(mut self, points: &[Sample]) -> Self {
        self.scout.know(points);
        self
    }

    /// The same, but it seeks the front along a route of your own first, up to 16 corners of it.
    #[must_use]
    pub fn surveying(mut self, corners: &[Site]) -> Self {
        self.scout.quest.survey(corners);
        self
    }

    /// The label that all of the area has, if it most likely has one; and what may be left of the other one. The planner
    /// ends with [`StopReason::OneLabel`] then.
    pub fn one_label(&self) -> Option<OneLabel> {
        self.scout.one_label()
    }

    /// Whether the robot has gone along all of a closed front, and is back where it found it.
    pub const fn is_closed(&self) -> bool {
        self.lap.is_closed()
    }

    /// The first place on the front in the area, from so many reaches ahead of a pose on.
    fn first_free(&self, aim: &Aim, pose: Pose, from: u16) -> Option<Site> {
        let reach = self.scout.reach() * METRE;
        let reach = if aim.is_along { reach } else { -reach };
        let beside = aim.waist.ahead(pose.site);
        let place = |k: u16| aim.waist.place_at(beside + f32::from(k) * reach);
        (from..=BEYOND).map_while(place).find(|site| self.scout.area.contains(*site))
    }

    /// How the front goes on from a pose.
    fn onward(&self, aim: &Aim, pose: Pose) -> Onward {
        let (next, beyond) = (self.first_free(aim, pose, 1), self.first_free(aim, pose, 2));
        match beyond {
            _ if next != beyond => Onward::Free,
            Some(site) => Onward::Beyond(site),
            None => Onward::Over,
        }
    }

    /// Which way to go along a front that is found.
    fn aim(&self, waist: Waist, pose: Pose) -> Aim {
        let is_along = self.lap.sense_along(waist, pose);
        Aim::new(waist, pose, is_along)
    }
}

/// How the front goes on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Onward {
    /// The robot may go on along it.
    Free,
    /// A keep-out lies on it, and here it is free again.
    Beyond(Site),
    /// It leaves the area.
    Over,
}

/// Which way the robot goes along the front.
struct Aim {
    waist: Waist,
    is_along: bool,
    heading: Heading,
    along: Unit,
}

/// Where a vehicle faces along the front again, if it turns from a pose as tightly as it can; and its way there.
struct Turned {
    site: Site,
    way: f32,
}

impl Aim {
    fn new(waist: Waist, pose: Pose, is_along: bool) -> Self {
        let forwards = waist.heading_at(waist.ahead(pose.site));
        let heading = if is_along { forwards } else { forwards.turned(Angle::HALF_TURN) };
        Self { waist, is_along, heading, along: Unit::of(heading) }
    }

    /// Where a vehicle that is at a pose will have turned, on a circle of this radius: for one that turns on the spot, where
    /// it is.
    fn turned(&self, pose: Pose, radius: f32) -> Turned {
        let off = pose.heading.since(self.heading);
        let Unit { x: cos, z: sin } = Unit::of(Heading(off.0));
        let (ahead, aside) = (radius * sin.abs(), radius * (1.0 - cos));
        let aside = if sin < 0.0 { -aside } else { aside };
        let Unit { x, z } = self.along;
        let by = Vector::new((ahead * x - aside * z) as i32, (ahead * z + aside * x) as i32);
        let site = by.and_then(|by| pose.site.step(by).ok()).unwrap_or(pose.site);
        Turned { site, way: radius * (off.0 as i32).unsigned_abs() as f32 * RADIAN }
    }

    /// The way on which a vehicle shifts back to the front from a place, where that lies too far aside: two arcs of a
    /// circle of this radius, lattice units. `half` is the front's half-width there, metres.
    fn shift(&self, site: Site, half: f32, radius: f32) -> f32 {
        let aside = self.waist.aside(site).abs() - LANE * half;
        // Two arcs that turn by an angle t go aside by 2 R (1 - cos t), and are 2 R t long.
        2.0 * sqrt(radius * aside * UNITS_PER_METRE as f32)
    }

    /// The progress of a way that ends where the front has this half-width, lattice units. It counts less where the front
    /// is not known well, and not at all where it is hardly known. A robot with poor labels would otherwise run ahead of
    /// what it knows.
    fn progress(&self, way: Vector, half: f32, (span, full): (f32, f32)) -> f32 {
        let counts = match half * UNITS_PER_METRE as f32 / span {
            width if width <= full => 1.0,
            width if width <= FOUND => (FOUND / width - 1.0) / (FOUND / full - 1.0),
            _ => -BACK,
        };
        let progress = way.x as f32 * self.along.x + way.z as f32 * self.along.z;
        counts * progress
    }
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace> Planner
    for Track<D, K, M, L, G>
{
    type Belief = Tracker<K, M, L>;

    fn plan(&mut self, pose: Pose) -> Plan {
        if self.ends && self.lap.is_closed() {
            return Plan::Stop(StopReason::Closed);
        }
        // From each of two places the way to the other may look better: nothing has changed since it was here.
        if self.heard_at == Some(pose) && self.scout.silence.is_back() {
            return Plan::Stop(StopReason::Undecided);
        }
        self.lap.face(pose.heading);
        let Some(waist) = self.found() else { return self.scout.seek(pose) };
        let aim = self.aim(waist, pose);
        let scout = &self.scout;
        let (reach, span, radius) = (scout.reach(), scout.span(), scout.radius());
        let gait = if radius > 0.0 { &IN_CIRCLES } else { &ON_THE_SPOT };
        let turned = |end: Pose| aim.turned(end, radius);
        let worth = |end: Pose, share: f32| {
            let told = scout.tells(share)?;
            let Turned { site, way } = turned(end);
            let half = NINETY * aim.waist.deviation_beside(site);
            let on = site - pose.site;
            let progress = aim.progress(on, half, (span, gait.full));
            let back = way + aim.shift(site, half, radius);
            let lost = back + gait.besides * (distance(on) - progress);
            Some(told + (progress - lost) / reach)
        };
        let place = |end: Pose| turned(end).site;
        let (best, examined) = scout.best_end(pose, gait.ends, place, worth);
        let is_inside = scout.area.contains(pose.site);
        // Where no label tells anything it goes on along the front, no nearer than it can turn.
        let about = ((radius / reach) as u16).max(1);
        // In this order: the first to which there is a way.
        let (stage, places) = match self.onward(&aim, pose) {
            _ if !is_inside => (Stage::Return, [scout.home(pose), None]),
            Onward::Beyond(site) => (Stage::Pass, [Some(site), None]),
            _ if best.is_some() => (Stage::Follow, [None; 2]),
            _ => (Stage::Return, [self.first_free(&aim, pose, about), Some(aim.waist.site)]),
        };
        let why = if is_inside { StopReason::Cornered } else { StopReason::OutsideArea };
        let best = best.map(|best| (best, Stage::Follow));
        let plan = self.scout.go(pose, (stage, places), best, (FAINT, examined));
        plan.unwrap_or(Plan::Stop(why))
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        let scout = &mut self.scout;
        scout.observe(pose, reading, tolerance)?;
        if reading.is_some() {
            self.heard_at = Some(pose);
        }
        scout.seek_anew(pose.site);
        let (reach, found) = (scout.reach(), scout.found());
        self.lap.observe(found, pose, reach);
        let aim = found.map(|waist| self.aim(waist, pose));
        if aim.is_some_and(|aim| self.onward(&aim, pose) == Onward::Over) {
            self.lap.turn();
        }
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        self.scout.observe_on_the_way(site, reading)
    }

    fn belief(&self) -> &Tracker<K, M, L> {
        &self.scout.tracker
    }

    fn alarm(&self) -> Option<Alarm> {
        self.scout.tracker.evidence().alarm()
    }

    fn front(&self) -> Option<FrontState> {
        Some(FrontState { waist: self.found(), is_closed: self.is_closed() })
    }
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace> Restart
    for Track<D, K, M, L, G>
{
    /// It stores no samples.
    const ROOM: [usize; 2] = [u16::MAX as usize, 1];

    /// Begins again in the rectangle around its area. A tracker has one prior: see [`Tracker::new`].
    fn restart(&mut self, given: &[Sample], _: Prior, noise: Noise) -> Result<(), SetupError> {
        (self.lap, self.heard_at) = (Lap::NONE, None);
        self.scout.restart(noise, given)
    }
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace> Persist
    for Track<D, K, M, L, G>
{
    type Snapshot = Snapshot<FrontMemory<K, M, L>, (Silence, Lap, Option<Pose>, QuestMemory)>;

    fn snapshot(&self) -> Self::Snapshot {
        let Scout { tracker, silence, quest, .. } = &self.scout;
        Snapshot::new(
            self.scout.mark(Kind::Track),
            tracker.log(),
            (*silence, self.lap, self.heard_at, quest.memory()),
        )
    }

    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError> {
        let (log, &(silence, lap, heard_at, ref quest)) =
            snapshot.open(self.scout.mark(Kind::Track))?;
        if !lap.is_possible() || !self.scout.quest.recall(quest) {
            return Err(ReplayError::Spoilt.into());
        }
        self.scout.tracker.replay(log)?;
        (self.scout.silence, self.lap, self.heard_at) = (silence, lap, heard_at);
        Ok(())
    }
}
