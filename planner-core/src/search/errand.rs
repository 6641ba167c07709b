//! A motion on the way to a place, for any vehicle.
//!
//! The vehicle turns to one side, on the spot or round its circle, until a drive brings it nearer to the place, and makes
//! that drive. Of all such ways the errand takes the one with the fewest motions. If there is none, a vehicle that goes
//! round to turn drives straight on first. Keep-outs are passed by their waypoints (`detour`).
//!
//! An errand has no state, and it need not arrive: whoever runs it counts the motions, and watches how many are left.

use crate::geometry::approximate::{distance, heading_of};
use crate::geometry::heading::Angle;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose, Side, TurningCircle};
use crate::search::detour::{self, Way};
use crate::search::motions::{Leg, Motions};
use crate::search::objective::Effort;
use crate::search::recovery::nears;
use crate::search::wander::stays;

/// Straight motions before a turn at most, where no turn leads to the place at once.
const STRAIGHT: u32 = 8;

/// Turns to one side at most. A vehicle with finer turns goes as far as these lead it.
const TURNS: u32 = 64;

/// The looks that a place on a way takes.
const LOOKS_A_PLACE: u32 = 4;

/// Nobody knows how many motions lead to the place.
pub(crate) const UNKNOWN: u8 = u8::MAX;

/// A motion on the way, and whether it ends at the place.
#[derive(Clone, Copy)]
pub(crate) struct Errand {
    pub(crate) leg: Leg,
    pub(crate) arrives: bool,
    /// About how many motions lead to the place, with this one. [`UNKNOWN`] where keep-outs lie between.
    pub(crate) motions: u8,
}

/// What drives lead to.
#[derive(Clone, Copy)]
struct Destination {
    site: Site,
    /// A drive that ends so near to it arrives, lattice units. None arrives at a waypoint.
    near: Option<f32>,
    /// The fastest speed of a drive.
    fastest: u16,
}

impl Destination {
    /// The speeds at which a drive may arrive so many steps away, then ever slower ones that do not overshoot. Each with
    /// whether it arrives.
    fn speeds(self, steps: f32) -> impl Iterator<Item = (u16, bool)> {
        let nearest = (steps + 0.5) as u16;
        let arriving = [nearest, nearest.saturating_sub(1), nearest.saturating_add(1)];
        let arriving = arriving.into_iter().filter(move |_| self.near.is_some());
        let most = (steps as u16).min(self.fastest);
        let nearing = (0..u16::BITS).map(move |k| most >> k);
        let all = arriving.map(|it| (it, true)).chain(nearing.map(|it| (it, false)));
        all.filter(move |(speed, _)| (1..=self.fastest).contains(speed))
    }
}

/// The best way so far: its first motion, and about how many motions it has.
#[derive(Clone, Copy)]
struct BestErrand {
    errand: Errand,
    motions: f32,
}

/// Where a way has come to.
#[derive(Clone, Copy)]
struct ErrandNode {
    pose: Pose,
    first: Option<Leg>,
    motions: u32,
}

/// The next motion on the way to a place, which ends `near` it, lattice units. `None` if there is no way.
///
/// Cost: the looks that are left, at most.
pub(crate) fn errand<D: Dynamics, G: Workspace>(
    (dynamics, area): (&D, &G),
    pose: Pose,
    (place, near): (Site, f32),
    effort: &mut Effort,
) -> Option<Errand> {
    errand_in_steps((dynamics, area), pose, (place, near, u16::MAX), effort)
}

/// The same in drives up to a speed.
pub(crate) fn errand_in_steps<D: Dynamics, G: Workspace>(
    (dynamics, area): (&D, &G),
    pose: Pose,
    (place, near, fastest): (Site, f32, u16),
    effort: &mut Effort,
) -> Option<Errand> {
    let fastest = fastest.min(dynamics.grid().speeds().saturating_sub(1));
    let step = dynamics.grid().step_units();
    let aim = match detour::begin_to(place, (area, step), pose.site, effort)? {
        Way::Straight(_) => Destination { site: place, near: Some(near), fastest },
        Way::Round(way) => Destination { site: pose.site.step(way).ok()?, near: None, fastest },
    };
    let mut motions = Motions::new(dynamics, area, pose, *effort);
    let best = search(&mut motions, pose, aim);
    *effort = motions.effort;
    best.map(|best| {
        let motions = if aim.near.is_some() { best.motions as u8 } else { UNKNOWN };
        Errand { motions, ..best.errand }
    })
}

/// About how many motions lead from a pose to a place in sight, one at least: so many turns, and a straight drive. Where
/// the place lies within the vehicle's circle, a whole turn comes before it.
pub(crate) fn motions_to<D: Dynamics>(dynamics: &D, pose: Pose, place: Site) -> f32 {
    let (grid, way) = (dynamics.grid(), place - pose.site);
    let reach = grid.longest_units();
    let drives = distance(way) / reach;
    let drives = if drives > 1.0 { drives } else { 1.0 };
    let circles = dynamics.turning_circles(pose);
    let turned = match (dynamics.turn_in_place(pose, Side::Left), circles) {
        (Some((_, turned)), _) => Some(turned),
        (None, Some([left, _])) => dynamics.target(pose, left.action),
        (None, None) => None,
    };
    let Some(turned) = turned else { return drives };
    let is_within = |circle: TurningCircle| {
        distance(Vector { x: way.x - circle.centre.x, z: way.z - circle.centre.z })
            < circle.radius as f32
    };
    let is_within = circles.is_some_and(|it| it.into_iter().any(is_within));
    let off = (heading_of(way).since(pose.heading).0 as i32).unsigned_abs() as f32;
    let off = if is_within { 2.0 * Angle::HALF_TURN.0 as f32 } else { off };
    drives + off / turned.heading.since(pose.heading).0 as f32
}

fn search<D: Dynamics, G: Workspace>(
    motions: &mut Motions<'_, '_, D, G>,
    pose: Pose,
    aim: Destination,
) -> Option<BestErrand> {
    let mut best = None;
    let mut from = ErrandNode { pose, first: None, motions: 0 };
    for _ in 0..=STRAIGHT {
        drive(motions, from, aim, &mut best);
        for side in [Side::Left, Side::Right] {
            turn(motions, from, side, aim, &mut best);
        }
        if best.is_some() {
            break;
        }
        // One that turns on the spot has tried all directions.
        let goes_round = motions.dynamics.turning_circles(from.pose).is_some();
        let ahead = if goes_round { motions.straight(from.pose) } else { None };
        let Some(leg) = ahead else { break };
        from = from.after(leg);
    }
    best
}

/// Turns to a side and looks at each place on the way, for a whole turn at most.
fn turn<D: Dynamics, G: Workspace>(
    motions: &mut Motions<'_, '_, D, G>,
    from: ErrandNode,
    side: Side,
    aim: Destination,
    best: &mut Option<BestErrand>,
) {
    let (mut place, mut turned) = (from, 0_u32);
    for _ in 0..TURNS {
        let on_the_spot = motions.dynamics.turn_in_place(place.pose, side);
        let Some(leg) = on_the_spot.or_else(|| motions.round(place.pose, side)) else { return };
        place = place.after(leg);
        let left = place.pose.heading.since(from.pose.heading).0;
        let turn = if side == Side::Left { left } else { left.wrapping_neg() };
        if turn <= turned || !drive(motions, place, aim, best) {
            return;
        }
        turned = turn;
    }
}

/// Looks for a drive from a place that ends at the aim, or brings it nearer. Whether more motions may still make a
/// better way.
fn drive<D: Dynamics, G: Workspace>(
    motions: &mut Motions<'_, '_, D, G>,
    from: ErrandNode,
    aim: Destination,
    best: &mut Option<BestErrand>,
) -> bool {
    let is_short = best.is_none_or(|best| ((from.motions + 1) as f32) < best.motions);
    if !is_short || !motions.effort.take(LOOKS_A_PLACE) {
        return false;
    }
    let (dynamics, grid) = (motions.dynamics, motions.dynamics.grid());
    let way = aim.site - from.pose.site;
    let steps = distance(way) / grid.step_units();
    for ray in dynamics.around(from.pose, heading_of(way)) {
        let found = aim.speeds(steps).find_map(|(speed, arrives)| {
            let leads_there = (arrives || nears(&ray, speed, way)) && motions.effort.take(1);
            let action = leads_there.then(|| grid.action(ray.index, speed))?;
            let after = dynamics.target(from.pose, action)?;
            let left = distance(aim.site - after.site);
            let ends = !arrives || aim.near.is_some_and(|near| left <= near);
            let goes =
                ends && stays(dynamics, motions.area, &mut motions.effort, [from.pose, after]);
            let more = if arrives { 0.0 } else { motions_to(dynamics, after, aim.site) };
            goes.then(|| ((action, after), arrives, (from.motions + 1) as f32 + more))
        });
        if let Some((leg, arrives, motions)) = found
            && best.is_none_or(|best| motions < best.motions)
        {
            let arrives = arrives && from.first.is_none();
            let errand = Errand { leg: from.first.unwrap_or(leg), arrives, motions: UNKNOWN };
            *best = Some(BestErrand { errand, motions });
        }
    }
    true
}

impl ErrandNode {
    fn after(self, leg: Leg) -> Self {
        Self { pose: leg.1, first: self.first.or(Some(leg)), motions: self.motions + 1 }
    }
}
