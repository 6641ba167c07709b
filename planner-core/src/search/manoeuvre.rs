//! The way to a pose where a label can be asked, for a vehicle that cannot turn on the spot.
//!
//! A *short* way follows the vehicle's circle to one side for some motions, a whole turn at most, and then goes
//! straight on: `L..L S..S` or `R..R S..S`. A *long* way goes round once more, to either side, after up to eight
//! straight motions: `L..L S..S R..R` and the like. The shortest paths of a car have this form (Dubins, 1957). The
//! search returns the first motion of the shortest way to a pose where the problem is feasible: a short way if there is
//! one, else a long one.
//!
//! Each motion of a way ends safe (`motions`). If the vehicle is not safe to begin with, and no way leads to a label,
//! the shortest one leads to a safe pose. Where keep-outs are in the way, the search returns the way that comes nearest
//! to the first waypoint round them (`detour`).
//!
//! The search is anytime: it uses the plan's looks, tries likely ways first, and returns the best way so far when the
//! looks are used up.
//!
//! **It ends**, though it has no state. The rest of a way is also a way, with one motion less. So each motion lowers a
//! count of motions to a pose where a label can be asked: along a short way, or, as long as there is none, along a long
//! way. As long as there is neither, it lowers the count of motions to a safe pose. A safe vehicle never becomes unsafe
//! again.

use crate::belief::cells::Certainty;
use crate::geometry::approximate::distance;
use crate::geometry::lattice::Site;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose, Side};
use crate::search::circles::Search;
use crate::search::dead_end::DeadEnd;
use crate::search::detour::{self, Way};
use crate::search::direction_rule::DirectionRule;
use crate::search::motions::{Leg, Motions, StartGround};
use crate::search::objective::OPENING;
use crate::search::problem::Problem;

/// A way has so many motions at most.
const MOST: u32 = 8_192;

/// A round branches off in 32 places at most: where the first bits of its heading change.
const BRANCH_BITS: u32 = 32 - 5;

/// A search of one pose takes so many looks at most.
const LOOKS_A_SEARCH: u32 = 1_024;

/// A straight drive searches so many poses with uncertain ground in reach at most.
const SEARCHES: u32 = 6;

/// A way round keep-outs counts only if its distance to the waypoint is less than this share of the first distance.
const LEAST: f32 = 0.95;

/// Straight motions of a long way at most.
const STRAIGHT: u32 = 8;

/// The first motion of a way, and the number of its motions.
type Begun = (Leg, u32);

/// Where a way has come to.
#[derive(Clone, Copy)]
struct ManoeuvreNode {
    pose: Pose,
    /// The first motion of all.
    first: Option<Leg>,
    motions: u32,
    /// How far one can go from here with no uncertain ground in reach, lattice units.
    free: f32,
}

struct Manoeuvre<'d, 'p, 'a, D, R, G> {
    problem: &'p Problem<'a, R, G>,
    motions: Motions<'d, 'p, D, G>,
    /// The shortest way to where the problem is feasible.
    shortest: Option<Begun>,
    /// If the vehicle is not safe at the beginning: the shortest way to a safe pose.
    escape: Option<Begun>,
    /// Where the way round keep-outs begins, how near a way has come to that, and the way.
    waypoint: Option<Site>,
    nearest: f32,
    approach: Option<Begun>,
    /// Whether uncertain ground was in reach somewhere.
    comes_near: bool,
    is_hemmed_in: bool,
    looks_at_long_ways: bool,
}

/// The first motion of the shortest way to where the problem is feasible, or else to a safe pose, or else as near as
/// ways come to a waypoint.
///
/// Cost: the looks that the search has left, at most.
///
/// # Errors
/// Why there is none.
pub(crate) fn manoeuvre<D: Dynamics, R: DirectionRule, G: Workspace>(
    problem: &Problem<'_, R, G>,
    search: &mut Search<'_, D, G>,
    waypoint: Option<Site>,
) -> Result<Leg, DeadEnd> {
    let from = search.pose;
    let mut it = Manoeuvre {
        problem,
        motions: Motions::new(search.dynamics, &problem.area, from, search.effort),
        shortest: None,
        escape: None,
        waypoint,
        nearest: waypoint.map_or(0.0, |waypoint| LEAST * distance(waypoint - from.site)),
        approach: None,
        comes_near: search.view.own_label() == Certainty::Uncertain,
        is_hemmed_in: search.is_hemmed_in,
        looks_at_long_ways: false,
    };
    let free = search.view.out_of_reach_for();
    it.try_all(ManoeuvreNode { pose: from, first: None, motions: 0, free });
    search.effort = it.motions.effort;
    let begun = it.shortest.or(it.escape).or(it.approach);
    begun.map(|(first, _)| first).ok_or_else(|| it.dead_end())
}

/// Where the way round keep-outs to uncertain ground begins, if there are any.
pub(crate) fn waypoint<D: Dynamics, G: Workspace>(search: &mut Search<'_, D, G>) -> Option<Site> {
    let (view, from) = (&search.view, search.pose.site);
    if view.area().is_open() {
        return None;
    }
    let way = view.way_out()?;
    let (Way::Straight(way) | Way::Round(way)) =
        detour::begin(&search.view, from, way, &mut search.effort)?;
    from.step(way).ok()
}

impl<D: Dynamics, R: DirectionRule, G: Workspace> Manoeuvre<'_, '_, '_, D, R, G> {
    /// Tries short ways, then long ones, until one leads to a label. From outside it tries then those that lead further
    /// out, until one leads to a safe pose at least.
    fn try_all(&mut self, from: ManoeuvreNode) {
        let kinds = if self.motions.start == StartGround::Outside { 4 } else { 2 };
        for kind in 0..kinds {
            let leads_out = kind >= 2;
            if self.shortest.is_some() || leads_out && self.escape.is_some() {
                return;
            }
            if leads_out {
                self.motions.depth = i32::MIN;
            }
            self.looks_at_long_ways = kind % 2 == 1;
            self.try_ways(from);
        }
    }

    /// Tries all ways of a kind: straight on, then from places on a round to either side.
    fn try_ways(&mut self, from: ManoeuvreNode) {
        self.drive_on(from);
        for side in [Side::Left, Side::Right] {
            self.go_round(from, side, Self::drive_on);
        }
    }

    /// Why there is no way.
    fn dead_end(&self) -> DeadEnd {
        match self.motions.start {
            _ if !self.motions.effort.is_enough() => DeadEnd::Undecided,
            StartGround::Outside => DeadEnd::Outside,
            StartGround::Safe if self.comes_near && !self.is_hemmed_in => DeadEnd::Resolution,
            _ => DeadEnd::Cornered,
        }
    }

    /// Whether a way of so many motions is worth knowing.
    fn is_short(&self, motions: u32) -> bool {
        motions < self.shortest.map_or(MOST, |(_, least)| least) && self.motions.effort.is_enough()
    }

    /// Follows the circle to a side and looks at each place on it. At some of the places it calls `branch`.
    fn go_round(
        &mut self,
        from: ManoeuvreNode,
        side: Side,
        mut branch: impl FnMut(&mut Self, ManoeuvreNode),
    ) {
        let (mut place, mut turned) = (from, 0_u32);
        while self.is_short(place.motions + 1) {
            let Some((action, after)) = self.motions.round(place.pose, side) else { return };
            let left = after.heading.since(from.pose.heading).0;
            let turn = if side == Side::Left { left } else { left.wrapping_neg() };
            if turn <= turned {
                return; // beyond a whole turn there is nothing new
            }
            turned = turn;
            let before = place.pose.heading.0;
            place.pose = after;
            place.motions += 1;
            place.first = place.first.or(Some((action, after)));
            if !self.look(&mut place) {
                return;
            }
            // By the heading alone, so that what is left of a way branches off in the same places.
            if before >> BRANCH_BITS != after.heading.0 >> BRANCH_BITS {
                branch(self, place);
            }
        }
    }

    /// Drives straight on.
    fn drive_on(&mut self, from: ManoeuvreNode) {
        let (mut place, mut searches) = (from, 0);
        while searches < SEARCHES && self.is_short(place.motions + 1) {
            let Some((leg, motions)) = self.straight(place) else { return };
            let (_, after) = leg;
            place.first = place.first.or(Some(leg));
            place.free -= distance(after.site - place.pose.site);
            place.pose = after;
            place.motions += motions;
            if !self.is_short(place.motions) {
                return;
            }
            if place.free > 0.0 {
                self.note(&place);
            } else if !self.look(&mut place) {
                return;
            }
            searches += u32::from(place.free <= 0.0);
            if self.looks_at_long_ways {
                for side in [Side::Left, Side::Right] {
                    self.go_round(place, side, |_, _| {});
                }
                if place.motions - from.motions >= STRAIGHT {
                    return;
                }
            }
        }
    }

    /// The drive straight ahead, and the number of its motions: several at once while no uncertain ground is in reach.
    fn straight(&mut self, from: ManoeuvreNode) -> Option<(Leg, u32)> {
        let is_far = from.first.is_some() && !self.looks_at_long_ways;
        let several = if is_far { self.motions.straight_on(from.pose, from.free) } else { None };
        several.or_else(|| self.motions.straight(from.pose).map(|leg| (leg, 1)))
    }

    /// Whether the problem is infeasible at the end of a way. If it is feasible, the way is the shortest, and there is
    /// no reason to go on. Otherwise updates how far the vehicle can go from there with no uncertain ground in reach.
    fn look(&mut self, place: &mut ManoeuvreNode) -> bool {
        self.note(place);
        let Self { problem, motions, .. } = self;
        motions.effort.take(OPENING);
        let mut there = problem.search(motions.dynamics, place.pose, motions.effort);
        let there = there.open();
        place.free = there.view.out_of_reach_for();
        if place.free > 0.0 {
            return true;
        }
        self.comes_near = true;
        let kept = there.effort.keep_back(LOOKS_A_SEARCH);
        let best = there.best_between([place.pose.heading; 2], &problem.rule);
        motions.effort = there.effort;
        motions.effort.give_back(kept);
        self.is_hemmed_in |= there.is_hemmed_in;
        let begun = place.first.filter(|_| best.is_some());
        self.shortest = begun.map(|first| (first, place.motions)).or(self.shortest);
        begun.is_none()
    }

    /// Records a way that ends safe, or nearer to the waypoint.
    fn note(&mut self, place: &ManoeuvreNode) {
        let Some(first) = place.first else { return };
        let Motions { dynamics, area, start, .. } = self.motions;
        let (pose, begun) = (place.pose, (first, place.motions));
        let distance = self.waypoint.map_or(f32::INFINITY, |it| distance(it - pose.site));
        if distance < self.nearest {
            (self.nearest, self.approach) = (distance, Some(begun));
        }
        if start != StartGround::Safe
            && self.escape.is_none_or(|(_, least)| place.motions < least)
            && area.contains(pose.site)
            && dynamics.keeps_inside(pose, pose, area, 0)
        {
            self.escape = Some(begun);
        }
    }
}
