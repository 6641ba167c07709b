//! Checks the contract of [`Dynamics`], for implementations of your own.
//!
//! The search relies on the promises of a fan to skip rays. So dynamics that break a promise lead to wrong plans, not
//! to errors. Call [`check`] in a test.
//!
//! ```
//! use planner_core::Unicycle;
//! use planner_core::dynamics::check;
//!
//! check(&Unicycle::paper())?;
//! # Ok::<(), planner_core::error::ContractError>(())
//! ```

use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{Site, Vector};
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Ray, RayFan, Side};

/// A promise of [`Dynamics`] that is not kept, by its number in the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ContractError {
    /// 1: the fan has not as many rays as the grid, or none on the left.
    Count,
    /// 2: this ray turns back from the ray before, or not at all, or further than the fan's spacing. Or the fan's sides
    /// overlap behind it.
    Spacing(Side, u32),
    /// 3: this ray asks for less effort than one before it.
    Effort(Side, u32),
    /// 4: this ray does not lead where its heading points, or by another length than the grid's.
    Step(Side, u32),
    /// 5: this ray's index is not in the grid, is another ray's too, or does not lead back to it.
    Index(Side, u32),
    /// 6: the turn in place to this side moves the agent, or turns it the other way or not at all. Or it leaves a gap
    /// between the fans.
    TurnInPlace(Side),
    /// 7: this speed has more rays than a faster one, or it is the fastest and has not all rays. Or an action of this
    /// speed has no ray, or should have none.
    Speeds(u16),
    /// 8: this ray does not lead a displacement away, or its tangents do not meet in its corner.
    Arrival(Side, u32),
    /// 9: the turning circle to this side is missing although there is one to the other side. Or it turns the other way or not
    /// at all, or leaves its radius within a round.
    TurningCircle(Side),
}

impl core::fmt::Display for ContractError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Count => f.write_str("the fan has not as many rays as the grid"),
            Self::Spacing(side, n) => {
                write!(f, "ray {n} to the {side:?} is not between nothing and the spacing further")
            }
            Self::Effort(side, n) => {
                write!(f, "ray {n} to the {side:?} asks for less effort than one before it")
            }
            Self::Step(side, n) => {
                write!(
                    f,
                    "ray {n} to the {side:?} does not lead one step of speed along its heading"
                )
            }
            Self::Index(side, n) => {
                write!(f, "the index of ray {n} to the {side:?} does not name that ray alone")
            }
            Self::TurnInPlace(side) => {
                write!(f, "the turn in place to the {side:?} is none, or leaves a gap")
            }
            Self::Speeds(speed) => {
                write!(f, "speed {speed} has not the rays that it says, or more than a faster one")
            }
            Self::Arrival(side, n) => {
                write!(f, "ray {n} to the {side:?} does not arrive where its chord and corner say")
            }
            Self::TurningCircle(side) => {
                write!(
                    f,
                    "the turning circle to the {side:?} is none, or leaves its radius within a round"
                )
            }
        }
    }
}

impl core::error::Error for ContractError {}

/// Headings from which an implementation is looked at: the axes, and between.
const HEADINGS: u32 = 16;

/// Whether the [contract](Dynamics#contract) is kept, at a position and at headings all around. A few
/// hundred instructions for each ray and heading; of a side with more than 65,536 rays some 8,000 are looked
/// at, neighbours among them.
///
/// # Errors
/// [`ContractError`]: the first promise that was found broken.
pub fn check<D: Dynamics>(dynamics: &D) -> Result<(), ContractError> {
    let RayFan { left, right, .. } = dynamics.fan();
    if left == 0 || left.checked_add(right) != Some(dynamics.grid().rays()) {
        return Err(ContractError::Count);
    }
    let site = Site::new(12_345, -6_789).unwrap_or(Site::ORIGIN);
    for n in 0..HEADINGS {
        // A turn that is a multiple of nothing else.
        let pose = Pose { site, heading: Heading(n * (u32::MAX / HEADINGS)) };
        let reached =
            [arm(dynamics, pose, Side::Left, left - 1)?, arm(dynamics, pose, Side::Right, right)?];
        let [left, right] = reached;
        if u64::from(left) + u64::from(right) > 1 << 32 {
            return Err(ContractError::Spacing(Side::Right, dynamics.fan().right));
        }
        for (side, most) in [(Side::Left, left), (Side::Right, right)] {
            turn_in_place(dynamics, pose, side, most)?;
            goes_round(dynamics, pose, side)?;
        }
        speeds(dynamics, pose)?;
    }
    Ok(())
}

/// Checks the rays of one side up to the last; how far they reach.
fn arm<D: Dynamics>(dynamics: &D, pose: Pose, side: Side, last: u32) -> Result<u32, ContractError> {
    let ahead = dynamics.ray(pose, Side::Left, 0);
    let spacing = u64::from(dynamics.fan().spacing.0);
    let (mut before, mut turned_before, mut effort) = (0, 0, ahead.turn_cost);
    for n in looked_at(last) {
        let ray = dynamics.ray(pose, side, n);
        let turned = turn(ahead.heading, ray.heading, side);
        let (rays, more) = (n - before, turned.wrapping_sub(turned_before));
        let is_between = more >= rays && u64::from(more) <= u64::from(rays) * spacing;
        if n == 0 && ray != ahead || turned < turned_before || !is_between {
            return Err(ContractError::Spacing(side, n));
        }
        if ray.turn_cost < effort {
            return Err(ContractError::Effort(side, n));
        }
        if ray.heading != dynamics.heading(pose, side, n) || !leads_ahead(dynamics, &ray) {
            return Err(ContractError::Step(side, n));
        }
        if !is_named(dynamics, pose, &ray) {
            return Err(ContractError::Index(side, n));
        }
        if !arrives(dynamics, pose, &ray) {
            return Err(ContractError::Arrival(side, n));
        }
        (before, turned_before, effort) = (n, turned, ray.turn_cost);
    }
    Ok(turned_before)
}

/// The rays of a side that are looked at: all up to the last; of more than 65,536 some 8,000, each second
/// one the neighbour of the one before it, and the last two.
fn looked_at(last: u32) -> impl Iterator<Item = u32> {
    let leap = if last < 1 << 16 { 0 } else { 2 * (last >> 13) };
    core::iter::successors(Some(0), move |&n: &u32| {
        let step = if n.is_multiple_of(2) { 1 } else { 1 + leap };
        match last - n {
            0 => None,
            1 => Some(last),
            rest => Some(n + step.min(rest - 1)),
        }
    })
}

/// The turn to a side from one heading to another.
fn turn(from: Heading, to: Heading, side: Side) -> u32 {
    match side {
        Side::Left => to.0.wrapping_sub(from.0),
        Side::Right => from.0.wrapping_sub(to.0),
    }
}

/// Whether a ray's step has the heading and the length that it should, to a few units.
fn leads_ahead<D: Dynamics>(dynamics: &D, ray: &Ray) -> bool {
    let exact = ray.heading.unit().scaled(dynamics.grid().step_length());
    let near = |a: i32, b: i32| a.checked_sub(b).is_some_and(|off| i64::from(off).abs() <= FEW);
    near(ray.step.x, exact.x) && near(ray.step.z, exact.z)
}

/// Whether the actions of a ray at the slowest and the fastest speed lead back to it, if it has them. Indices are below
/// their number, and each gives its own ray back, so none is used twice.
fn is_named<D: Dynamics>(dynamics: &D, pose: Pose, ray: &Ray) -> bool {
    let grid = dynamics.grid();
    let back = |speed| dynamics.ray_of(pose, grid.action(ray.index, speed));
    let is_itself = |it: Ray| it == *ray;
    let slowest_is_none = dynamics.rays_at(0).is_some() && back(0).is_none();
    ray.index < grid.rays()
        && (slowest_is_none || back(0).is_some_and(is_itself))
        && (grid.speeds() == 1 || back(grid.speeds() - 1).is_some_and(is_itself))
}

/// Off by so many lattice units at most, for rounding.
const FEW: i64 = 4;

/// Whether the fastest motion along a ray ends where it should, and its tangents meet in its corner.
fn arrives<D: Dynamics>(dynamics: &D, pose: Pose, ray: &Ray) -> bool {
    const UNIT: i32 = 1 << 29;
    let speed = dynamics.grid().speeds() - 1;
    let Ok(end) = dynamics.arrive(pose, ray, speed) else { return false };
    let by = end.site - pose.site;
    let leads = |heading: Heading, v: Vector| {
        let unit = heading.unit().scaled(UNIT);
        unit.cross(v).abs() <= FEW * i64::from(UNIT) && unit.dot(v) >= -FEW * i64::from(UNIT)
    };
    let meets = |corner: Vector| {
        let rest = Vector { x: by.x.wrapping_sub(corner.x), z: by.z.wrapping_sub(corner.z) };
        leads(pose.heading, corner) && leads(end.heading, rest)
    };
    by == ray.displacement(speed) && dynamics.tangent_intersection(pose, end).is_none_or(meets)
}

/// Checks which rays speeds have: the fastest all, a slower one no more than a faster, and each those that it says.
fn speeds<D: Dynamics>(dynamics: &D, pose: Pose) -> Result<(), ContractError> {
    let RayFan { left, right, .. } = dynamics.fan();
    let fastest = u32::from(dynamics.grid().speeds() - 1);
    let mut most = [left, right];
    for slower in looked_at(fastest) {
        let speed = (fastest - slower) as u16;
        let Some(rays) = dynamics.rays_at(speed) else { continue };
        let has_all = slower > 0 || fastest == 0 || rays == [left, right];
        let has_more = rays[0] > most[0] || rays[1] > most[1];
        if !has_all || has_more || !has_rays(dynamics, pose, speed, rays) {
            return Err(ContractError::Speeds(speed));
        }
        most = rays;
    }
    Ok(())
}

/// Whether a speed has so many rays on the left and on the right: on each side it has the last of them, and not the
/// next. Without any on the left it has none straight ahead.
fn has_rays<D: Dynamics>(
    dynamics: &D,
    pose: Pose,
    speed: u16,
    [on_left, on_right]: [u32; 2],
) -> bool {
    let (grid, RayFan { left, right, .. }) = (dynamics.grid(), dynamics.fan());
    let is_right = |side, last: u32, count: u32, n: u32| {
        let exists = n < count && (n > 0 || on_left > 0);
        let is_known = || {
            let ray = dynamics.ray(pose, side, n);
            dynamics.ray_of(pose, grid.action(ray.index, speed)).is_some()
        };
        n > last || is_known() == exists
    };
    [(Side::Left, left - 1, on_left), (Side::Right, right, on_right.saturating_add(1))]
        .into_iter()
        .all(|(side, last, count)| {
            [count.wrapping_sub(1), count].into_iter().all(|n| is_right(side, last, count, n))
        })
}

/// Goes round a turning circle.
fn goes_round<D: Dynamics>(dynamics: &D, from: Pose, side: Side) -> Result<(), ContractError> {
    /// Motions of a round at most.
    const MOST: u32 = 1 << 16;
    let Some(circle) = dynamics.turning_circles(from).map(|it| side.of(it)) else { return Ok(()) };
    let is_within = |v: Vector, radius: i32| {
        let off =
            Vector { x: v.x.wrapping_sub(circle.centre.x), z: v.z.wrapping_sub(circle.centre.z) };
        off.dot(off) <= (i64::from(radius) + FEW).pow(2)
    };
    let (mut pose, mut turned, mut radius) = (from, 0_u32, circle.radius);
    for _ in 0..MOST {
        let action = dynamics.turning_circles(pose).map(|it| side.of(it).action);
        let after = action.and_then(|action| dynamics.target(pose, action));
        let Some(after) = after else { break };
        let more = turn(pose.heading, after.heading, side);
        let by = pose.site - from.site;
        let corner = dynamics.tangent_intersection(pose, after);
        let corner = corner.map_or(by, |it| Vector { x: by.x + it.x, z: by.z + it.z });
        if more == 0 || more > Angle::HALF_TURN.0 || after.site == pose.site {
            break;
        }
        if !is_within(after.site - from.site, radius) || !is_within(corner, radius) {
            break;
        }
        radius = circle.radius.saturating_add(circle.margin);
        let (all, is_round) = turned.overflowing_add(more);
        if is_round {
            return Ok(());
        }
        (pose, turned) = (after, all);
    }
    Err(ContractError::TurningCircle(side))
}

fn turn_in_place<D: Dynamics>(
    dynamics: &D,
    pose: Pose,
    side: Side,
    most: u32,
) -> Result<(), ContractError> {
    let Some((Action(action), after)) = dynamics.turn_in_place(pose, side) else { return Ok(()) };
    let turned = turn(pose.heading, after.heading, side);
    let there = dynamics.target(pose, Action(action));
    if after.site == pose.site && turned > 0 && turned <= most && there == Some(after) {
        Ok(())
    } else {
        Err(ContractError::TurnInPlace(side))
    }
}
