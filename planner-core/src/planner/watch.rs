//! Staying with a stretch of a front, to know at all times where the front is along it.
//!
//! The stretch is fixed once the front is found: its middle is the place where the front is known best then. A place is
//! worth by how much its label is expected to reduce the variance of the front, a motion on the way there. The variance is
//! the mean over five places of the stretch. The planner looks at ends of the next motion, and at these places on the
//! mean front. The robot leaves the stretch by no more than a reach, unless it has to seek the front.
//!
//! The robot never waits: the stretch is always known least where the robot has not been for long. If no end of the
//! next motion tells enough, it goes to the best of these places.

use crate::belief::front::{ASKED, Spread, Unit, Waist};
use crate::geometry::approximate::distance;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::scout::Scout;

/// Circles on which a motion may end, and ends that are looked at, at most.
pub(crate) const LOOKS: (u16, u32) = (3, 36);

/// Which stretch is watched.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watch {
    /// Its length, metres.
    metres: f32,
    /// Its middle and direction, once the front is found.
    pub(crate) middle: Option<Pose>,
}

impl Watch {
    pub(crate) const fn of(metres: f32) -> Self {
        Self { metres, middle: None }
    }

    /// Takes in where the front is known best. If that is further away than the stretch is long, the front has left,
    /// and the stretch lies there now.
    fn observe<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace>(
        &mut self,
        scout: &Scout<D, K, M, L, G>,
    ) {
        let Some(Waist { site, heading, .. }) = scout.found() else { return };
        let most = self.metres * UNITS_PER_METRE as f32;
        if self.middle.is_none_or(|it| distance(site - it.site) > most) {
            self.middle = Some(Pose { site, heading });
        }
    }

    /// What a plan needs of it.
    fn ask<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace>(
        &self,
        scout: &Scout<D, K, M, L, G>,
        waist: &Waist,
    ) -> Option<Asked> {
        let middle = self.middle?;
        let along = Unit::of(middle.heading);
        let half = 0.5 * self.metres * UNITS_PER_METRE as f32;
        let mut share = -1.0;
        let places = [(); ASKED].map(|()| {
            let by = Vector::new((along.x * half * share) as i32, (along.z * half * share) as i32);
            share += 2.0 / (ASKED as f32 - 1.0);
            let site = by.and_then(|by| middle.site.step(by).ok()).unwrap_or(middle.site);
            waist.place_at(waist.ahead(site)).unwrap_or(site)
        });
        let most = half + scout.reach();
        Some(Asked {
            middle: middle.site,
            along,
            most,
            places,
            spread: scout.tracker.spread_over(places),
        })
    }
}

/// How a planner watches a stretch. A program that watches none does not contain these functions: only
/// [`Track::watching`](crate::planner::track::Track::watching) names them.
#[derive(Debug)]
pub(crate) struct Ways<S> {
    pub(crate) observe: fn(&mut Watch, &S),
    pub(crate) ask: fn(&Watch, &S, &Waist) -> Option<Asked>,
    pub(crate) worth: fn(&Asked, &S, (Vector, Site), f32) -> Option<f32>,
    pub(crate) best: fn(&Asked, &S, Pose, f32) -> Option<Site>,
}

impl<S> Clone for Ways<S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S> Copy for Ways<S> {}

impl<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace>
    Ways<Scout<D, K, M, L, G>>
{
    pub(crate) const ALL: Self =
        Self { observe: Watch::observe, ask: Watch::ask, worth: Asked::worth, best: Asked::best };
}

/// A stretch as it is known before a motion.
pub(crate) struct Asked {
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
        scout: &Scout<D, K, M, L, G>,
        (way, to): (Vector, Site),
        share: f32,
    ) -> Option<f32> {
        let off = to - self.middle;
        let ahead = self.along.x * off.x as f32 + self.along.z * off.z as f32;
        if ahead.abs() > self.most {
            return None;
        }
        scout.tells(share)?;
        let motions = distance(way) / scout.reach();
        let reduces = scout.tracker.reduces(&self.spread, to, share);
        Some(if motions > 1.0 { reduces / motions } else { reduces })
    }

    /// The place of the stretch, beyond the ends of a motion, that is worth the most, if that is more than this.
    fn best<D: Dynamics, const K: usize, const M: usize, const L: usize, G: Workspace>(
        &self,
        scout: &Scout<D, K, M, L, G>,
        pose: Pose,
        least: f32,
    ) -> Option<Site> {
        let (mut best, mut most) = (None, least);
        for to in self.places {
            let way = to - pose.site;
            if distance(way) > scout.reach() && scout.area.contains(to) {
                let share = scout.tracker.share_above(to);
                let worth = self.worth(scout, (way, to), share).unwrap_or(0.0);
                if worth > most {
                    (best, most) = (Some(to), worth);
                }
            }
        }
        best
    }
}
