//! The recovery ladder, for when a one-step problem has no feasible action.
//!
//! The paper does not cover this case, and P1 meets it once in some fourteen steps. The rungs are tried in this order:
//!
//! 1. *Undirected*: the same problem without its rule on directions.
//! 2. *Transit, far*: if no uncertain ground of the area is within reach, drive towards the nearest. Each drive brings
//!    it nearer by at least an eighth of the drive's length. If no drive does, make the fewest turns in place after
//!    which one does. No sample is taken.
//! 3. *Reorient*: turn in place, with the fewest sharpest turns after which (1) is feasible beyond them. Of left and
//!    right, choose the side with the better action there. No sample is taken.
//! 4. *Transit, near*: uncertain ground is within reach, and yet no action hits it. Drive to the nearest pose from
//!    which (1) is feasible, counted in motions, 16 at most. The way never leaves the reach of uncertain ground. Eight
//!    bearings are considered: along the bisector of the slope arc both ways, across it both ways, and between.
//! 5. *Courses*, where there is uncertain ground: once a drive to the nearest that is beyond reach, then a way drawn at
//!    random (`wander`). A vehicle that cannot turn on the spot may also make a drive drawn at random, to try again
//!    from elsewhere. The next plans continue the course (`course`).
//! 6. Nothing: the ladder returns the reason, and the planner stops with it.
//!
//! If keep-outs are in the way, (2) goes round them (`detour`).
//!
//! If an error has brought the agent outside the area, (1) and (3) may lead back inside. Otherwise the agent drives
//! towards the middle of the area, or away from the keep-out that is too near. If it cannot, it turns until it can.
//!
//! A vehicle that cannot turn on the spot makes a way of several motions (`manoeuvre`) in place of 2 to 4. It also
//! tries such a way before (1), and before Algorithm 1 gives up P2. That way leads to a pose where the problem is
//! feasible with its rule. Without it, the fan may contain no allowed direction, and straight on the vehicle would
//! learn next to nothing.
//!
//! **Rungs 1 to 4 end**, though they have no state, as long as the looks suffice. The knowledge does not change before
//! the next sample, and each motion lowers a measure:
//!
//! - Far from uncertain ground, the measure is the distance to it, then the turns to the next drive.
//! - Near it, the measure is the turns of (3), or, if there are none, the motions of (4), which stay near. A near agent
//!   never becomes far again.
//! - Outside the area, the measure is the distance to the middle, and then the turns. From inside, no motion leads out.
//!
//! **Courses end**: of rung 5 there is at most one drive to ground beyond reach, and sixteen drives to try again from
//! elsewhere. A way drawn at random has at most six motions, and a label at its end. If errors or a lack of looks break
//! these rules, the planner still counts turns, see [`Silence`](crate::planner::silence::Silence).

use crate::geometry::approximate::{heading_of, single, sqrt};
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::Vector;
use crate::geometry::workspace::Workspace;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Ray, Side};
use crate::search::circles::{Findings, Search};
use crate::search::course::{Course, Excursion};
use crate::search::dead_end::{DeadEnd, way_to_open_ground};
use crate::search::detour::{self, Way};
use crate::search::direction_rule::{ArcRule, DirectionRule};
use crate::search::manoeuvre::{manoeuvre, waypoint};
use crate::search::motions::Leg;
use crate::search::problem::Problem;
use crate::search::wander::{drift, is_open, stays, wander};

/// A transit among uncertain ground looks this many motions ahead. Twice as many find nothing more in
/// 1,000 standard missions of 60 steps.
const HORIZON: u32 = 16;

/// Looks that the rungs take at first.
const FIRST_LOOKS: u32 = 2_048;

/// A heading this far from a bearing drives along it.
const ALONG: u32 = Angle::of_radians(0.125).0;

/// Turns in place that a leg considers one after the other, if rays are so few that each turn brings others. Fewer may be
/// half a turn.
const TURNS: u32 = 8;

/// Motions to try from elsewhere, without a label.
const TRIES: u8 = 16;

/// The kind of motion made when the problem itself had no feasible action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Recovery {
    /// The same problem without its rule on directions.
    Undirected,
    /// A turn in place; no sample is taken.
    Reorient,
    /// A drive through certain ground; no sample is taken.
    Transit,
}

/// An action, where it leads, and the rung on which it was found.
pub(crate) struct Found {
    pub(crate) recovery: Option<Recovery>,
    pub(crate) action: Action,
    pub(crate) target: Pose,
}

impl Found {
    pub(crate) const fn of(recovery: Option<Recovery>, (action, target): Leg) -> Self {
        Self { recovery, action, target }
    }
}

/// The best action of the problem from the search's pose, or the ladder's. `before` is the result of that search by
/// another rule, see [`Search::best`]. `course` is the course begun since the last label, and becomes what is left of it
/// after that action. An error leaves it undefined.
///
/// # Errors
/// Why there is neither.
pub(crate) fn solve_or_recover<D: Dynamics, R: DirectionRule, G: Workspace>(
    problem: &Problem<'_, R, G>,
    search: &mut Search<'_, D, G>,
    before: Option<Findings>,
    course: &mut Course,
) -> Result<Found, DeadEnd> {
    let (area, pose) = (problem.area, search.pose);
    let goes_round = goes_round(search.dynamics, pose);
    let mut ladder = Ladder { problem: problem.undirected(), search, course };
    // Before the search has used up its looks.
    let is_outside = !area.contains(pose.site);
    let home =
        is_outside.then(|| ladder.leg(pose, area.way_home(pose.site)).ok_or(DeadEnd::Outside));
    if let Some(found) = ladder.solve(problem, before).or_else(|| ladder.go_on()) {
        return Ok(found);
    }
    // Few looks find a way nearly always, unless it has to go round.
    let half = ladder.half_the_looks();
    let looks = if goes_round { half } else { half.min(FIRST_LOOKS) };
    let climbed = ladder.climb(home, looks);
    let Err(why) = climbed else { return climbed };
    let open = way_to_open_ground(problem.lines, &area, pose.site);
    let Some(open) = open.filter(|_| why != DeadEnd::Outside) else {
        return Err(why.of_thin_ground(problem.lines));
    };
    // More of them are worth it where there is much ground to find.
    let looks = ladder.half_the_looks();
    let climbed = if goes_round { climbed } else { ladder.climb(home, looks) };
    climbed.or_else(|why| ladder.begin(open).ok_or(why.of_open_ground()))
}

/// The way to a pose where a problem is feasible in a direction that its rule allows. It is for a safe vehicle that has
/// to go round in order to turn. Its fan may contain no allowed direction, and straight on it would learn next to
/// nothing.
pub(crate) fn turn_round<D: Dynamics, R: DirectionRule, G: Workspace>(
    problem: &Problem<'_, R, G>,
    search: &mut Search<'_, D, G>,
) -> Option<Found> {
    let is_free = goes_round(search.dynamics, search.pose)
        && search.dynamics.is_safe(search.pose, &problem.area);
    // It may use half of the looks: something else is known to be feasible, or comes after it.
    let kept = search.effort.keep_back(search.effort.looks / 2);
    let found = is_free.then(|| manoeuvre(problem, search, None).ok()).flatten();
    search.effort.give_back(kept);
    found.map(|leg| Found::of(Some(Recovery::Transit), leg))
}

/// Whether a vehicle has to go round in order to turn.
fn goes_round<D: Dynamics>(dynamics: &D, pose: Pose) -> bool {
    dynamics.turning_circles(pose).is_some()
}

/// The result of following a bearing.
enum BearingResult {
    /// Its first leg, and the number of motions to where the undirected problem is feasible.
    Feasible(Leg, u32),
    /// The problem is feasible nowhere on the way.
    Fruitless,
    /// There is no such drive.
    Blocked,
}

struct Ladder<'s, 'p, 'a, D, G> {
    /// The problem without its rule on directions.
    problem: Problem<'p, ArcRule, G>,
    /// From where the agent is.
    search: &'s mut Search<'a, D, G>,
    /// What was begun since the last label.
    course: &'s mut Course,
}

impl<D: Dynamics, G: Workspace> Ladder<'_, '_, '_, D, G> {
    /// The problem itself, with half of the looks, or the first rung: the rest is for what comes after it.
    fn solve<R: DirectionRule>(
        &mut self,
        problem: &Problem<'_, R, G>,
        before: Option<Findings>,
    ) -> Option<Found> {
        let kept = self.search.effort.keep_back(self.half_the_looks());
        let Findings { best, best_forbidden } = self.search.best(&problem.rule, before);
        self.search.effort.give_back(kept);
        if let Some((best, _)) = best {
            return Some(Found::of(None, (best.action, best.target)));
        }
        let (best, _) = best_forbidden?;
        let turned = turn_round(problem, self.search);
        if turned.is_some() {
            self.course.give_up_way();
            return turned;
        }
        Some(Found::of(Some(Recovery::Undirected), (best.action, best.target)))
    }

    fn half_the_looks(&self) -> u32 {
        self.search.effort.looks / 2
    }

    /// The rungs 2 to 4, or a manoeuvre, with so many looks; `home` is the way back from outside, if that is where the
    /// agent is.
    fn climb(&mut self, home: Option<Result<Leg, DeadEnd>>, looks: u32) -> Result<Found, DeadEnd> {
        let kept = self.search.effort.keep_back(looks);
        let climbed = self.climb_on(home);
        self.search.effort.give_back(kept);
        climbed
    }

    fn climb_on(&mut self, home: Option<Result<Leg, DeadEnd>>) -> Result<Found, DeadEnd> {
        let pose = self.search.pose;
        if goes_round(self.search.dynamics, pose) {
            self.search.view.way_out().ok_or(DeadEnd::Resolution)?;
            let waypoint = waypoint(self.search);
            let leg = manoeuvre(&self.problem, self.search, waypoint);
            return leg.map(|leg| Found::of(Some(Recovery::Transit), leg));
        }
        // Where nothing is in reach no turn finds anything, so that the order does not matter.
        if let Some(turn) = self.reorient() {
            return Ok(Found::of(Some(Recovery::Reorient), turn));
        }
        let Search { view, effort, .. } = &mut *self.search;
        let way = view.way_out().ok_or(DeadEnd::Resolution)?;
        let leg = match (home, detour::begin(view, pose.site, way, effort)) {
            (Some(home), _) => home,
            (None, Some(Way::Round(way))) => self.leg(pose, way).ok_or(DeadEnd::Cornered),
            (None, Some(Way::Straight(way))) if self.search.view.is_far(way) => {
                self.leg(pose, way).ok_or(DeadEnd::Cornered)
            }
            (None, _) => self.transit(),
        };
        leg.map(|leg| Found::of(Some(Recovery::Transit), leg))
    }

    /// The next motion of a course, if it can be made.
    fn go_on(&mut self) -> Option<Found> {
        let pose = self.search.pose;
        if let Excursion::To(place) = self.course.far {
            let drive = self.drive_far(place - pose.site);
            if drive.is_some() {
                return drive;
            }
            self.course.far = Excursion::Over;
        }
        let found = self.next_motion();
        if found.is_none() {
            self.course.give_up_way();
        }
        found
    }

    /// The next motion of the way that is under way.
    fn next_motion(&mut self) -> Option<Found> {
        let pose = self.search.pose;
        let (action, is_last) = self.course.next()?;
        let target = self.search.dynamics.target(pose, action)?;
        let Search { dynamics, effort, .. } = &mut *self.search;
        let stays = target.site == pose.site
            || stays(*dynamics, &self.problem.area, effort, [pose, target]);
        let can_go = stays && (!is_last || is_open(&self.problem, *dynamics, [pose, target]));
        let recovery = if is_last { Recovery::Undirected } else { Recovery::Transit };
        can_go.then(|| Found::of(Some(recovery), (action, target)))
    }

    /// Begins a course: to open ground, which lies so far off, or one that is drawn at random.
    fn begin(&mut self, open: Vector) -> Option<Found> {
        let far = self.begin_far(open);
        far.or_else(|| {
            // The rest is for a drive to try again from elsewhere.
            let kept = self.search.effort.keep_back(self.search.effort.looks / 4 * 3);
            let drawn = self.begin_drawn();
            self.search.effort.give_back(kept);
            drawn.or_else(|| self.go_elsewhere())
        })
    }

    /// The first motion to open ground, which lies so far off, if it is beyond reach and there was no such drive.
    fn begin_far(&mut self, way: Vector) -> Option<Found> {
        if self.course.far != Excursion::Not {
            return None;
        }
        let place = self.search.pose.site.step(way).ok()?;
        let found = self.drive_far(way)?;
        self.course.far = Excursion::To(place);
        Some(found)
    }

    /// One motion on the way to a place beyond reach, unless the vehicle has to go round to turn.
    #[inline(never)] // it is called in two places, where time does not matter
    fn drive_far(&mut self, way: Vector) -> Option<Found> {
        let (dynamics, pose) = (self.search.dynamics, self.search.pose);
        let grid = dynamics.grid();
        let reach = grid.longest_units();
        let is_far = sqrt(single(way.dot(way))) > reach && !goes_round(dynamics, pose);
        let leg = if is_far { self.leg(pose, way)? } else { return None };
        Some(Found::of(Some(Recovery::Transit), leg))
    }

    /// The first motion of a way that is drawn at random.
    fn begin_drawn(&mut self) -> Option<Found> {
        let way = wander(&self.problem, self.search)?;
        let (first, rest) = way.split_first()?;
        self.course.begin_way(rest.iter().map(|leg| leg.0));
        let recovery = if rest.is_empty() { Recovery::Undirected } else { Recovery::Transit };
        Some(Found::of(Some(recovery), *first))
    }

    /// A drive drawn at random, to try again from elsewhere, for a vehicle that has to go round to turn. One that turns on the
    /// spot came to poses twice.
    fn go_elsewhere(&mut self) -> Option<Found> {
        let tries = self.course.tries.checked_add(1).filter(|tries| *tries <= TRIES)?;
        let Search { dynamics, pose, .. } = *self.search;
        // A vehicle that is not safe is so near the border that driving on makes it worse.
        let is_free = goes_round(dynamics, pose) && dynamics.is_safe(pose, &self.problem.area);
        let leg = if is_free { drift(&self.problem, self.search, tries)? } else { return None };
        self.course.tries = tries;
        Some(Found::of(Some(Recovery::Transit), leg))
    }

    /// The first of the fewest turns in place beyond which the undirected problem is feasible.
    fn reorient(&mut self) -> Option<Leg> {
        let (dynamics, pose) = (self.search.dynamics, self.search.pose);
        let left = dynamics.turn_in_place(pose, Side::Left)?;
        let right = dynamics.turn_in_place(pose, Side::Right)?;
        let sharpest = left.1.heading.since(pose.heading).0;
        // What lies ahead is known by now: after each turn, what lies beyond it.
        let (mut to_left, mut to_right, mut turned) = (left.1, right.1, sharpest);
        while turned < Angle::HALF_TURN.0 && self.search.effort.is_enough() {
            self.search.effort.take(1);
            let headings = [to_left.heading, to_right.heading];
            match self.search.best_between(headings, &self.problem.rule) {
                Some((_, Side::Left)) => return Some(left),
                Some((_, Side::Right)) => return Some(right),
                None => {}
            }
            to_left = dynamics.turn_in_place(to_left, Side::Left)?.1;
            to_right = dynamics.turn_in_place(to_right, Side::Right)?.1;
            turned = turned.saturating_add(sharpest);
        }
        None
    }

    /// The first leg to the nearest pose from which the undirected problem is feasible, along one of eight
    /// bearings.
    fn transit(&mut self) -> Result<Leg, DeadEnd> {
        let along = self.problem.lines.slope_arc().bisector();
        let across = along.left();
        let between = Vector { x: along.x.midpoint(across.x), z: along.z.midpoint(across.z) };
        let (mut nearest, mut horizon) = (None, HORIZON);
        let mut otherwise = DeadEnd::Cornered;
        for bearing in [along, across, between, between.left()] {
            for bearing in [bearing, bearing.reversed()] {
                match self.approach(bearing, horizon) {
                    BearingResult::Feasible(leg, motions) => {
                        (nearest, horizon) = (Some(leg), motions - 1);
                    }
                    BearingResult::Fruitless => otherwise = DeadEnd::Resolution,
                    BearingResult::Blocked => {}
                }
            }
        }
        if !self.search.effort.is_enough() {
            otherwise = DeadEnd::Undecided;
        }
        nearest.ok_or(otherwise)
    }

    /// The straight drive in a direction, of at most `horizon` motions, to where the undirected problem
    /// is feasible.
    fn approach(&mut self, direction: Vector, horizon: u32) -> BearingResult {
        let mut first = None;
        let mut pose = self.search.pose;
        for motions in 1..=horizon {
            let Some(leg) = self.leg(pose, direction) else { break };
            let first = *first.get_or_insert(leg);
            // What turns in place lead to is known from the reorientation: nothing.
            if leg.1.site != pose.site {
                let mut there =
                    self.problem.search(self.search.dynamics, leg.1, self.search.effort);
                let there = there.open();
                if there.view.way_out().is_none_or(|way| there.view.is_far(way)) {
                    break;
                }
                let found = there.best(&self.problem.rule, None);
                self.search.effort = there.effort;
                if found.best.is_some() {
                    return BearingResult::Feasible(first, motions);
                }
            }
            pose = leg.1;
        }
        if first.is_some() { BearingResult::Fruitless } else { BearingResult::Blocked }
    }

    /// One motion on the way to a point: the drive that brings it nearer, or the first of the fewest
    /// turns in place after which there is one.
    #[inline(never)] // it is called in four places
    fn leg(&mut self, pose: Pose, goal: Vector) -> Option<Leg> {
        let (dynamics, bearing) = (self.search.dynamics, heading_of(goal));
        let coarse = dynamics.fan().spacing.0 / 2 > ALONG;
        match self.drive(pose, bearing, goal) {
            DriveResult::Leg(leg) => return Some(leg),
            DriveResult::Blocked if !coarse => return None,
            _ => {}
        }
        let off = bearing.since(pose.heading).0 as i32;
        let sides = if off > 0 { [Side::Left, Side::Right] } else { [Side::Right, Side::Left] };
        let first = dynamics.turn_in_place(pose, sides[0])?;
        let sharpest = (first.1.heading.since(pose.heading).0 as i32).unsigned_abs();
        let half_a_turn = Angle::HALF_TURN.0.div_ceil(sharpest.max(1));
        let mut after = [pose; 2];
        for _ in 0..if coarse { half_a_turn.max(TURNS) } else { half_a_turn } {
            if !self.search.effort.is_enough() {
                break;
            }
            self.search.effort.take(1);
            for (side, after) in sides.into_iter().zip(&mut after) {
                *after = dynamics.turn_in_place(*after, side)?.1;
                match self.drive(*after, bearing, goal) {
                    DriveResult::Leg(_) => return dynamics.turn_in_place(pose, side),
                    DriveResult::Blocked if !coarse => return None,
                    _ => {}
                }
            }
        }
        None
    }

    /// The fastest drive that brings a point nearer, if its bearing lies within the fan: along the
    /// nearest ray, or along the one on the other side of the bearing.
    fn drive(&mut self, pose: Pose, bearing: Heading, goal: Vector) -> DriveResult {
        let dynamics = self.search.dynamics;
        let (grid, rays) = (dynamics.grid(), dynamics.around(pose, bearing));
        let aside = bearing.since(rays[0].heading).0 as i32;
        if aside.unsigned_abs() > ALONG.max(dynamics.fan().spacing.0 / 2) {
            return DriveResult::Beyond;
        }
        for ray in rays {
            for speed in (1..grid.speeds()).rev().filter(|speed| nears(&ray, *speed, goal)) {
                if !self.search.effort.take(1) {
                    return DriveResult::Blocked;
                }
                let area = &self.problem.area;
                let stays = |target: &Pose| {
                    area.confines(pose.site, target.site)
                        && dynamics.stays_inside(pose, *target, area)
                };
                let target = dynamics.arrive(pose, &ray, speed).ok();
                if let Some(target) = target {
                    self.search.effort.take_sweep(area, &[pose.site, target.site]);
                }
                if let Some(target) = target.filter(stays) {
                    return DriveResult::Leg((grid.action(ray.index, speed), target));
                }
            }
        }
        DriveResult::Blocked
    }
}

/// The result of one drive on a bearing.
enum DriveResult {
    /// It brings its goal nearer.
    Leg(Leg),
    /// No ray leads that way: a turn may help.
    Beyond,
    /// The rays that lead that way leave the area, or are too long.
    Blocked,
}

/// Whether a drive brings a point nearer by an eighth of its own length at least.
pub(crate) fn nears(ray: &Ray, speed: u16, goal: Vector) -> bool {
    let drive = ray.displacement(speed);
    let square = |v: Vector| single(v.dot(v));
    // |goal - drive| <= |goal| - |drive| / 8 follows from this.
    let length = sqrt(square(drive));
    single(drive.dot(goal)) >= length * (length / 2.0 + sqrt(square(goal)) / 8.0)
}
