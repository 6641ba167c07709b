//! How a boundary is sought from nothing, for every planner: the robot drives along a route over the area (`quest.rs`).
//!
//! Once the boundary is close, each planner goes on by itself: `track.rs` by a curve, `hunt.rs` by a grid.

use crate::belief::field::Seeking;
use crate::belief::front::Front;
use crate::belief::noise::Noise;
use crate::belief::sample::Reading;
use crate::geometry::approximate::{METRE, distance};
use crate::geometry::heading::Heading;
use crate::geometry::lattice::Site;
use crate::geometry::mark::Mark;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::one_label::OneLabel;
use crate::planner::quest::{Lead, Quest};
use crate::planner::setup::{SetupError, aimed_for};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Kind, mark};
use crate::planner::{Motion, Plan, Stage, StopReason};
use crate::search::course::Course;
use crate::search::errand::{Errand, errand, errand_in_steps};
use crate::search::motions::Leg;
use crate::search::objective::{Effort, LOOKS};
use crate::search::places::EndSearch;
use crate::search::recovery::Found;

/// Places that a plan looks at, at most: ends of motions, and places beyond them.
pub const LOOKED_AT: u32 = 112;

/// The square in which it is close reaches so many spans to either side at least.
const SQUARE: f32 = 1.5;

/// The usual price of a label, as a share of the reach: it keeps places that are near from being all that is considered.
pub(crate) const PRICE: f32 = 0.5;

/// The reach is at most this share of the mean of the area's sides.
const SHORT: f32 = 0.125;

/// A boundary is found where its half-width is below so many [spans](Scout::span).
pub(crate) const FOUND: f32 = 1.5;

/// A label that tells less than this is not read on the way to a place.
pub(crate) const FAINT: f32 = 0.05;

/// After an alarm the boundary is sought within so many reaches.
const AGAIN: f32 = 6.0;

/// An errand ends within this share of the reach.
pub(crate) const NEAR: f32 = 0.25;

/// A plan looks for a route so many times, less one: once more if there is no way to any corner.
const ROUTES: u32 = 3;

/// Two given places that differ are close to the boundary where they are so many ways between labels apart.
const BRACKET: f32 = 5.0;

/// A corner of the route is passed within these shares of the reach and of the radius of the turning circle.
const PASSES: [f32; 2] = [0.25, 0.5];

/// Vehicle and area of a planner that seeks a boundary, and its search.
#[derive(Clone, Debug)]
pub(crate) struct Scout<D, G> {
    pub(crate) area: G,
    pub(crate) dynamics: D,
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
pub(crate) struct BestEnd {
    pub(crate) leg: Leg,
    pub(crate) worth: f32,
}

impl<D: Dynamics, G: Workspace> Scout<D, G> {
    /// In the part of an area that motions [aim for](crate::planner::setup::aimed_for). Motions are short beside the area.
    #[inline] // it is made where it stays, as it may be large
    pub(crate) fn of((area, dynamics): (G, D)) -> Self {
        let grid = dynamics.grid();
        let most = (SHORT * area.bounds().mean_side() / grid.step_units()) as u16;
        let fastest = grid.speeds().saturating_sub(1).min(most).max(1);
        let price = PRICE * f32::from(fastest) * grid.step_units();
        Self { area, dynamics, fastest, price, silence: Silence::NONE, quest: Quest::NONE }
    }

    /// Begins the search with what was said of the boundary and of its labels. It may be close already.
    ///
    /// # Errors
    /// [`SetupError::Patch`].
    pub(crate) fn begin(
        &mut self,
        seeking: Seeking,
        front: Front,
        (p, is_near): (f32, bool),
    ) -> Result<(), SetupError> {
        let patches = front.radius().is_some();
        self.quest.begin(&self.area, (seeking, patches), p, is_near)
    }

    /// What tells the mission from others, with what tells its belief.
    pub(crate) fn mark(&self, planner: Kind, belief: Mark) -> Mark {
        let (patch_mm, likely, more) = self.quest.seeking().into();
        let mark = mark(planner, (&self.dynamics, &self.area), belief);
        mark.and([patch_mm, likely as u32, more.into()])
    }

    /// Aims anew for the part of its area that positions with such a tolerance leave.
    ///
    /// # Errors
    /// [`SetupError::Tolerance`], [`SetupError::Room`].
    pub(crate) fn restart(&mut self, noise: &Noise) -> Result<(), SetupError> {
        self.area = aimed_for(self.area, &self.dynamics, noise.tolerance)?;
        self.silence = Silence::NONE;
        Ok(())
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

    /// The best end of the next motion, and how many ends were looked at. An end is worth what it and the share of the
    /// curves above its place say.
    pub(crate) fn best_end(
        &self,
        pose: Pose,
        Ends { circles, beside, most }: Ends,
        share: impl Fn(Pose) -> f32,
        worth: impl Fn(Pose, f32) -> Option<f32>,
    ) -> (Option<BestEnd>, u32) {
        let mut best: Option<BestEnd> = None;
        let find = |leg: Leg, share: f32| {
            let worth = worth(leg.1, share);
            let better = worth.filter(|it| best.is_none_or(|best| *it > best.worth));
            if let Some(worth) = better {
                best = Some(BestEnd { leg, worth });
            }
            better.is_some()
        };
        let (dynamics, area) = (&self.dynamics, &self.area);
        let mut places =
            EndSearch { dynamics, area, pose, share, find, best: None, examined: 0, most };
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

    /// The label that all of the area has, if it most likely has one.
    pub(crate) fn one_label(&self) -> Option<OneLabel> {
        self.quest.one_label()
    }

    /// The motion to the first of some places to which there is a way, or to the best end of one. `tells` says what a label
    /// at a site is expected to tell, as a share of the most.
    pub(crate) fn go(
        &mut self,
        pose: Pose,
        (stage, places): (Stage, [Option<Site>; 2]),
        best: Option<(BestEnd, Stage)>,
        (least, examined): (f32, u32),
        tells: impl Fn(Site) -> f32,
    ) -> Option<Plan> {
        let mut effort = Effort { looks: LOOKS, examined };
        let near = NEAR * self.reach();
        let with = (&self.dynamics, &self.area);
        let mut places = places.into_iter().flatten();
        let on_the_way = places.find_map(|site| errand(with, pose, (site, near), &mut effort));
        let (leg, stage, wants_label) = match (on_the_way, best) {
            (Some(Errand { leg, arrives, .. }), _) => {
                let least = if arrives { FAINT } else { least };
                // It has gone round without a label: any one may change where it goes.
                let tells = tells(leg.1.site) > least || self.silence.is_long();
                (leg, stage, leg.1.site != pose.site && tells)
            }
            (None, Some((BestEnd { leg, .. }, stage))) => (leg, stage, true),
            (None, None) => return None,
        };
        let found = Found::of(None, leg);
        let motion = Motion::of(Some(stage), pose, &found, &self.dynamics, effort);
        let motion = Motion { wants_label, ..motion };
        Some(self.silence.keep(pose, motion, Course::NONE, &self.dynamics))
    }

    /// The motion back into the area, if the robot is outside.
    pub(crate) fn come_home(&mut self, pose: Pose) -> Option<Plan> {
        if self.area.contains(pose.site) {
            return None;
        }
        let to = (Stage::Return, [self.home(pose), None]);
        let home = self.go(pose, to, None, (FAINT, 0), |_| 0.0);
        Some(home.unwrap_or(Plan::Stop(StopReason::OutsideArea)))
    }

    /// The next motion of the search; `None` if there is no way to any corner of its route.
    pub(crate) fn search(&mut self, pose: Pose) -> Option<Plan> {
        if self.one_label().is_some() {
            return Some(Plan::Stop(StopReason::OneLabel));
        }
        let plan = if self.quest.is_stuck() { None } else { self.explore(pose) };
        if plan.is_none() {
            self.quest.get_stuck();
        }
        plan
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
                self.quest.improve(&self.area, pose.site, apart * METRE);
                continue;
            };
            let is_there = distance(corner - pose.site) <= passes || self.quest.is_vain();
            if !is_there && self.quest.is_fresh() {
                self.quest.improve(&self.area, pose.site, apart * METRE);
                continue;
            }
            let mut on_the_way =
                || errand_in_steps(with, pose, (corner, NEAR * reach, self.fastest), &mut effort);
            match if is_there { None } else { on_the_way() } {
                Some(errand) => break errand,
                None if is_there => self.quest.arrive(&self.area, pose.site),
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

    /// Whether the boundary is close between two places.
    pub(crate) fn is_bracket(&self, [a, b]: [Site; 2]) -> bool {
        distance(b - a) <= BRACKET * self.apart()
    }

    /// Where the boundary is close, if the search has come near to it. A robot at a place drives from one of two labels
    /// that differ to the other first, where they are far apart.
    pub(crate) fn take_lead(&mut self, is_certain: bool, from: Site) -> Option<Lead> {
        let (apart, span) = (self.apart() * METRE, self.span() * METRE);
        let lead = self.quest.lead(is_certain, apart)?;
        if lead.is_wide {
            self.quest.narrow(&lead, from);
            return None;
        }
        let within = if lead.within > SQUARE * span { lead.within } else { SQUARE * span };
        Some(Lead { within, ..lead })
    }

    /// Takes in a label on the way or at the end of a motion.
    pub(crate) fn hear(&mut self, site: Site, reading: Reading) {
        if let Reading::Side(label) = reading {
            self.quest.hear(site, label);
        }
    }
}
