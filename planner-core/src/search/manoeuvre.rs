//! The way to where a label can be asked, for a vehicle that cannot turn on the spot.
//!
//! It holds its circle to one side for some motions (shorter ones where it is not safe and its own would leave the
//! area), until it has gone round at most, and drives straight on from there for some more: `L..L S..S` or `R..R S..S`.
//! After each of these motions it sees whether the problem is feasible there, and the first motion of the fewest is the
//! one to make. Where there is none it looks at *long* ways, which after up to eight straight motions go round to either
//! side once more, as the shortest paths of a car do (Dubins, 1957): `L..L S..S R..R` and the like. So that it is never cornered for want of caution, each motion ends
//! [safe](Dynamics::keeps_inside); only where it is not safe to begin with, or outside, it may take some that do not,
//! and if nothing is feasible on any such way, it goes where it is safe. Where keep-outs are in the way it goes as near
//! as such ways come to the first waypoint round them (`detour`).
//!
//! **It ends**, though it has no state. What is left of a way is a way too, of one motion less: so each motion lowers
//! the number of motions to where a label can be asked, by a short way, or as long as there is none, by a long one, or
//! as long as there is none either, of those to where it is safe; and what is safe never becomes unsafe again.

use crate::belief::consistent_lines::Certainty;
use crate::geometry::approximate::{single, sqrt};
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::region::Region;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Orbit, Pose, Side};
use crate::search::circles::Search;
use crate::search::dead_end::{DeadEnd, dead_end_at};
use crate::search::detour::{self, Way};
use crate::search::direction_rule::DirectionRule;
use crate::search::objective::Effort;
use crate::search::problem::Problem;

/// A way has so many motions at most.
const MOST: u32 = 1_024;

/// Rays that all this looks at, at most.
const LOOKS: u32 = 65_536;

/// A way round keep-outs comes nearer to its waypoint at least by the rest of this share.
const LEAST: f32 = 0.95;

/// Straight motions of a long way at most.
const STRAIGHT: u32 = 8;

/// An action and where it leads.
type Leg = (Action, Pose);

/// The first motion of a way, and the number of its motions.
type Course = (Leg, u32);

/// Where all ways begin.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Start {
    /// Inside the area, with a circle to one side to stay on for ever.
    Safe,
    /// Inside, with none.
    Unsafe,
    /// Outside: motions may be so too.
    Outside,
}

/// A way round to one side.
struct Round {
    /// Where it began.
    from: Pose,
    side: Side,
    /// Where it has come to, by so many motions in all.
    pose: Pose,
    motions: u32,
    /// The turn since it began.
    turned: u32,
    /// The first motion of all.
    first: Option<Leg>,
}

struct Manoeuvre<'d, 'p, 'a, D, R, G> {
    problem: &'p Problem<'a, R, G>,
    dynamics: &'d D,
    effort: Effort,
    /// The shortest way to where the problem is feasible.
    shortest: Option<Course>,
    /// From where it is not safe: the shortest way to where it is.
    escape: Option<Course>,
    /// Where the way round keep-outs begins, how near a way has come to that, and the way.
    waypoint: Option<Site>,
    nearest: f32,
    approach: Option<Course>,
    start: Start,
    /// Whether uncertain ground was in reach somewhere.
    comes_near: bool,
    is_hemmed_in: bool,
    looks_at_long_ways: bool,
    /// How far inside motions end at least; negative, outside.
    depth: i32,
}

/// The first motion of the shortest way to where the problem is feasible, or else as near as ways come to a waypoint.
///
/// Cost: for each motion of a round, and each straight one beyond near uncertain ground, one search; where that finds
/// nothing, one for each motion of the long ways, up to 65,536 looks in all.
///
/// # Errors
/// Why there is none.
pub(crate) fn manoeuvre<D: Dynamics, R: DirectionRule, G: Region>(
    problem: &Problem<'_, R, G>,
    search: &mut Search<'_, D, G>,
    waypoint: Option<Site>,
) -> Result<Leg, DeadEnd> {
    let (dynamics, from) = (search.dynamics, search.pose);
    let mut it = Manoeuvre {
        problem,
        dynamics,
        effort: Effort { looks: LOOKS, ..search.effort },
        shortest: None,
        escape: None,
        waypoint,
        nearest: f32::INFINITY,
        approach: None,
        start: match problem.area.contains(from.site) {
            true if dynamics.is_safe(from, &problem.area) => Start::Safe,
            true => Start::Unsafe,
            false => Start::Outside,
        },
        comes_near: search.view.own_label == Certainty::Uncertain,
        is_hemmed_in: search.is_hemmed_in,
        looks_at_long_ways: false,
        depth: 0,
    };
    let depth = if it.start == Start::Outside { problem.area.depth(from.site) } else { 0 };
    it.nearest = it.waypoint.map_or(0.0, |waypoint| LEAST * distance(waypoint - from.site));
    for (long, depth) in [(false, depth), (true, depth), (false, i32::MIN), (true, i32::MIN)] {
        (it.looks_at_long_ways, it.depth) = (long, depth);
        let is_needed = it.shortest.or(it.escape).is_none() && it.start == Start::Outside;
        if it.shortest.is_none() && (is_needed || depth != i32::MIN) {
            it.drive_on(from, None, 0, search.view.out_of_reach_for());
            for side in [Side::Left, Side::Right] {
                let mut round =
                    Round { from, side, pose: from, turned: 0, first: None, motions: 0 };
                while let Some((first, free)) = it.hold(&mut round) {
                    it.drive_on(round.pose, Some(first), round.motions, free);
                }
            }
        }
    }
    search.effort = it.effort;
    match it.shortest.or(it.escape).or(it.approach) {
        Some((first, _)) => Ok(first),
        None if !it.effort.is_enough() => Err(DeadEnd::Undecided),
        None if it.start == Start::Outside => Err(DeadEnd::Outside),
        None if it.start == Start::Safe && it.comes_near && !it.is_hemmed_in => {
            Err(dead_end_at(&problem.area))
        }
        None => Err(DeadEnd::Cornered),
    }
}

/// Where the way round keep-outs to uncertain ground begins, if there are any.
pub(crate) fn waypoint<D: Dynamics, G: Region>(search: &Search<'_, D, G>) -> Option<Site> {
    let (view, from) = (&search.view, search.pose.site);
    view.area().keep_outs().next()?;
    let (Way::Straight(way) | Way::Round(way)) = detour::begin(view, from, view.way_out()?)?;
    from.step(way).ok()
}

fn distance(way: Vector) -> f32 {
    sqrt(single(way.dot(way)))
}

impl<D: Dynamics, R: DirectionRule, G: Region> Manoeuvre<'_, '_, '_, D, R, G> {
    /// Whether a way of so many motions is worth knowing.
    fn is_short(&self, motions: u32) -> bool {
        motions < self.shortest.map_or(MOST, |(_, least)| least) && self.effort.is_enough()
    }

    /// Holds the circle for one motion more, and looks there: the first motion of all, and how far from there no
    /// uncertain ground is in reach. `None` when the round is over.
    fn hold(&mut self, round: &mut Round) -> Option<(Leg, f32)> {
        let Round { from, side, pose, .. } = *round;
        round.motions += 1;
        let (action, after) = self.sharpest(pose, side)?;
        let turned = match side {
            Side::Left => after.heading.0.wrapping_sub(from.heading.0),
            Side::Right => from.heading.0.wrapping_sub(after.heading.0),
        };
        // Beyond a whole turn there is nothing new.
        if turned <= round.turned || !self.is_short(round.motions) {
            return None;
        }
        let first = *round.first.get_or_insert((action, after));
        (round.pose, round.turned) = (after, turned);
        let free = self.look(after, (first, round.motions))?;
        Some((first, free))
    }

    /// The motion that holds its circle to a side. Where that would leave the area, and it is not safe either way, the
    /// longest of the sharpest shorter ones that stays: they bulge less.
    fn sharpest(&self, pose: Pose, side: Side) -> Option<Leg> {
        let (dynamics, area, grid) = (self.dynamics, &self.problem.area, self.dynamics.grid());
        let stays = |after: Pose| self.stays(pose, after);
        let action = dynamics.orbit(pose, side)?.action;
        let after = dynamics.target(pose, action)?;
        if stays(after) && (self.start == Start::Outside || self.may_hold(pose, after, side)) {
            return Some((action, after));
        }
        if dynamics.is_safe(pose, area) {
            return None;
        }
        let (_, speed) = grid.split(action);
        (1..speed).rev().find_map(|speed| {
            let [left, right] = dynamics.rays_at(speed)?;
            let n = if side == Side::Left { left.saturating_sub(1) } else { right };
            let ray = (n > 0).then(|| dynamics.ray(pose, side, n))?;
            let after = dynamics.arrive(pose, &ray, speed).ok().filter(|after| stays(*after))?;
            Some((grid.action(ray.index, speed), after))
        })
    }

    /// Whether a motion stays inside, or from outside ends no further out than it may; and touches no keep-out.
    fn stays(&self, pose: Pose, after: Pose) -> bool {
        let area = &self.problem.area;
        (area.encloses(after.site) || area.depth(after.site) >= self.depth && self.depth < 0)
            && self.dynamics.stays_inside(pose, after, area)
    }

    /// Whether one more motion round to a side leaves it safe, if it is: on the circle that it goes round, whatever
    /// rounding has moved that by, or with a margin.
    fn may_hold(&self, pose: Pose, after: Pose, side: Side) -> bool {
        let (dynamics, area) = (self.dynamics, &self.problem.area);
        let fits = |orbit: Orbit| orbit.is_inside(after.site, area, orbit.radius);
        !dynamics.is_safe(pose, area)
            || dynamics.keeps_inside(pose, after, area)
            || dynamics.orbit(after, side).is_some_and(fits)
    }

    /// Drives straight on, after so many motions that began with `first`. No uncertain ground is in reach for a
    /// distance.
    fn drive_on(&mut self, from: Pose, first: Option<Leg>, before: u32, mut free: f32) {
        let (mut pose, mut first, mut motions) = (from, first, before);
        while let Some(leg) = self.straight(pose) {
            motions += 1;
            if !self.is_short(motions) {
                return;
            }
            let first = *first.get_or_insert(leg);
            let by = leg.1.site - pose.site;
            free -= sqrt(single(by.dot(by)));
            pose = leg.1;
            if free > 0.0 {
                self.note(pose, (first, motions));
            } else {
                let Some(next) = self.look(pose, (first, motions)) else { return };
                free = next;
            }
            if self.looks_at_long_ways {
                for side in [Side::Left, Side::Right] {
                    let first = Some(first);
                    let mut round = Round { from: pose, side, pose, turned: 0, first, motions };
                    while self.hold(&mut round).is_some() {}
                }
                if motions - before == STRAIGHT {
                    return;
                }
            }
        }
    }

    /// The fastest drive straight ahead that ends safe, or from where it is not safe, inside.
    fn straight(&self, pose: Pose) -> Option<Leg> {
        let (dynamics, area) = (self.dynamics, &self.problem.area);
        let is_safe = dynamics.is_safe(pose, area);
        let drives = || self.drives_ahead(pose);
        drives()
            .find(|(_, it)| area.contains(it.site) && dynamics.keeps_inside(pose, *it, area))
            .or_else(|| if is_safe { None } else { drives().next() })
    }

    /// The drives straight ahead that stay inside, the fastest first.
    fn drives_ahead(&self, pose: Pose) -> impl Iterator<Item = Leg> {
        let (dynamics, grid) = (self.dynamics, self.dynamics.grid());
        let ray = dynamics.ray(pose, Side::Left, 0);
        (1..grid.speeds()).rev().filter_map(move |speed| {
            let exists = dynamics.rays_at(speed).is_none_or(|[left, _]| left > 0);
            let target = exists.then(|| dynamics.arrive(pose, &ray, speed).ok()).flatten()?;
            self.stays(pose, target).then(|| (grid.action(ray.index, speed), target))
        })
    }

    /// Sees whether the problem is feasible at the end of a way: then it is the shortest, and there is nothing to
    /// go on for. Else how far from there no uncertain ground is in reach.
    fn look(&mut self, pose: Pose, way: Course) -> Option<f32> {
        self.note(pose, way);
        self.effort.looks = self.effort.looks.saturating_sub(1);
        let mut there = self.problem.search(self.dynamics, pose, self.effort);
        let there = there.open();
        let free = there.view.out_of_reach_for();
        if free > 0.0 {
            return Some(free);
        }
        self.comes_near = true;
        let best = there.best_between([pose.heading; 2], &self.problem.rule);
        self.effort = there.effort;
        self.is_hemmed_in |= there.is_hemmed_in;
        if best.is_some() {
            self.shortest = Some(way);
            return None;
        }
        Some(free)
    }

    fn note(&mut self, pose: Pose, way: Course) {
        let (_, motions) = way;
        let distance = self.waypoint.map_or(f32::INFINITY, |it| distance(it - pose.site));
        if distance < self.nearest {
            (self.nearest, self.approach) = (distance, Some(way));
        }
        if self.start != Start::Safe
            && self.escape.is_none_or(|(_, least)| motions < least)
            && self.problem.area.contains(pose.site)
            && self.dynamics.keeps_inside(pose, pose, &self.problem.area)
        {
            self.escape = Some(way);
        }
    }
}
