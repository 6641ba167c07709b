//! A planner that finds a front and goes along it.
//!
//! It learns from a [`Tracker`], and looks one motion ahead. What it does depends on what is known:
//!
//! - **Seek**: as long as the front is not found, a place is worth the information of its label over a price and the
//!   way there. The places are ends of the next motion, some along the mean line, and some all over the area.
//! - **Follow**: once the front is found, an end of the next motion is worth the information of its label, and the
//!   progress along the front as a share of the reach, the way that the robot faced at the start. Where the front is not
//!   known well, progress counts less, and in the end not at all. So the robot stops to look where it must.
//! - **Go round**: where a keep-out lies on the front, the robot goes to the first place beyond it. Where the front
//!   leaves the area, it goes back in the other direction.
//! - **Come home**: where no label in reach would tell anything, the robot goes back to the front. If it has turned all
//!   round on such ways without a label, it reads one where it arrives.
//! - **Begin again**: an alarm of the tracker's evidence says that the front bends more tightly than was told, or is
//!   lost. Then it is sought anew nearby.
//!
//! A plan looks at [`LOOKED_AT`] places at most. A mission ends where no front is left to find, where there is no way on,
//! where the robot is back at its last label, or where [a closed front](Track::until_closed) is to end it.

use crate::belief::ObservationError;
use crate::belief::evidence::Alarm;
use crate::belief::front::{FrontMemory, NINETY, Tracker, Unit, Waist};
use crate::belief::noise::Noise;
use crate::belief::observation_log::FromLog as _;
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::weight::Prior;
use crate::geometry::approximate::METRE;
use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::front_state::FrontState;
use crate::planner::guard::Guard;
use crate::planner::lap::Lap;
use crate::planner::scout::{AGAIN, FAINT, FOUND, LOOKED_AT, OneLabel, Scout};
use crate::planner::setup::{Restart, SetupError};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Persist, RestoreError, Snapshot};
use crate::planner::{Plan, Planner, Stage, StopReason};

/// Circles on which a motion along a front may end.
const CIRCLES: u16 = 4;

/// Progress counts in full where the half-width is below the first share of the reach: 1 m for 2 m. It does not count
/// where it is above the second.
const WIDTHS: [f32; 2] = [0.5, 1.4];

/// Where the front would not count as found, progress counts so much the other way: the robot rather goes back.
const BACK: f32 = 0.02;

/// A keep-out on the front is passed if it is no longer than so many reaches.
const BEYOND: u16 = 10;

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

    /// The [half-width](Tracker::found) below which the front counts as found, metres: one and a half of the longest motion.
    pub fn width(&self) -> f32 {
        self.scout.width()
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
        Guard::of(self.scout, metres)
    }

    /// The label that all of the area has, if it most likely has one; and how much of it may have the other one. The
    /// planner ends with [`StopReason::OneLabel`] where no label in reach is expected to tell much.
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
    along: Unit,
}

impl Aim {
    fn new(waist: Waist, pose: Pose, is_along: bool) -> Self {
        let Unit { x, z } = Unit::of(waist.heading_at(waist.ahead(pose.site)));
        let sign = if is_along { 1.0 } else { -1.0 };
        Self { waist, is_along, along: Unit { x: sign * x, z: sign * z } }
    }

    /// The progress of a way that ends at a site, as a share of the reach. It counts less where the front is not known
    /// well, and not at all where it is hardly known. A robot with poor labels would otherwise run ahead of what it knows.
    fn progress(&self, way: Vector, to: Site, reach: f32) -> f32 {
        let half = NINETY * self.waist.deviation_beside(to) * UNITS_PER_METRE as f32;
        let [full, none] = WIDTHS;
        let counts = match half / reach {
            width if width <= full => 1.0,
            width if width <= none => (none / width - 1.0) / (none / full - 1.0),
            width if width <= FOUND => 0.0,
            _ => -BACK,
        };
        let progress = way.x as f32 * self.along.x + way.z as f32 * self.along.z;
        counts * progress / reach
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
        let (scout, reach) = (&self.scout, self.scout.reach());
        let worth = |way: Vector, to: Site, share: f32| {
            scout.tells(share).map(|told| told + aim.progress(way, to, reach))
        };
        let (best, examined) = scout.best_end(pose, (CIRCLES, LOOKED_AT), worth);
        let is_inside = scout.area.contains(pose.site);
        // In this order: the first to which there is a way.
        let (stage, places) = match self.onward(&aim, pose) {
            _ if !is_inside => (Stage::Return, [scout.home(pose), None]),
            Onward::Beyond(site) => (Stage::Pass, [Some(site), None]),
            _ if best.is_some() => (Stage::Follow, [None; 2]),
            _ => (Stage::Return, [self.first_free(&aim, pose, 0), Some(aim.waist.site)]),
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
        let reach = scout.reach();
        if scout.tracker.evidence().value() >= Alarm::ALARM {
            scout.tracker.seek_near(pose.site, AGAIN * reach * METRE);
        }
        let found = scout.found();
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
    type Snapshot = Snapshot<FrontMemory<K, M, L>, (Silence, Lap, Option<Pose>)>;

    fn snapshot(&self) -> Self::Snapshot {
        let Scout { tracker, silence, .. } = &self.scout;
        Snapshot::new(tracker.log(), (*silence, self.lap, self.heard_at))
    }

    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError> {
        let (log, &(silence, lap, heard_at)) = snapshot.open()?;
        self.scout.tracker.replay(log)?;
        (self.scout.silence, self.lap, self.heard_at) = (silence, lap, heard_at);
        Ok(())
    }
}
