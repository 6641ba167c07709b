//! A boundary that is sought from nothing and closed in on by a grid of lines: what [`Seek`](crate::planner::seek) and
//! [`Track`](crate::planner::track) share.
//!
//! As long as nothing is known, it [searches](Scout). Close to the boundary, a place is worth the information of its label
//! over a price and the way there. The places are ends of the next motion, and some along the mean line.

use crate::belief::field::Seeking;
use crate::belief::front::{Front, Unit, Waist};
use crate::belief::lines::Lines;
use crate::belief::noise::Noise;
use crate::belief::observation_log::FromLog as _;
use crate::belief::predictions::entropy;
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::{Belief as _, ObservationError};
use crate::geometry::approximate::distance;
use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::mark::Mark;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::quest::QuestPhase;
use crate::planner::scout::{BestEnd, Ends, FAINT, LOOKED_AT, NEAR, Scout};
use crate::planner::setup::{SetupError, aimed_for_by};
use crate::planner::snapshot::Kind;
use crate::planner::{Plan, Stage, StopReason};

/// Circles on which a motion may end where the boundary is sought.
const SEEKING: u16 = 2;

/// Places along the mean line, a reach apart.
const ALONG: usize = 17;

/// A boundary that is sought from nothing is found where there is none with less than this probability.
const ABSENT: f32 = 0.01;

/// It is given up where there is none with more than this probability.
const GIVEN_UP: f32 = 0.5;

/// There is none where one was known until now with this probability.
const NOWHERE: f32 = 0.1;

/// A label that tells less than this share of what one can tell is not worth its way.
const LEAST: f32 = 0.1;

/// The search, and the grid that takes over.
#[derive(Clone, Debug)]
pub(crate) struct Hunt<D, const K: usize, const M: usize, G> {
    pub(crate) scout: Scout<D, G>,
    pub(crate) lines: Lines<K, M>,
}

impl<D: Dynamics, const K: usize, const M: usize, G: Workspace> Hunt<D, K, M, G> {
    #[inline] // it is made where it stays, as it may be large
    pub(crate) fn new(area: G, dynamics: D, lines: Lines<K, M>) -> Result<Self, SetupError> {
        let area = aimed_for_by(area, &dynamics, &lines)?;
        let mut hunt = Self::of((area, dynamics), lines);
        hunt.begin(Seeking::USUAL)?;
        Ok(hunt)
    }

    /// The same in the part of an area that motions [aim for](crate::planner::setup::aimed_for), for one that is
    /// [restarted](Self::restart) before it plans.
    #[inline]
    pub(crate) fn of(of: (G, D), lines: Lines<K, M>) -> Self {
        Self { scout: Scout::of(of), lines }
    }

    /// Begins the search with what was said of a straight boundary.
    pub(crate) fn begin(&mut self, seeking: Seeking) -> Result<(), SetupError> {
        let (p, is_near) = (self.lines.reliability(), self.lines.is_near());
        self.scout.begin(seeking, Front::STRAIGHT, (p, is_near))
    }

    /// Takes in points whose labels are known for sure, before the first plan.
    pub(crate) fn know(&mut self, points: &[Sample]) {
        self.lines.give(points);
        self.scout.quest.know(points);
        if self.lines.is_near() {
            self.scout.quest.phase = QuestPhase::Follow;
        }
    }

    /// What tells the mission from others.
    pub(crate) fn mark(&self, planner: Kind) -> Mark {
        self.scout.mark(planner, self.lines.mark())
    }

    /// Begins again in the rectangle around its area.
    pub(crate) fn restart(&mut self, noise: Noise, given: &[Sample]) -> Result<(), SetupError> {
        self.scout.restart(&noise)?;
        let area = self.scout.area.whole().bounds();
        self.lines.restart(area, noise.into(), given);
        self.begin(self.scout.quest.seeking())?;
        self.scout.quest.know(given);
        Ok(())
    }

    /// Where the boundary is known best; `None` as long as it is not found, and where it is lost.
    pub(crate) fn found(&self) -> Option<Waist> {
        let is_sure = match self.scout.quest.phase {
            QuestPhase::Search => false,
            QuestPhase::Close(_) => self.lines.share_nowhere() < ABSENT,
            QuestPhase::Follow => true,
        };
        self.lines.found(self.scout.width()).filter(|_| is_sure)
    }

    /// What a label at a site is expected to tell, as a share of the most.
    pub(crate) fn told(lines: &Lines<K, M>) -> impl Fn(Site) -> f32 {
        |site| lines.tells(lines.share_above(site))
    }

    /// What a label tells at a place that has this share of the curves above it, if it is enough.
    pub(crate) fn tells(&self, share: f32) -> Option<f32> {
        let told = self.lines.tells(share);
        (told > LEAST).then_some(told)
    }

    /// What a place so far away is worth that has this share of the curves above it.
    fn worth(&self, way: Vector, share: f32) -> Option<f32> {
        let told = self.tells(share)?;
        Some(told / (self.scout.price + distance(way)))
    }

    /// The two places along the mean line, beyond the ends of one motion, that are worth the most, if that is more than
    /// the best of these, the best first. And its worth.
    #[inline(never)] // what it needs is not on the stack while a motion is sought
    fn far_places(&self, pose: Pose, waist: Waist, least: f32) -> ([Option<Site>; 2], f32) {
        let unit = Unit::of(waist.heading);
        let along = |k: usize| {
            let ahead = (k as f32 - 0.5 * (ALONG - 1) as f32) * self.scout.reach();
            let by = Vector::new((unit.x * ahead) as i32, (unit.z * ahead) as i32)?;
            let site = waist.site.step(by).ok()?;
            // Where the boundary is known well, a way to a place nearby may end beside it.
            let is_far = distance(site - pose.site) > 2.0 * NEAR * self.scout.reach();
            (is_far && self.scout.area.contains(site)).then_some(site)
        };
        let [mut first, mut second] = [(None, least); 2];
        for site in (0..ALONG).filter_map(along) {
            let share = self.lines.share_above(site);
            let Some(worth) = self.worth(site - pose.site, share) else { continue };
            if worth > first.1 {
                (first, second) = ((Some(site), worth), first);
            } else if worth > second.1 {
                second = (Some(site), worth);
            }
        }
        ([first.0, second.0], first.1)
    }

    /// [`Scout::best_end`] by the shares of the curves at the ends themselves.
    pub(crate) fn best_end(
        &self,
        pose: Pose,
        ends: Ends,
        worth: impl Fn(Pose, f32) -> Option<f32>,
    ) -> (Option<BestEnd>, u32) {
        self.scout.best_end(pose, ends, |end| self.lines.share_above(end.site), worth)
    }

    /// The next motion of a planner that seeks the boundary.
    pub(crate) fn seek(&mut self, pose: Pose) -> Plan {
        if let Some(plan) = self.scout.come_home(pose) {
            return plan;
        }
        if self.scout.quest.phase != QuestPhase::Search {
            if let Some(plan) = self.close(pose) {
                return plan;
            }
            self.scout.quest.search_on();
        }
        let plan = self.scout.search(pose);
        plan.or_else(|| self.close(pose)).unwrap_or(Plan::Stop(StopReason::Cornered))
    }

    /// The next motion where the boundary is close. `None` if no label tells much.
    fn close(&mut self, pose: Pose) -> Option<Plan> {
        let worth = |end: Pose, share: f32| self.worth(end.site - pose.site, share);
        let ends = Ends { circles: SEEKING, beside: 0, most: LOOKED_AT - ALONG as u32 };
        let (best, examined) = self.best_end(pose, ends, worth);
        let waist = self.lines.waist();
        let (far, worth) = self.far_places(pose, waist, best.map_or(0.0, |best| best.worth));
        // It has gone round about a place without a label.
        let is_vain = best.is_some() && self.scout.silence.is_long();
        let to = (Stage::Seek, if is_vain { [None; 2] } else { far });
        // On the way to a place a label is read where it is worth as much for its price.
        let least = worth * self.scout.price;
        let least = if least > FAINT { least } else { FAINT };
        let best = best.map(|best| (best, Stage::Seek));
        self.scout.go(pose, to, best, (least, examined), Self::told(&self.lines))
    }

    /// Takes in the end of a motion.
    pub(crate) fn observe(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        if reading.is_some() && tolerance > self.lines.tolerance() {
            return Err(ObservationError::Tolerance(tolerance));
        }
        if let Some(reading) = reading {
            self.scout.hear(pose.site, reading);
        }
        if let Some(reading) = reading
            && self.scout.quest.phase != QuestPhase::Search
        {
            self.lines.observe_within(pose.site, reading, tolerance)?;
        }
        self.scout.silence.observe(reading.is_some());
        self.scout.quest.moved(pose.site, reading.is_some());
        match self.scout.quest.phase {
            QuestPhase::Search => self.take_lead(pose.site),
            QuestPhase::Close(left) => {
                self.scout.quest.phase = match left.checked_sub(1) {
                    _ if self.found().is_some() => QuestPhase::Follow,
                    Some(left) => QuestPhase::Close(left),
                    None => QuestPhase::Search,
                };
                if self.scout.quest.phase == QuestPhase::Search
                    || self.lines.share_nowhere() > GIVEN_UP
                {
                    self.scout.quest.search_on();
                }
            }
            QuestPhase::Follow => {}
        }
        Ok(())
    }

    /// Closes in on the boundary, if the search has come near to it.
    fn take_lead(&mut self, from: Site) {
        let Some(lead) = self.scout.take_lead(self.lines.is_certain(), from) else { return };
        let Some(square) = square(lead.place, lead.within) else { return };
        self.lines.close_in(square, self.scout.quest.labels_near(&lead), lead.nowhere);
        self.scout.quest.close_in(1.0 - entropy(self.lines.counted()));
    }

    /// Closes in on a boundary that was known near a site until now.
    pub(crate) fn close_near(&mut self, site: Site) {
        let Some(square) = square(site, self.scout.near()) else { return };
        self.lines.close_in(square, core::iter::empty(), NOWHERE);
        self.scout.quest.close_in(1.0 - entropy(self.lines.counted()));
    }

    pub(crate) fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        if reading == Reading::Boundary {
            return Ok(false);
        }
        let is_kept = self.scout.quest.phase == QuestPhase::Search
            || self.lines.observe_on_the_way(site, reading)?;
        if is_kept {
            self.scout.hear(site, reading);
            self.scout.silence.hear();
        }
        Ok(is_kept)
    }
}

/// The square about a site that reaches so many metres to either side.
fn square(site: Site, metres: f32) -> Option<Area> {
    let half = (metres * UNITS_PER_METRE as f32) as i32;
    let corner = |half: i32| site.step(Vector::new(half, half)?).ok();
    Area::new(corner(-half)?, corner(half)?).ok()
}
