//! Where to read next along a front.
//!
//! It looks at some distances along the front, up to one motion. At each it looks at two places: on the median of the
//! front, and on the robot's own line or near it, where a label still tells enough. A place is worth
//!
//! ```text
//! bits of its label + counts * progress - 0.5 (way - progress)
//! ```
//!
//! with way and progress in reaches. A vehicle that turns on a circle looks farther ahead, and its way includes the turn:
//! a place within its circle costs a turn all round.
//!
//! Progress counts in full where the front is known to a fifth of a reach, or of the circle's radius, and less where it is
//! known worse. Where it is hardly known, progress counts against a place, so the robot stays and looks. Where the last two
//! labels were the same, it looks on the other side. Labels on one side alone do not show that a front bends away.

use crate::belief::curve::Curve;
use crate::belief::front::limited;
use crate::belief::predictions::entropy;
use crate::belief::sample::Label;
use crate::geometry::approximate::{cross, distance, heading_of, sqrt};
use crate::geometry::lattice::{Site, UNITS_PER_METRE};
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::search::motions::Leg;
use crate::search::places::EndSearch;

/// How far ahead it looks, reaches.
const WAYS: [f32; 11] = [0.0, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95, 0.98, 1.0];

/// With true labels progress counts in full where the front is known to this, in reaches. With others it is more.
const FULL: f32 = 0.22;

/// The same where it does not count.
const NONE: f32 = 0.37;

/// What it counts where the front is hardly known.
const LOST: f32 = -2.0;

/// What a reach beside the progress costs, bits.
const BESIDES: f32 = 0.5;

/// It looks so many deviations from the median at most, and no further than this in reaches.
const ASIDE: f32 = 0.5;

/// A shorter way is none, reaches.
const STILL: f32 = 0.02;

/// A label is certain where the other one has at most this probability, if labels are true. It is sought so far ahead, in
/// reaches, from so many deviations and reaches beside the front on, by a factor.
const SURE: f32 = 0.005;
const AHEAD: f32 = 0.9;
const CERTAIN: f32 = 2.5;
const LEAST: f32 = 0.05;
const FARTHER: f32 = 1.3;

/// The same once the robot is there.
const NEARLY: f32 = 0.03;

/// Ends of motions that are looked at for the one nearest to a place, and how often beside the best.
const ENDS: u32 = 64;
const CLOSER: u32 = 6;

/// Radians in a unit of an angle, and in a turn.
const RADIAN: f32 = core::f32::consts::PI / (1_u32 << 31) as f32;
const TURN: f32 = core::f32::consts::TAU;

/// Of the cross product the sign alone counts. It is scaled to a share.
const SIDE: f32 = 1e-9;

/// The bits of a label where this share of the curves lies below.
fn bits(share: f32, errs: f32) -> f32 {
    entropy((1.0 - errs) * share + errs * (1.0 - share)) - entropy(errs)
}

/// The best place to go to from a pose; `None` where there is none in the area.
///
/// Cost: 11 times what all Gaussians come to at a place, and their median; some 120,000 instructions.
pub(crate) fn best_place<G: Workspace>(
    (area, radius): (&G, f32),
    curve: &Curve,
    pose: Pose,
) -> Option<Site> {
    let errs = curve.error();
    let per_capacity = 1.0 / sqrt(1.0 - entropy(errs) + 1e-3);
    // A vehicle with a turning circle looks ahead by its radius, too, and knows a front no better than it can follow.
    let turns = radius / (curve.reach() * UNITS_PER_METRE as f32);
    let per_capacity = per_capacity * if turns > 1.0 { turns } else { 1.0 };
    let lost = LOST / (1.0 + turns);
    let (full, none) = (FULL * per_capacity, NONE * per_capacity);
    let per = 1.0 / (curve.reach() * UNITS_PER_METRE as f32);
    let [start, aside] = curve.see(pose.site);
    let side = curve.neglected();
    let mut best: Option<(Site, f32)> = None;
    for way in WAYS.map(|it| (1.0 + turns) * it) {
        let offsets = curve.ahead(start + way);
        let (median, deviation) = (offsets.median(), offsets.deviation());
        let counts = (none - offsets.distance(median)) / (none - full);
        let counts = 0.5 * (1.0 + lost) + limited(counts - 0.5 * (1.0 + lost), 0.5 * (1.0 - lost));
        let beside = ASIDE * if deviation < 1.0 { deviation } else { 1.0 };
        let own = match aside - median {
            _ if side != 0.0 => side * beside,
            off if off > beside => beside,
            off if off < -beside => -beside,
            off => off,
        };
        for off in [0.0, own] {
            let left = median + off;
            let site = curve.site_at(start + way, left);
            let long = way_to(pose, site, radius) * per;
            if long < STILL || !area.contains(site) {
                continue;
            }
            let share = if off == 0.0 { 0.5 } else { offsets.below(left) };
            let told = bits(share, errs);
            let motions = if long > 1.0 { long } else { 1.0 };
            let besides = if long > way { long - way } else { 0.0 };
            let worth = (told + counts * way) / motions - BESIDES * besides;
            if best.is_none_or(|best| worth > best.1) {
                best = Some((site, worth));
            }
        }
    }
    best.map(|best| best.0)
}

/// How far a vehicle with a turning circle of this radius drives to a place: it turns first. Lattice units.
fn way_to(from: Pose, place: Site, radius: f32) -> f32 {
    let way = place - from.site;
    let long = distance(way);
    if radius == 0.0 {
        return long;
    }
    let off = (heading_of(way).since(from.heading).0 as i32).unsigned_abs() as f32 * RADIAN;
    // It cannot turn to a place within its circle: a turn all round comes before it.
    let is_within = long < 2.0 * radius * libm::sinf(off);
    long + radius * if is_within { TURN } else { off }
}

/// The label that is certain where this share of the curves lies above, if any is.
pub(crate) fn sure_label(share: f32) -> Option<Label> {
    match share {
        _ if share > 1.0 - NEARLY => Some(Label::Positive),
        _ if share < NEARLY => Some(Label::Negative),
        _ => None,
    }
}

/// A place ahead whose label is certain, on one side of the front: what tells a wrong model. `None` where none lies so near
/// to the front, in reaches, or where it is outside the area.
pub(crate) fn certain_place<G: Workspace>(
    area: &G,
    curve: &Curve,
    pose: Pose,
    (side, farthest): (f32, f32),
) -> Option<Site> {
    let [start, _] = curve.see(pose.site);
    let offsets = curve.ahead(start + AHEAD);
    let (median, deviation) = (offsets.median(), offsets.deviation());
    let mut off = CERTAIN * deviation + LEAST;
    while off < farthest {
        let left = median + side * off;
        let below = offsets.below(left);
        if (below - 0.5).abs() > 0.5 - SURE {
            let site = curve.site_at(start + AHEAD, left);
            return area.contains(site).then_some(site);
        }
        off *= FARTHER;
    }
    None
}

/// The motion that ends nearest to a place, and how many ends were looked at.
pub(crate) fn towards<D: Dynamics, G: Workspace>(
    (dynamics, area, radius): (&D, &G, f32),
    pose: Pose,
    place: Site,
) -> Option<(Leg, u32)> {
    let way = place - pose.site;
    let grid = dynamics.grid();
    let speed = (distance(way) / grid.step_units() + 0.5) as u16;
    let speed = speed.min(grid.speeds().saturating_sub(1)).max(1);
    let mut best: Option<(Leg, f32)> = None;
    let share = |end: Pose| 0.5 + SIDE * cross(way, end.site - pose.site);
    let find = |leg: Leg, _: f32| {
        let off = way_to(leg.1, place, radius);
        let is_better = best.is_none_or(|best| off < best.1);
        if is_better {
            best = Some((leg, off));
        }
        is_better
    };
    let mut places =
        EndSearch { dynamics, area, pose, share, find, best: None, examined: 0, most: ENDS };
    for speed in [speed, speed.saturating_sub(1)].into_iter().filter(|it| *it > 0) {
        let _ = places.circle(speed);
    }
    let _ = places.beside_best(CLOSER);
    let examined = places.examined;
    best.map(|best| (best.0, examined))
}
