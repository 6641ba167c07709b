//! A planner that finds a front and goes along it.
//!
//! It learns from a [`Tracker`], and looks one motion ahead. What it does depends on what is known:
//!
//! - **Seek**: as long as the front is not found, a place is worth the information of its label over a price and the
//!   way there. The places are ends of the next motion, some along the mean line, and some all over the area.
//! - **Follow**: once the front is found, an end of the next motion is worth the information of its label, and the
//!   progress along the front as a share of the reach. Where the front is not known well, progress counts less. So the
//!   robot stops to look where it must.
//! - **Go round**: where a keep-out lies on the front, the robot goes to the first place beyond it. Where the front
//!   leaves the area, it goes back in the other direction.
//! - **Come home**: where no label in reach would tell anything, the robot goes back to the front.
//! - **Begin again**: an alarm of the tracker's evidence says that the front bends more tightly than was told, or is
//!   lost. Then it is sought anew nearby.
//!
//! A plan looks at [`LOOKED_AT`] ends at most, and at 53 places where the front is sought. It does not end by itself,
//! unless there is no way on, or [a closed front](Track::until_closed) is to end it.

use crate::belief::evidence::Alarm;
use crate::belief::front::{FrontMemory, NINETY, Tracker, Unit, Waist};
use crate::belief::noise::Noise;
use crate::belief::observation_log::FromLog as _;
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::weight::Prior;
use crate::belief::{Belief as _, ObservationError};
use crate::geometry::approximate::{METRE, distance};
use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::front_state::FrontState;
use crate::planner::lap::Lap;
use crate::planner::setup::{Restart, SetupError, aimed_for, aimed_for_by};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Persist, RestoreError, Snapshot};
use crate::planner::{Motion, Plan, Planner, Stage, StopReason};
use crate::search::course::Course;
use crate::search::dead_end::place;
use crate::search::errand::{Errand, errand};
use crate::search::motions::Leg;
use crate::search::objective::{Effort, LOOKS};
use crate::search::places::Places;
use crate::search::recovery::Found;

/// Ends of motions that a plan looks at, at most.
pub const LOOKED_AT: u32 = 112;

/// Circles on which a motion may end, along a front, and where it is sought.
const CIRCLES: u16 = 4;
const SEEKING: u16 = 2;

/// Places along the mean line, a reach apart, and others all over the area.
const ALONG: u16 = 17;
const PLACES: u32 = 36;

/// The price of a label, as a share of the reach: it keeps places that are near from being all that is considered.
const PRICE: f32 = 0.5;

/// The reach is at most this share of the tightest bend's radius, and of the mean of the area's sides.
const SHORT: f32 = 0.125;

/// A front is found where its half-width is below so many reaches.
const FOUND: f32 = 1.5;

/// Progress counts in full where the half-width is below this share of the reach: 0.5 m for 2 m.
const WIDTH: f32 = 0.25;

/// A label that tells less than this share of what one can tell is not worth its way.
const LEAST: f32 = 0.1;

/// One that tells less than this is not read on the way to a place.
const FAINT: f32 = 0.05;

/// After an alarm the front is sought within so many reaches.
const AGAIN: f32 = 6.0;

/// An errand ends within this share of the reach.
const NEAR: f32 = 0.25;

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
    area: G,
    dynamics: D,
    tracker: Tracker<K, M, L>,
    /// The fastest speed that is considered.
    fastest: u16,
    silence: Silence,
    lap: Lap,
    /// Whether it ends once the front is closed.
    ends: bool,
}

/// The best end of a motion so far, its worth, and what its label tells.
#[derive(Clone, Copy)]
struct Best {
    leg: Leg,
    worth: f32,
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
        let area = aimed_for_by(area, &dynamics, &tracker)?;
        Ok(Self::of((area, dynamics), tracker))
    }

    /// The same in the part of an area that motions [aim for](crate::planner::setup::aimed_for).
    #[inline]
    pub(crate) fn of((area, dynamics): (G, D), tracker: Tracker<K, M, L>) -> Self {
        let (grid, side) = (dynamics.grid(), area.bounds().mean_side());
        let bend = tracker.front().bend();
        let radius = if bend > 0.0 { UNITS_PER_METRE as f32 / bend } else { side };
        let longest = SHORT * if radius < side { radius } else { side };
        let most = (longest / grid.step_units()) as u16;
        let fastest = grid.speeds().saturating_sub(1).min(most).max(1);
        Self {
            area,
            dynamics,
            tracker,
            fastest,
            silence: Silence::NONE,
            lap: Lap::NONE,
            ends: false,
        }
    }

    /// Where the front is known best; `None` as long as it is not found, and where it is lost.
    pub fn found(&self) -> Option<Waist> {
        self.tracker.found(self.width())
    }

    /// The [half-width](Tracker::found) below which the front counts as found, metres: one and a half of the longest motion.
    pub fn width(&self) -> f32 {
        FOUND * METRE * self.reach()
    }

    /// The same, but it ends once the front [is closed](Self::is_closed).
    #[must_use]
    pub fn until_closed(self) -> Self {
        Self { ends: true, ..self }
    }

    /// Whether the robot has gone along all of a closed front, and is back where it found it.
    pub const fn is_closed(&self) -> bool {
        self.lap.is_closed()
    }

    /// The longest motion that is considered, lattice units.
    fn reach(&self) -> f32 {
        f32::from(self.fastest) * self.dynamics.grid().step_units()
    }

    /// What an end of a motion is worth that has this share of the curves above it; `None` if its label tells too
    /// little.
    fn worth(&self, from: Pose, to: Site, share: f32, aim: Option<&Aim>) -> Option<f32> {
        let told = self.tracker.tells(share);
        let (way, reach) = (to - from.site, self.reach());
        let worth = match aim {
            Some(aim) => told + aim.progress(way, to, reach),
            None => told / (PRICE * reach + distance(way)),
        };
        (told > LEAST).then_some(worth)
    }

    /// The best end of the next motion, and how many were looked at.
    fn best_end(&self, pose: Pose, aim: Option<&Aim>) -> (Option<Best>, u32) {
        let mut best: Option<Best> = None;
        let find = |leg: Leg, share: f32| {
            let worth = self.worth(pose, leg.1.site, share, aim);
            if let Some(worth) = worth.filter(|it| best.is_none_or(|best| *it > best.worth)) {
                best = Some(Best { leg, worth });
            }
        };
        let (dynamics, area) = (&self.dynamics, &self.area);
        let share = |site: Site| self.tracker.share_above(site);
        let mut places = Places { dynamics, area, pose, share, find, examined: 0, most: LOOKED_AT };
        let circles = if aim.is_some() { CIRCLES } else { SEEKING };
        for k in (1..=circles).rev() {
            let speed = u32::from(self.fastest) * u32::from(k) / u32::from(circles);
            if speed > 0 {
                let _ = places.circle(speed as u16); // the outer ones count most
            }
        }
        let examined = places.examined;
        (best, examined)
    }

    /// A place beyond the ends of one motion that is worth more than the best of these.
    fn far_place(&self, pose: Pose, least: f32) -> Option<Site> {
        let waist = self.tracker.waist();
        let unit = Unit::of(waist.heading);
        let along = |k: u16| {
            let ahead = (f32::from(k) - 0.5 * f32::from(ALONG - 1)) * self.reach();
            let by = Vector::new((unit.x * ahead) as i32, (unit.z * ahead) as i32)?;
            waist.site.step(by).ok().filter(|it| self.area.contains(*it))
        };
        let anywhere = (0..PLACES).filter_map(|k| place(&self.area, k));
        let (mut most, mut best) = (least, None);
        for site in (0..ALONG).filter_map(along).chain(anywhere) {
            let share = self.tracker.share_above(site);
            if let Some(worth) = self.worth(pose, site, share, None).filter(|it| *it > most) {
                (most, best) = (worth, Some(site));
            }
        }
        best
    }

    /// The first place on the front in the area, from so many reaches ahead of a pose on.
    fn first_free(&self, aim: &Aim, pose: Pose, from: u16) -> Option<Site> {
        let reach = self.reach() * METRE;
        let reach = if aim.is_along { reach } else { -reach };
        let beside = aim.waist.ahead(pose.site);
        let place = |k: u16| aim.waist.place_at(beside + f32::from(k) * reach);
        (from..=BEYOND).map_while(place).find(|site| self.area.contains(*site))
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

    /// Which way to go along the front, if it is found.
    fn aim(&self, pose: Pose) -> Option<Aim> {
        let waist = self.found()?;
        let is_along = self.lap.sense().unwrap_or_else(|| pose.heading.agrees(waist.heading));
        Some(Aim::new(waist, pose, is_along))
    }

    /// The motion to an end, and whether a label is to be read there.
    fn motion(
        &mut self,
        pose: Pose,
        doing: (Stage, Effort),
        (leg, wants_label): (Leg, bool),
    ) -> Plan {
        let (found, (stage, effort)) = (Found::of(None, leg), doing);
        let motion = Motion::of(Some(stage), pose, &found, &self.dynamics, effort);
        let motion = Motion { wants_label, ..motion };
        self.silence.keep(pose, motion, Course::NONE, &self.dynamics)
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
    /// well.
    fn progress(&self, way: Vector, to: Site, reach: f32) -> f32 {
        let half = NINETY * self.waist.deviation_beside(to) * UNITS_PER_METRE as f32;
        let most = WIDTH * reach;
        let counts = if half > most { most / half } else { 1.0 };
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
        let aim = self.aim(pose);
        let is_inside = self.area.contains(pose.site);
        let (best, examined) = self.best_end(pose, aim.as_ref());
        // In this order: the first to which there is a way.
        let (stage, places) = match &aim {
            _ if !is_inside => {
                (Stage::Return, [pose.site.step(self.area.way_home(pose.site)).ok(), None])
            }
            Some(aim) => match self.onward(aim, pose) {
                Onward::Beyond(site) => (Stage::Pass, [Some(site), None]),
                _ if best.is_some() => (Stage::Follow, [None; 2]),
                _ => (Stage::Return, [self.first_free(aim, pose, 0), Some(aim.waist.site)]),
            },
            None => {
                (Stage::Seek, [self.far_place(pose, best.map_or(0.0, |best| best.worth)), None])
            }
        };
        let mut effort = Effort { looks: LOOKS, examined };
        let near = NEAR * self.reach();
        let with = (&self.dynamics, &self.area);
        let mut places = places.into_iter().flatten();
        let on_the_way = places.find_map(|site| errand(with, pose, (site, near), &mut effort));
        match (on_the_way, best) {
            (Some(Errand { leg, .. }), _) => {
                let told = self.tracker.tells(self.tracker.share_above(leg.1.site));
                let wants_label = leg.1.site != pose.site && told > FAINT;
                self.motion(pose, (stage, effort), (leg, wants_label))
            }
            (None, Some(Best { leg, .. })) => {
                let stage = if aim.is_some() { Stage::Follow } else { Stage::Seek };
                self.motion(pose, (stage, effort), (leg, true))
            }
            (None, None) if is_inside => Plan::Stop(StopReason::Cornered),
            (None, None) => Plan::Stop(StopReason::OutsideArea),
        }
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        if reading.is_some() && tolerance > self.tracker.tolerance() {
            return Err(ObservationError::Tolerance(tolerance));
        }
        self.tracker.moved(pose.site, 1.0);
        if let Some(reading) = reading {
            self.tracker.observe_within(pose.site, reading, tolerance)?;
        }
        self.silence.observe(reading.is_some());
        if self.tracker.evidence().value() >= Alarm::ALARM {
            self.tracker.seek_near(pose.site, AGAIN * self.reach() * METRE);
        }
        let (found, reach) = (self.found(), self.reach());
        self.lap.observe(found, pose, reach);
        if self.aim(pose).is_some_and(|aim| self.onward(&aim, pose) == Onward::Over) {
            self.lap.turn();
        }
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let is_kept = self.tracker.observe_on_the_way(site, reading)?;
        if is_kept {
            self.silence.hear();
        }
        Ok(is_kept)
    }

    fn belief(&self) -> &Tracker<K, M, L> {
        &self.tracker
    }

    fn alarm(&self) -> Option<Alarm> {
        self.tracker.evidence().alarm()
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
        self.area = aimed_for(self.area, &self.dynamics, noise.tolerance)?;
        self.tracker.restart(self.area.whole().bounds(), noise.into(), given);
        (self.silence, self.lap) = (Silence::NONE, Lap::NONE);
        Ok(())
    }
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace> Persist
    for Track<D, K, M, L, G>
{
    type Snapshot = Snapshot<FrontMemory<K, M, L>, (Silence, Lap)>;

    fn snapshot(&self) -> Self::Snapshot {
        Snapshot::new(self.tracker.log(), (self.silence, self.lap))
    }

    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError> {
        let (log, &(silence, lap)) = snapshot.open()?;
        self.tracker.replay(log)?;
        (self.silence, self.lap) = (silence, lap);
        Ok(())
    }
}
