//! The way to a pose where a label can be asked, for a vehicle that cannot turn on the spot.
//!
//! A *short* way follows the vehicle's circle to one side for some motions, a whole turn at most, and then goes
//! straight on: `L..L S..S` or `R..R S..S`. A *long* way goes round once more, to either side, after up to eight
//! straight motions: `L..L S..S R..R` and the like. The shortest paths of a car have this form (Dubins, 1957). The
//! search returns the first motion of the shortest way to a pose where the problem is feasible: a short way if there is
//! one, else a long one.
//!
//! Each motion of a way ends [safe](Dynamics::keeps_inside), so the vehicle does not drive itself into a corner. If the
//! vehicle is not safe to begin with, an error has brought it there. Then motions may use the margin that the area
//! keeps for errors, and shorter motions that bulge less. If no way leads to a label, the shortest one leads to a safe
//! pose. Where keep-outs are in the way, the search returns the way that comes nearest to the first waypoint round them
//! (`detour`).
//!
//! The search is anytime: it uses the plan's looks, tries likely ways first, and returns the best way so far when the
//! looks are used up.
//!
//! **It ends**, though it has no state. The rest of a way is also a way, with one motion less. So each motion lowers a
//! count of motions to a pose where a label can be asked: along a short way, or, as long as there is none, along a long
//! way. As long as there is neither, it lowers the count of motions to a safe pose. A safe vehicle never becomes unsafe
//! again.

use crate::belief::cells::Certainty;
use crate::geometry::approximate::{single, sqrt};
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::workspace::Workspace;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Side, TurningCircle, room_for_errors};
use crate::search::circles::Search;
use crate::search::dead_end::DeadEnd;
use crate::search::detour::{self, Way};
use crate::search::direction_rule::DirectionRule;
use crate::search::objective::{Effort, OPENING};
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

/// An action and where it leads.
type Leg = (Action, Pose);

/// The first motion of a way, and the number of its motions.
type Begun = (Leg, u32);

/// Where all ways begin.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Start {
    /// Inside the area, with a circle to one side to stay on for ever.
    Safe,
    /// Inside with no such circle, or where an error has brought it: within the margin.
    Unsafe,
    /// Outside: motions may be so too.
    Outside,
}

/// Where a way has come to.
#[derive(Clone, Copy)]
struct Place {
    pose: Pose,
    /// The first motion of all.
    first: Option<Leg>,
    motions: u32,
    /// How far one can go from here with no uncertain ground in reach, lattice units.
    free: f32,
}

struct Manoeuvre<'d, 'p, 'a, D, R, G> {
    problem: &'p Problem<'a, R, G>,
    dynamics: &'d D,
    /// Where motions stay.
    ground: G,
    effort: Effort,
    /// The shortest way to where the problem is feasible.
    shortest: Option<Begun>,
    /// If the vehicle is not safe at the beginning: the shortest way to a safe pose.
    escape: Option<Begun>,
    /// Where the way round keep-outs begins, how near a way has come to that, and the way.
    waypoint: Option<Site>,
    nearest: f32,
    approach: Option<Begun>,
    start: Start,
    /// Whether uncertain ground was in reach somewhere.
    comes_near: bool,
    is_hemmed_in: bool,
    looks_at_long_ways: bool,
    /// From outside: how far inside motions end at least; negative.
    depth: i32,
}

/// The first motion of the shortest way to where the problem is feasible, or else as near as ways come to a waypoint.
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
    let (dynamics, from, area) = (search.dynamics, search.pose, problem.area);
    let start = match area.contains(from.site) {
        true if dynamics.is_safe(from, &area) => Start::Safe,
        _ if area.whole().contains(from.site) => Start::Unsafe,
        _ => Start::Outside,
    };
    let mut it = Manoeuvre {
        problem,
        dynamics,
        ground: if start == Start::Safe { area } else { area.whole() },
        effort: search.effort,
        shortest: None,
        escape: None,
        waypoint,
        nearest: waypoint.map_or(0.0, |waypoint| LEAST * distance(waypoint - from.site)),
        approach: None,
        start,
        comes_near: search.view.own_label == Certainty::Uncertain,
        is_hemmed_in: search.is_hemmed_in,
        looks_at_long_ways: false,
        depth: area.whole().depth(from.site),
    };
    let free = search.view.out_of_reach_for();
    let place = Place { pose: from, first: None, motions: 0, free };
    // From outside, if that is to no avail, by ways that lead further out.
    let depths = [it.depth, i32::MIN];
    for depth in depths.into_iter().take(if start == Start::Outside { 2 } else { 1 }) {
        for is_long in [false, true] {
            let is_found = it.shortest.is_some() || depth == i32::MIN && it.escape.is_some();
            if !is_found {
                (it.looks_at_long_ways, it.depth) = (is_long, depth);
                it.try_ways(place);
            }
        }
    }
    search.effort = it.effort;
    match it.shortest.or(it.escape).or(it.approach) {
        Some((first, _)) => Ok(first),
        None if !it.effort.is_enough() => Err(DeadEnd::Undecided),
        None if it.start == Start::Outside => Err(DeadEnd::Outside),
        None if it.start == Start::Safe && it.comes_near && !it.is_hemmed_in => {
            Err(DeadEnd::Resolution)
        }
        None => Err(DeadEnd::Cornered),
    }
}

/// Where the way round keep-outs to uncertain ground begins, if there are any.
pub(crate) fn waypoint<D: Dynamics, G: Workspace>(search: &mut Search<'_, D, G>) -> Option<Site> {
    let (view, from) = (&search.view, search.pose.site);
    view.area().keep_outs().next()?;
    let way = view.way_out()?;
    let (Way::Straight(way) | Way::Round(way)) =
        detour::begin(&search.view, from, way, &mut search.effort)?;
    from.step(way).ok()
}

fn distance(way: Vector) -> f32 {
    sqrt(single(way.dot(way)))
}

impl<D: Dynamics, R: DirectionRule, G: Workspace> Manoeuvre<'_, '_, '_, D, R, G> {
    /// Tries all ways of a kind: straight on, then from places on a round to either side.
    fn try_ways(&mut self, from: Place) {
        self.drive_on(from);
        for side in [Side::Left, Side::Right] {
            self.go_round(from, side, Self::drive_on);
        }
    }

    /// Whether a way of so many motions is worth knowing.
    fn is_short(&self, motions: u32) -> bool {
        motions < self.shortest.map_or(MOST, |(_, least)| least) && self.effort.is_enough()
    }

    /// Follows the circle to a side and looks at each place on it. At some of the places it calls `branch`.
    fn go_round(&mut self, from: Place, side: Side, mut branch: impl FnMut(&mut Self, Place)) {
        let (mut place, mut turned) = (from, 0_u32);
        while self.is_short(place.motions + 1) {
            let Some((action, after)) = self.sharpest(place.pose, side) else { return };
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

    /// The motion along the vehicle's circle to a side. If that would leave the area, and the vehicle is not safe
    /// either way, a shorter motion is used, as it bulges less. It is the longest of the sharpest ones that stays
    /// inside.
    fn sharpest(&mut self, pose: Pose, side: Side) -> Option<Leg> {
        let (dynamics, area, grid) = (self.dynamics, self.problem.area, self.dynamics.grid());
        let action = dynamics.turning_circle(pose, side)?.action;
        let after = dynamics.target(pose, action)?;
        if self.stays(pose, after)
            && (self.start == Start::Outside || self.may_hold(pose, after, side))
        {
            return Some((action, after));
        }
        if dynamics.is_safe(pose, &area) {
            return None;
        }
        let (_, speed) = grid.split(action);
        (1..speed).rev().find_map(|speed| {
            let [left, right] = dynamics.rays_at(speed)?;
            let n = if side == Side::Left { left.saturating_sub(1) } else { right };
            let ray = (n > 0).then(|| dynamics.ray(pose, side, n))?;
            let after = dynamics.arrive(pose, &ray, speed).ok()?;
            self.stays(pose, after).then(|| (grid.action(ray.index, speed), after))
        })
    }

    /// Whether a motion stays where motions may go, or from outside ends no further out than it may; and touches no
    /// keep-out.
    fn stays(&mut self, pose: Pose, after: Pose) -> bool {
        let ground = &self.ground;
        self.effort.take(1);
        self.effort.take_sweep(ground, &[pose.site, after.site]);
        let ends = ground.encloses(after.site)
            || self.start == Start::Outside && ground.depth(after.site) >= self.depth;
        ends && ground.confines(pose.site, after.site)
            && self.dynamics.stays_inside(pose, after, ground)
    }

    /// Whether a safe vehicle stays safe after one more motion round to a side. It does on the circle that it follows,
    /// wherever rounding has moved that, or with a margin.
    fn may_hold(&self, pose: Pose, after: Pose, side: Side) -> bool {
        let (dynamics, area) = (self.dynamics, &self.problem.area);
        let fits = |circle: TurningCircle| circle.is_inside(after.site, area, circle.radius);
        !dynamics.is_safe(pose, area)
            || dynamics.keeps_inside(pose, after, area, self.room(pose))
            || dynamics.turning_circle(after, side).is_some_and(fits)
    }

    /// The room that a motion must leave around its circle, lattice units. It is 0 if the circle at the beginning has
    /// no such room either.
    fn room(&self, from: Pose) -> i32 {
        let (area, room) = (&self.problem.area, room_for_errors(&self.problem.area));
        let has_room = room > 0 && self.dynamics.keeps_inside(from, from, area, room);
        if has_room { room } else { 0 }
    }

    /// Drives straight on.
    fn drive_on(&mut self, from: Place) {
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

    /// The drive straight ahead: several of the fastest motions at once, if no uncertain ground is in reach meanwhile
    /// and the vehicle is safe all along; else one that ends safe, or from where it is not safe, inside.
    fn straight(&mut self, from: Place) -> Option<(Leg, u32)> {
        let (dynamics, grid, pose) = (self.dynamics, self.dynamics.grid(), from.pose);
        let fastest = grid.speeds().saturating_sub(1);
        let ray = dynamics.ray(pose, Side::Left, 0);
        if from.first.is_some() && !self.looks_at_long_ways {
            let mut count = (from.free / (f32::from(fastest) * grid.step_units())) as u32;
            while count > 1 {
                if let Some(after) = self.advance(pose, ray.displacement(fastest), count) {
                    return Some(((grid.action(ray.index, fastest), after), count));
                }
                count /= 2;
            }
        }
        let is_safe = dynamics.is_safe(pose, &self.problem.area);
        let room = self.room(pose);
        let mut otherwise = None;
        for speed in (1..=fastest).rev() {
            let exists = dynamics.rays_at(speed).is_none_or(|[left, _]| left > 0);
            let Some(after) = exists.then(|| dynamics.arrive(pose, &ray, speed).ok()).flatten()
            else {
                continue;
            };
            if !self.stays(pose, after) {
                if self.effort.is_enough() {
                    continue;
                }
                break;
            }
            let leg = (grid.action(ray.index, speed), after);
            let area = &self.problem.area;
            if area.contains(after.site) && dynamics.keeps_inside(pose, after, area, room) {
                return Some((leg, 1));
            }
            otherwise = otherwise.or(Some((leg, 1)));
        }
        if is_safe { None } else { otherwise }
    }

    /// Where so many motions straight ahead lead, if its circle to one side stays inside all along.
    fn advance(&mut self, pose: Pose, by: Vector, count: u32) -> Option<Pose> {
        let (area, room) = (&self.problem.area, self.room(pose));
        let times = |v: i32| v.checked_mul(count as i32);
        let by = Vector::new(times(by.x)?, times(by.z)?)?;
        let after = Pose { site: pose.site.step(by).ok()?, ..pose };
        self.effort.take(2);
        self.effort.take_sweep(area, &[pose.site, after.site]);
        let is_clear = |circle: TurningCircle| {
            let radius = circle.with_room(room);
            let centres = [pose, after].map(|it| it.site.step(circle.centre));
            let [Ok(from), Ok(to)] = centres else { return false };
            area.contains_disc(from, radius)
                && area.contains_disc(to, radius)
                && area.keep_outs().all(|it| it.is_clear_of(&[from, to], radius.unsigned_abs()))
        };
        let mut circles = [Side::Left, Side::Right].into_iter();
        let stays = area.contains(after.site)
            && area.lets_pass(&[pose.site, after.site])
            && circles.any(|side| self.dynamics.turning_circle(pose, side).is_some_and(is_clear));
        stays.then_some(after)
    }

    /// Whether the problem is feasible at the end of a way. Then the way is the shortest, and there is no reason to go
    /// on. Otherwise updates how far the vehicle can go from there with no uncertain ground in reach.
    fn look(&mut self, place: &mut Place) -> bool {
        self.note(place);
        self.effort.take(OPENING);
        let mut there = self.problem.search(self.dynamics, place.pose, self.effort);
        let there = there.open();
        place.free = there.view.out_of_reach_for();
        if place.free > 0.0 {
            self.effort = there.effort;
            return true;
        }
        self.comes_near = true;
        let kept = there.effort.keep_back(LOOKS_A_SEARCH);
        let best = there.best_between([place.pose.heading; 2], &self.problem.rule);
        self.effort = there.effort;
        self.effort.give_back(kept);
        self.is_hemmed_in |= there.is_hemmed_in;
        if best.is_some()
            && let Some(first) = place.first
        {
            self.shortest = Some((first, place.motions));
            return false;
        }
        true
    }

    /// Records a way that ends safe, or nearer to the waypoint.
    fn note(&mut self, place: &Place) {
        let Some(first) = place.first else { return };
        let (pose, begun) = (place.pose, (first, place.motions));
        let distance = self.waypoint.map_or(f32::INFINITY, |it| distance(it - pose.site));
        if distance < self.nearest {
            (self.nearest, self.approach) = (distance, Some(begun));
        }
        if self.start != Start::Safe
            && self.escape.is_none_or(|(_, least)| place.motions < least)
            && self.problem.area.contains(pose.site)
            && self.dynamics.keeps_inside(pose, pose, &self.problem.area, 0)
        {
            self.escape = Some(begun);
        }
    }
}
