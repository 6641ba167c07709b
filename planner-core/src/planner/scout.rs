//! How a boundary is sought: the part that [`Seek`](crate::planner::seek) and [`Track`](crate::planner::track) share.
//!
//! A place is worth the information of its label over a price and the way there. The places are ends of the next
//! motion, some along the mean line, some all over the area, and its corners. The corners matter where there is no
//! boundary: a straight line that crosses a rectangle parts its corners.

use crate::belief::Belief as _;
use crate::belief::ObservationError;
use crate::belief::front::{Tracker, Unit, Waist};
use crate::belief::noise::Noise;
use crate::belief::observation_log::FromLog as _;
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::geometry::approximate::{METRE, distance};
use crate::geometry::heading::Heading;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::mark::Mark;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::one_label::{OneLabel, PLACES, anywhere};
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
const ALONG: u16 = 17;

/// Corners of the area, at most; and all these places together, with those all over it.
const CORNERS: u32 = 12;
const FAR: u32 = 17 + PLACES + CORNERS;

/// Places beyond a motion that are asked at once.
const AT_ONCE: usize = 18;

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

/// A corner is looked for in so many halves of the way to it.
const HALVES: u32 = 10;

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
        Self { area, dynamics, tracker, fastest, price, silence: Silence::NONE }
    }

    /// What tells the mission from others.
    pub(crate) fn mark(&self, planner: Kind) -> Mark {
        mark(planner, (&self.dynamics, &self.area), self.tracker.mark())
    }

    /// Begins again in the rectangle around its area.
    pub(crate) fn restart(&mut self, noise: Noise, given: &[Sample]) -> Result<(), SetupError> {
        self.area = aimed_for(self.area, &self.dynamics, noise.tolerance)?;
        self.tracker.restart(self.area.whole().bounds(), noise.into(), given);
        self.silence = Silence::NONE;
        Ok(())
    }

    /// Where the boundary is known best; `None` as long as it is not found, and where it is lost.
    pub(crate) fn found(&self) -> Option<Waist> {
        self.tracker.found(self.width())
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

    /// The two places beyond the ends of one motion that are worth the most, if that is more than the best of these, the
    /// best first. And its worth.
    #[inline(never)] // what it needs is not on the stack while a motion is sought
    fn far_places(&self, pose: Pose, waist: Waist, least: f32) -> ([Option<Site>; 2], f32) {
        let unit = Unit::of(waist.heading);
        let along = |k: u16| {
            let ahead = (f32::from(k) - 0.5 * f32::from(ALONG - 1)) * self.reach();
            let by = Vector::new((unit.x * ahead) as i32, (unit.z * ahead) as i32)?;
            let site = waist.site.step(by).ok()?;
            // Where the boundary is known well, a way to a place nearby may end beside it.
            let is_far = distance(site - pose.site) > 2.0 * NEAR * self.reach();
            (is_far && self.area.contains(site)).then_some(site)
        };
        let [mut first, mut second] = [(None, least); 2];
        let of_area = anywhere(&self.area).chain(self.corners());
        let mut sites = (0..ALONG).filter_map(along).chain(of_area);
        loop {
            let some: heapless::Vec<Site, AT_ONCE> = sites.by_ref().take(AT_ONCE).collect();
            if some.is_empty() {
                break;
            }
            let mut shares = [0.0; AT_ONCE];
            self.tracker.shares_above(&some, &mut shares);
            for (&site, share) in some.iter().zip(shares) {
                let Some(worth) = self.worth(site - pose.site, share) else { continue };
                if worth > first.1 {
                    (first, second) = ((Some(site), worth), first);
                } else if worth > second.1 {
                    second = (Some(site), worth);
                }
            }
        }
        ([first.0, second.0], first.1)
    }

    /// The label that all of the area has, if it most likely has one.
    pub(crate) fn one_label(&self) -> Option<OneLabel> {
        OneLabel::of(&self.tracker, &self.area)
    }

    /// The corners of the area, or the places nearest to them, towards the middle, where the vehicle can be.
    fn corners(&self) -> impl Iterator<Item = Site> {
        let area = &self.area;
        let radius = self.radius() as i32;
        let (min, max, middle) = (area.bounds().min(), area.bounds().max(), area.bounds().middle());
        let aside = [(max.x(), min.z()), (min.x(), max.z())];
        let [right, left] = aside.map(|(x, z)| Site::new(x, z).unwrap_or(middle));
        // Each side's end, and its beginning where no other side ends.
        let of_sides = area.sides().scan(None, |before, side| {
            let end = side.from.step(side.along).ok();
            let begin = Some(side.from).filter(|from| before.replace(end) != Some(Some(*from)));
            Some([begin, end])
        });
        let all = [min, right, max, left].into_iter().chain(of_sides.flatten().flatten());
        all.filter_map(move |corner| {
            let way = corner - middle;
            let at = |n: u32| {
                let part = |it: i32| ((i64::from(it) * i64::from(n)) >> HALVES) as i32;
                let by = Vector { x: part(way.x), z: part(way.z) };
                middle.step(by).ok()
            };
            let is_inside =
                |site: &Site| area.encloses(*site) && area.bounds().contains_disc(*site, radius);
            let mut inside = 0;
            for bit in (0..=HALVES).rev() {
                let next = inside + (1 << bit);
                if next <= 1 << HALVES && at(next).is_some_and(|it| is_inside(&it)) {
                    inside = next;
                }
            }
            at(inside).filter(|it| area.contains(*it))
        })
        .take(CORNERS as usize)
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
        let is_inside = self.area.contains(pose.site);
        let worth = |end: Pose, share: f32| self.worth(end.site - pose.site, share);
        let ends = Ends { circles: SEEKING, beside: 0, most: LOOKED_AT - FAR };
        let (best, examined) = self.best_end(pose, ends, |end| end.site, worth);
        let waist = self.tracker.waist();
        let (far, worth) = self.far_places(pose, waist, best.map_or(0.0, |best| best.worth));
        let is_open = best.is_some() || far != [None; 2];
        // It has gone round about a place without a label.
        let is_vain = best.is_some() && self.silence.is_long();
        let to = if is_inside {
            (Stage::Seek, if is_vain { [None; 2] } else { far })
        } else {
            (Stage::Return, [self.home(pose), None])
        };
        // On the way to a place a label is read where it is worth as much for its price.
        let least = worth * self.price;
        let least = if least > FAINT { least } else { FAINT };
        let best = best.map(|best| (best, Stage::Seek));
        self.go(pose, to, best, (least, examined)).unwrap_or(Plan::Stop(match () {
            () if !is_inside => StopReason::OutsideArea,
            () if !is_open && self.one_label().is_some() => StopReason::OneLabel,
            () => StopReason::Cornered,
        }))
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
        self.tracker.moved(pose.site, 1.0);
        if let Some(reading) = reading {
            self.tracker.observe_within(pose.site, reading, tolerance)?;
        } else {
            self.tracker.settle(pose.site);
        }
        self.silence.observe(reading.is_some());
        Ok(())
    }

    /// Begins again where labels speak against what is known of the boundary.
    pub(crate) fn seek_anew(&mut self, site: Site) {
        let near = (site, self.near());
        self.tracker.seek_anew(near, self.area.whole().bounds());
    }

    pub(crate) fn observe_on_the_way(
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
}
