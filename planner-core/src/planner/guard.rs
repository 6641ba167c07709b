//! Staying with a stretch of a front, to know at all times where the front is along it.
//!
//! The stretch is fixed once the front is found: its middle is the place where the front is known best then. A place is
//! worth what its label is expected to take of the front's variance, divided by the motions that lead there. The variance is
//! the mean over five places of the stretch. The planner looks at ends of the next motion, and at these places on the
//! mean front. The robot leaves the stretch by no more than a reach, unless it has to seek the front.
//!
//! The robot never waits: the stretch is always known least where the robot has not been for long. If no end of the
//! next motion tells enough, it goes to the best of these places. Once it has turned by half a turn without a label, it
//! reads one wherever it arrives. So it is not silent for long, and does not go to and fro for nothing.

use crate::belief::ObservationError;
use crate::belief::evidence::Alarm;
use crate::belief::field::Seeking;
use crate::belief::front::{ASKED, FrontMemory, FrontStretch, Spread, Tracker, Unit, Waist};
use crate::belief::noise::Noise;
use crate::belief::observation_log::{FromLog as _, ReplayError};
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::weight::Prior;
use crate::geometry::approximate::distance;
use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::front_state::FrontState;
use crate::planner::hunt::Hunt;
use crate::planner::quest::QuestMemory;
use crate::planner::scout::{Ends, FAINT};
use crate::planner::setup::{Restart, SetupError};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Kind, Persist, RestoreError, Snapshot};
use crate::planner::{Motion, Plan, Planner, Stage, StopReason};

/// The ends of motions that a plan looks at: a place costs more than along a front.
const ENDS: Ends = Ends { circles: 1, beside: 0, most: 24 };

/// A planner that finds a front and watches a stretch of it, about the place where it finds it. It learns where the
/// front is all along the stretch, and does not end for a closed front.
#[derive(Clone, Debug)]
pub struct Guard<D, const K: usize, const M: usize, const L: usize, G = Area> {
    hunt: Hunt<D, K, M, L, G>,
    stretch: FrontStretch,
    /// Its middle and direction, once the front is found.
    middle: Option<Pose>,
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace>
    Guard<D, K, M, L, G>
{
    /// A planner with what is known so far, for so much of a front. Motions are no longer than an eighth of the tightest
    /// bend's radius.
    ///
    /// # Errors
    /// [`SetupError`].
    #[inline] // it is made where it stays, as it may be large
    pub fn new(
        area: G,
        dynamics: D,
        tracker: Tracker<K, M, L>,
        stretch: FrontStretch,
    ) -> Result<Self, SetupError> {
        Ok(Self::with(Hunt::new(area, dynamics, tracker)?, stretch))
    }

    /// The same in the part of an area that motions [aim for](crate::planner::setup::aimed_for).
    #[inline]
    pub(crate) fn of(of: (G, D), tracker: Tracker<K, M, L>, stretch: FrontStretch) -> Self {
        Self::with(Hunt::of(of, tracker), stretch)
    }

    #[inline]
    fn with(mut hunt: Hunt<D, K, M, L, G>, stretch: FrontStretch) -> Self {
        hunt.tracker.stay();
        Self { hunt, stretch, middle: None }
    }

    /// The same with what is said of a front of which nothing is known.
    ///
    /// # Errors
    /// [`SetupError::Patch`] if patches of this radius do not suit the area.
    pub fn seeking(mut self, seeking: Seeking) -> Result<Self, SetupError> {
        self.hunt.begin(seeking)?;
        Ok(self)
    }

    /// The same after some points whose labels are known for sure, of one label or of both. Call it before the first
    /// plan, and after [`seeking`](Self::seeking).
    #[must_use]
    pub fn knowing(mut self, points: &[Sample]) -> Self {
        self.hunt.know(points);
        self
    }

    /// Where the front is known best; `None` as long as it is not found, and where it is lost. The tracker says where it
    /// lies [beside any place](Tracker::beside).
    pub fn found(&self) -> Option<Waist> {
        self.hunt.found()
    }

    /// The half-width below which the front counts as found, metres: one and a half of the longest motion, or of the
    /// radius of the turning circle if that is longer.
    pub fn width(&self) -> f32 {
        self.hunt.scout.width()
    }

    /// The middle of the stretch, and its direction. `None` before the front is found.
    pub fn stretch(&self) -> Option<Pose> {
        self.middle
    }

    /// Takes in where the front is known best. If that is further away than the stretch is long, the front has left,
    /// and the stretch lies there now.
    fn lie(&mut self) {
        let Some(Waist { site, heading, .. }) = self.found() else { return };
        let most = self.stretch.length() * UNITS_PER_METRE as f32;
        if self.middle.is_none_or(|it| distance(site - it.site) > most) {
            self.middle = Some(Pose { site, heading });
        }
    }

    /// What a plan needs of the stretch, if the front is found.
    fn ask(&self) -> Option<Asked> {
        let (waist, middle) = (self.found()?, self.middle?);
        let along = Unit::of(middle.heading);
        let half = 0.5 * self.stretch.length() * UNITS_PER_METRE as f32;
        let mut share = -1.0;
        let places = [(); ASKED].map(|()| {
            let by = Vector::new((along.x * half * share) as i32, (along.z * half * share) as i32);
            share += 2.0 / (ASKED as f32 - 1.0);
            let site = by.and_then(|by| middle.site.step(by).ok()).unwrap_or(middle.site);
            waist.place_at(waist.ahead(site)).unwrap_or(site)
        });
        let (middle, most) = (middle.site, half + self.hunt.scout.reach());
        let spread = self.hunt.tracker.spread_over(places);
        Some(Asked { waist, middle, along, most, places, spread })
    }
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace> Planner
    for Guard<D, K, M, L, G>
{
    type Belief = Tracker<K, M, L>;

    fn plan(&mut self, pose: Pose) -> Plan {
        let Some(asked) = self.ask() else { return self.hunt.seek(pose) };
        let hunt = &self.hunt;
        let worth = |Pose { site, .. }, share| asked.worth(hunt, (site - pose.site, site), share);
        let (best, examined) = hunt.best_end(pose, ENDS, worth);
        let beyond = asked.best(hunt, pose, best.map_or(0.0, |best| best.worth));
        if let Some(plan) = self.hunt.scout.come_home(pose) {
            return plan;
        }
        let (stage, places) = match () {
            () if best.is_some() || beyond.is_some() => (Stage::Follow, [beyond, None]),
            () => (Stage::Return, [Some(asked.waist.site), Some(asked.middle)]),
        };
        let best = best.map(|best| (best, Stage::Follow));
        let is_silent = self.hunt.scout.silence.is_back();
        let Hunt { scout, tracker } = &mut self.hunt;
        let to = (stage, places);
        let plan =
            scout.go(pose, to, best, (FAINT, examined), Hunt::<D, K, M, L, G>::told(tracker));
        match plan.unwrap_or(Plan::Stop(StopReason::Cornered)) {
            Plan::Move(motion) if is_silent && motion.target.site != pose.site => {
                Plan::Move(Motion { wants_label: true, ..motion })
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
        self.hunt.observe(pose, reading, tolerance)?;
        self.hunt.seek_anew(pose.site);
        self.lie();
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        self.hunt.observe_on_the_way(site, reading)
    }

    fn belief(&self) -> &Tracker<K, M, L> {
        &self.hunt.tracker
    }

    fn alarm(&self) -> Option<Alarm> {
        self.hunt.tracker.evidence().alarm()
    }

    fn front(&self) -> Option<FrontState> {
        Some(FrontState { waist: self.found(), is_closed: false })
    }
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace> Restart
    for Guard<D, K, M, L, G>
{
    /// It stores no samples.
    const ROOM: [usize; 2] = [u16::MAX as usize, 1];

    /// Begins again in the rectangle around its area. A tracker has one prior: see [`Tracker::new`].
    fn restart(&mut self, given: &[Sample], _: Prior, noise: Noise) -> Result<(), SetupError> {
        self.middle = None;
        self.hunt.restart(noise, given)
    }
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace> Persist
    for Guard<D, K, M, L, G>
{
    type Snapshot = Snapshot<FrontMemory<K, M, L>, (Silence, Option<Pose>, QuestMemory)>;

    fn snapshot(&self) -> Self::Snapshot {
        Snapshot::new(
            self.hunt.mark(Kind::Guard),
            self.hunt.tracker.log(),
            (self.hunt.scout.silence, self.middle, self.hunt.scout.quest.memory()),
        )
    }

    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError> {
        let (log, &(silence, middle, ref quest)) = snapshot.open(self.hunt.mark(Kind::Guard))?;
        if !self.hunt.scout.quest.recall(quest) {
            return Err(ReplayError::Spoilt.into());
        }
        self.hunt.tracker.replay(log)?;
        (self.hunt.scout.silence, self.middle) = (silence, middle);
        Ok(())
    }
}

/// A stretch as it is known before a motion.
struct Asked {
    waist: Waist,
    middle: Site,
    along: Unit,
    /// The robot goes so far from its middle along it, lattice units.
    most: f32,
    places: [Site; ASKED],
    spread: Spread,
}

impl Asked {
    /// What a place so far away is worth that has this share of the curves above it, if it lies in the stretch: square
    /// metres a motion.
    fn worth<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace>(
        &self,
        hunt: &Hunt<D, K, M, L, G>,
        (way, to): (Vector, Site),
        share: f32,
    ) -> Option<f32> {
        let off = to - self.middle;
        let ahead = self.along.x * off.x as f32 + self.along.z * off.z as f32;
        if ahead.abs() > self.most {
            return None;
        }
        hunt.tells(share)?;
        let motions = distance(way) / hunt.scout.reach();
        let reduces = hunt.tracker.reduces(&self.spread, to, share);
        Some(if motions > 1.0 { reduces / motions } else { reduces })
    }

    /// The place of the stretch, beyond the ends of a motion, that is worth the most, if that is more than this.
    fn best<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace>(
        &self,
        hunt: &Hunt<D, K, M, L, G>,
        pose: Pose,
        least: f32,
    ) -> Option<Site> {
        let (mut best, mut most) = (None, least);
        for to in self.places {
            let way = to - pose.site;
            if distance(way) > hunt.scout.reach() && hunt.scout.area.contains(to) {
                let share = hunt.tracker.share_above(to);
                let worth = self.worth(hunt, (way, to), share).unwrap_or(0.0);
                if worth > most {
                    (best, most) = (Some(to), worth);
                }
            }
        }
        best
    }
}
