//! How a boundary is sought: the part that [`Seek`](crate::planner::seek) and [`Track`](crate::planner::track) share.
//!
//! As long as nothing is known, the robot drives along a route over the area (`quest.rs`). Close to the boundary, a
//! place is worth the information of its label over a price and the way there. The places are ends of the next motion,
//! and some along the mean line.

use crate::belief::Belief as _;
use crate::belief::ObservationError;
use crate::belief::field::Seeking;
use crate::belief::front::{Tracker, Unit, Waist};
use crate::belief::noise::Noise;
use crate::belief::observation_log::FromLog as _;
use crate::belief::predictions::entropy;
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::geometry::approximate::{METRE, distance};
use crate::geometry::area::Area;
use crate::geometry::heading::Heading;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::mark::Mark;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::one_label::OneLabel;
use crate::planner::quest::{Lead, Phase, Quest};
use crate::planner::setup::{SetupError, aimed_for, aimed_for_by};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Kind, mark};
use crate::planner::{Motion, Plan, Stage, StopReason};
use crate::search::course::Course;
use crate::search::errand::{Errand, errand};
use crate::search::motions::Leg;
use crate::search::objective::{Effort, LOOKS};
use crate::search::places::Places;
use crate::search::recovery::Found;

/// Places that a plan looks at, at most: ends of motions, and places beyond them.
pub const LOOKED_AT: u32 = 112;

/// Circles on which a motion may end where the boundary is sought.
const SEEKING: u16 = 2;

/// Places along the mean line, a reach apart.
const ALONG: usize = 17;

/// A boundary that is sought from nothing is found where there is none with less than this probability.
const ABSENT: f32 = 0.01;

/// It is given up where there is none with more than this probability.
const GIVEN_UP: f32 = 0.5;

/// The square in which it is close reaches so many spans to either side at least.
const SQUARE: f32 = 1.5;

/// The usual price of a label, as a share of the reach: it keeps places that are near from being all that is considered.
const PRICE: f32 = 0.5;

/// The reach is at most this share of the tightest bend's radius, and of the mean of the area's sides.
const SHORT: f32 = 0.125;

/// A boundary is found where its half-width is below so many [spans](Scout::span).
pub(crate) const FOUND: f32 = 1.5;

/// A label that tells less than this share of what one can tell is not worth its way.
const LEAST: f32 = 0.1;

/// One that tells less than this is not read on the way to a place.
pub(crate) const FAINT: f32 = 0.05;

/// After an alarm the boundary is sought within so many reaches.
const AGAIN: f32 = 6.0;

/// An errand ends within this share of the reach.
const NEAR: f32 = 0.25;

/// A plan looks for a route so many times, less one: once more if there is no way to any corner.
const ROUTES: u32 = 3;

/// A corner of the route is passed within these shares of the reach and of the radius of the turning circle.
const PASSES: [f32; 2] = [0.25, 0.5];

/// Vehicle, area and belief of a planner that seeks a boundary.
#[derive(Clone, Debug)]
pub(crate) struct Scout<D, const K: usize, const M: usize, const L: usize, G> {
    pub(crate) area: G,
    pub(crate) dynamics: D,
    pub(crate) tracker: Tracker<K, M, L>,
    /// The fastest speed that is considered.
    pub(crate) fastest: u16,
    /// What a label costs, lattice units of driving.
    pub(crate) price: f32,
    pub(crate) silence: Silence,
    pub(crate) quest: Quest,
}

/// Which ends of the next motion to look at.
#[derive(Clone, Copy)]
pub(crate) struct Ends {
    /// On so many circles.
    pub(crate) circles: u16,
    /// And so many times on either side of the best one.
    pub(crate) beside: u32,
    /// At most so many.
    pub(crate) most: u32,
}

/// The best end of a motion so far, and its worth.
#[derive(Clone, Copy)]
pub(crate) struct Best {
    pub(crate) leg: Leg,
    pub(crate) worth: f32,
}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace>
    Scout<D, K, M, L, G>
{
    #[inline] // it is made where it stays, as it may be large
    pub(crate) fn new(area: G, dynamics: D, tracker: Tracker<K, M, L>) -> Result<Self, SetupError> {
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
        let price = PRICE * f32::from(fastest) * grid.step_units();
        let (silence, quest) = (Silence::NONE, Quest::NONE);
        let mut scout = Self { area, dynamics, tracker, fastest, price, silence, quest };
        // The usual radius suits every area.
        let _ = scout.begin(Seeking::USUAL);
        scout
    }

    /// Begins the search with what was said of the boundary.
    pub(crate) fn begin(&mut self, seeking: Seeking) -> Result<(), SetupError> {
        let patches = self.tracker.front().bend() > 0.0;
        let (p, is_near) = (self.tracker.reliability(), self.tracker.is_near());
        self.quest.begin(&self.area, (seeking, patches), p, is_near)
    }

    /// Takes in points whose labels are known for sure, before the first plan.
    pub(crate) fn know(&mut self, points: &[Sample]) {
        self.tracker.give(points);
        self.quest.know(points);
        if self.tracker.is_near() {
            self.quest.phase = Phase::Follow;
        }
    }

    /// What tells the mission from others.
    pub(crate) fn mark(&self, planner: Kind) -> Mark {
        let (patch_mm, likely) = self.quest.seeking().into();
        mark(planner, (&self.dynamics, &self.area), self.tracker.mark())
            .and([patch_mm, likely as u32])
    }

    /// Begins again in the rectangle around its area.
    pub(crate) fn restart(&mut self, noise: Noise, given: &[Sample]) -> Result<(), SetupError> {
        self.area = aimed_for(self.area, &self.dynamics, noise.tolerance)?;
        self.tracker.restart(self.area.whole().bounds(), noise.into(), given);
        self.silence = Silence::NONE;
        self.begin(self.quest.seeking())?;
        self.quest.know(given);
        Ok(())
    }

    /// Where the boundary is known best; `None` as long as it is not found, and where it is lost.
    pub(crate) fn found(&self) -> Option<Waist> {
        let is_sure = match self.quest.phase {
            Phase::Search => false,
            Phase::Close(_) => self.tracker.share_nowhere() < ABSENT,
            Phase::Follow => true,
        };
        self.tracker.found(self.width()).filter(|_| is_sure)
    }

    /// The half-width below which the boundary counts as found, metres.
    pub(crate) fn width(&self) -> f32 {
        FOUND * METRE * self.span()
    }

    /// After an alarm the boundary is sought within so many metres.
    pub(crate) fn near(&self) -> f32 {
        AGAIN * METRE * self.reach()
    }

    /// The radius of the smallest circle that the vehicle goes round; 0 if it needs none. Lattice units.
    pub(crate) fn radius(&self) -> f32 {
        let pose = Pose { site: self.area.bounds().middle(), heading: Heading(0) };
        let circles = self.dynamics.turning_circles(pose);
        circles.map_or(0.0, |[left, _]| left.radius as f32)
    }

    /// The reach, or this radius if it is longer: a vehicle cannot follow a front that it knows much less well. Lattice
    /// units.
    pub(crate) fn span(&self) -> f32 {
        let (reach, radius) = (self.reach(), self.radius());
        if radius > reach { radius } else { reach }
    }

    /// A place on the way back into the area.
    pub(crate) fn home(&self, pose: Pose) -> Option<Site> {
        pose.site.step(self.area.way_home(pose.site)).ok()
    }

    /// The longest motion that is considered, lattice units.
    pub(crate) fn reach(&self) -> f32 {
        f32::from(self.fastest) * self.dynamics.grid().step_units()
    }

    /// How far apart labels come along a route, lattice units.
    fn apart(&self) -> f32 {
        let (price, reach) = (self.price, self.reach());
        if price > reach { price } else { reach }
    }

    /// What a label tells at a place that has this share of the curves above it, if it is enough.
    pub(crate) fn tells(&self, share: f32) -> Option<f32> {
        let told = self.tracker.tells(share);
        (told > LEAST).then_some(told)
    }

    /// What a place so far away is worth that has this share of the curves above it.
    fn worth(&self, way: Vector, share: f32) -> Option<f32> {
        let told = self.tells(share)?;
        Some(told / (self.price + distance(way)))
    }

    /// The best end of the next motion, and how many ends were looked at. An end is judged by a place: it is worth what the
    /// end and the share of the curves above that place say.
    pub(crate) fn best_end(
        &self,
        pose: Pose,
        Ends { circles, beside, most }: Ends,
        place: impl Fn(Pose) -> Site,
        worth: impl Fn(Pose, f32) -> Option<f32>,
    ) -> (Option<Best>, u32) {
        let mut best: Option<Best> = None;
        let find = |leg: Leg, share: f32| {
            let worth = worth(leg.1, share);
            let better = worth.filter(|it| best.is_none_or(|best| *it > best.worth));
            if let Some(worth) = better {
                best = Some(Best { leg, worth });
            }
            better.is_some()
        };
        let (dynamics, area) = (&self.dynamics, &self.area);
        let share = |end: Pose| self.tracker.share_above(place(end));
        let mut places =
            Places { dynamics, area, pose, share, find, best: None, examined: 0, most };
        for k in (1..=circles).rev() {
            let speed = u32::from(self.fastest) * u32::from(k) / u32::from(circles);
            if speed > 0 {
                let _ = places.circle(speed as u16); // the outer ones count most
            }
        }
        let _ = places.beside_best(beside);
        let examined = places.examined;
        (best, examined)
    }

    /// The two places along the mean line, beyond the ends of one motion, that are worth the most, if that is more than
    /// the best of these, the best first. And its worth.
    #[inline(never)] // what it needs is not on the stack while a motion is sought
    fn far_places(&self, pose: Pose, waist: Waist, least: f32) -> ([Option<Site>; 2], f32) {
        let unit = Unit::of(waist.heading);
        let along = |k: usize| {
            let ahead = (k as f32 - 0.5 * (ALONG - 1) as f32) * self.reach();
            let by = Vector::new((unit.x * ahead) as i32, (unit.z * ahead) as i32)?;
            let site = waist.site.step(by).ok()?;
            // Where the boundary is known well, a way to a place nearby may end beside it.
            let is_far = distance(site - pose.site) > 2.0 * NEAR * self.reach();
            (is_far && self.area.contains(site)).then_some(site)
        };
        let sites: heapless::Vec<Site, ALONG> = (0..ALONG).filter_map(along).collect();
        let mut shares = [0.0; ALONG];
        self.tracker.shares_above(&sites, &mut shares);
        let [mut first, mut second] = [(None, least); 2];
        for (&site, share) in sites.iter().zip(shares) {
            let Some(worth) = self.worth(site - pose.site, share) else { continue };
            if worth > first.1 {
                (first, second) = ((Some(site), worth), first);
            } else if worth > second.1 {
                second = (Some(site), worth);
            }
        }
        ([first.0, second.0], first.1)
    }

    /// The label that all of the area has, if it most likely has one.
    pub(crate) fn one_label(&self) -> Option<OneLabel> {
        self.quest.one_label()
    }

    /// The motion to the first of some places to which there is a way, or to the best end of one.
    pub(crate) fn go(
        &mut self,
        pose: Pose,
        (stage, places): (Stage, [Option<Site>; 2]),
        best: Option<(Best, Stage)>,
        (least, examined): (f32, u32),
    ) -> Option<Plan> {
        let mut effort = Effort { looks: LOOKS, examined };
        let near = NEAR * self.reach();
        let with = (&self.dynamics, &self.area);
        let mut places = places.into_iter().flatten();
        let on_the_way = places.find_map(|site| errand(with, pose, (site, near), &mut effort));
        let (leg, stage, wants_label) = match (on_the_way, best) {
            (Some(Errand { leg, arrives, .. }), _) => {
                let least = if arrives { FAINT } else { least };
                let told = self.tracker.tells(self.tracker.share_above(leg.1.site));
                // It has gone round without a label: any one may change where it goes.
                let tells = told > least || self.silence.is_long();
                (leg, stage, leg.1.site != pose.site && tells)
            }
            (None, Some((Best { leg, .. }, stage))) => (leg, stage, true),
            (None, None) => return None,
        };
        let found = Found::of(None, leg);
        let motion = Motion::of(Some(stage), pose, &found, &self.dynamics, effort);
        let motion = Motion { wants_label, ..motion };
        Some(self.silence.keep(pose, motion, Course::NONE, &self.dynamics))
    }

    /// The next motion of a planner that seeks the boundary.
    pub(crate) fn seek(&mut self, pose: Pose) -> Plan {
        if !self.area.contains(pose.site) {
            let home = self.go(pose, (Stage::Return, [self.home(pose), None]), None, (FAINT, 0));
            return home.unwrap_or(Plan::Stop(StopReason::OutsideArea));
        }
        if self.quest.phase != Phase::Search {
            if let Some(plan) = self.close(pose) {
                return plan;
            }
            self.quest.search_on();
        }
        if self.one_label().is_some() {
            return Plan::Stop(StopReason::OneLabel);
        }
        let plan = if self.quest.is_stuck() { None } else { self.explore(pose) };
        if plan.is_none() {
            self.quest.get_stuck();
        }
        plan.or_else(|| self.close(pose)).unwrap_or(Plan::Stop(StopReason::Cornered))
    }

    /// The next motion along the route. `None` if there is no way to any of its corners.
    fn explore(&mut self, pose: Pose) -> Option<Plan> {
        let (reach, radius) = (self.reach(), self.radius());
        let apart = self.apart();
        let passes = [PASSES[0] * reach, PASSES[1] * radius];
        let passes = if passes[0] > passes[1] { passes[0] } else { passes[1] };
        let mut effort = Effort { looks: LOOKS, examined: 0 };
        let with = (&self.dynamics, &self.area);
        let mut routes = ROUTES;
        let Errand { leg, arrives, .. } = loop {
            let Some(corner) = self.quest.next(&self.area) else {
                routes -= 1;
                if routes == 0 {
                    return None;
                }
                self.quest.improve(pose.site, apart * METRE);
                continue;
            };
            let is_there = distance(corner - pose.site) <= passes;
            if !is_there && self.quest.is_fresh() {
                self.quest.improve(pose.site, apart * METRE);
                continue;
            }
            let mut on_the_way = || errand(with, pose, (corner, NEAR * reach), &mut effort);
            match if is_there { None } else { on_the_way() } {
                Some(errand) => break errand,
                None => self.quest.pass(),
            }
        };
        let is_due = arrives || self.quest.unheard(leg.1.site) >= self.price;
        let wants_label = leg.1.site != pose.site && (is_due || self.silence.is_long());
        let found = Found::of(None, leg);
        let motion = Motion::of(Some(Stage::Seek), pose, &found, &self.dynamics, effort);
        let motion = Motion { wants_label, ..motion };
        Some(self.silence.keep(pose, motion, Course::NONE, &self.dynamics))
    }

    /// The next motion where the boundary is close. `None` if no label tells much.
    fn close(&mut self, pose: Pose) -> Option<Plan> {
        let worth = |end: Pose, share: f32| self.worth(end.site - pose.site, share);
        let ends = Ends { circles: SEEKING, beside: 0, most: LOOKED_AT - ALONG as u32 };
        let (best, examined) = self.best_end(pose, ends, |end| end.site, worth);
        let waist = self.tracker.waist();
        let (far, worth) = self.far_places(pose, waist, best.map_or(0.0, |best| best.worth));
        // It has gone round about a place without a label.
        let is_vain = best.is_some() && self.silence.is_long();
        let to = (Stage::Seek, if is_vain { [None; 2] } else { far });
        // On the way to a place a label is read where it is worth as much for its price.
        let least = worth * self.price;
        let least = if least > FAINT { least } else { FAINT };
        self.go(pose, to, best.map(|best| (best, Stage::Seek)), (least, examined))
    }

    /// Takes in the end of a motion.
    pub(crate) fn observe(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        if reading.is_some() && tolerance > self.tracker.tolerance() {
            return Err(ObservationError::Tolerance(tolerance));
        }
        if let Some(Reading::Side(label)) = reading {
            self.quest.hear(pose.site, label);
        }
        if self.quest.phase != Phase::Search {
            self.tracker.moved(pose.site, 1.0);
            match reading {
                Some(reading) => self.tracker.observe_within(pose.site, reading, tolerance)?,
                None => self.tracker.settle(pose.site),
            }
        }
        self.silence.observe(reading.is_some());
        self.quest.moved(reading.is_some());
        match self.quest.phase {
            Phase::Search => self.take_lead(pose.site),
            Phase::Close(left) => {
                self.quest.phase = match left.checked_sub(1) {
                    _ if self.found().is_some() => Phase::Follow,
                    Some(left) => Phase::Close(left),
                    None => Phase::Search,
                };
                if self.quest.phase == Phase::Search || self.tracker.share_nowhere() > GIVEN_UP {
                    self.quest.search_on();
                }
            }
            Phase::Follow => {}
        }
        Ok(())
    }

    /// Closes in on the boundary, if the search has come near to it.
    fn take_lead(&mut self, from: Site) {
        let (apart, span) = (self.apart() * METRE, self.span() * METRE);
        let Some(lead) = self.quest.lead(self.tracker.is_certain(), apart) else { return };
        if lead.is_wide {
            self.quest.narrow(&lead, from);
            return;
        }
        let within = if lead.within > SQUARE * span { lead.within } else { SQUARE * span };
        let lead = Lead { within, ..lead };
        let half = (within * UNITS_PER_METRE as f32) as i32;
        let corner = |sign: i32| {
            let by = Vector::new(sign * half, sign * half)?;
            lead.place.step(by).ok()
        };
        let (Some(min), Some(max)) = (corner(-1), corner(1)) else { return };
        let Ok(square) = Area::new(min, max) else { return };
        self.tracker.close_in(square, self.quest.labels_near(&lead), lead.nowhere);
        self.quest.close_in(1.0 - entropy(self.tracker.counted()));
    }

    /// Begins again where labels speak against what is known of the boundary.
    pub(crate) fn seek_anew(&mut self, site: Site) {
        if self.quest.phase == Phase::Follow {
            let near = (site, self.near());
            let begins = self.tracker.seek_anew(near, self.area.whole().bounds());
            if begins && self.tracker.is_open() {
                self.quest.lose(&self.area);
            }
        }
    }

    pub(crate) fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let Reading::Side(label) = reading else { return Ok(false) };
        let is_kept =
            self.quest.phase == Phase::Search || self.tracker.observe_on_the_way(site, reading)?;
        if is_kept {
            self.quest.hear(site, label);
            self.silence.hear();
        }
        Ok(is_kept)
    }
}
