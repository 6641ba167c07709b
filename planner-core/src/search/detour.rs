//! The way to uncertain ground, or to a place, round keep-outs.
//!
//! Each keep-out has eight waypoints: the corners of an octagon around it, with some space to spare. The search finds
//! the shortest way from the agent along waypoints that see each other (Dijkstra, 1959). Such a way ends at a point
//! from which a straight way leads to uncertain ground. The agent drives the first leg of that way.
//!
//! A motion may end a step short of a waypoint. So the octagon leaves a space of two steps, and waypoints see each
//! other only past keep-outs that are at least a step away. Then the next waypoint is in sight from there.
//!
//! Where cells are charted, the way leads along these (`channel.rs`).

use heapless::Vec;

use crate::geometry::approximate::distance;
use crate::geometry::heading::Heading;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::span::Span;
use crate::geometry::workspace::{Obstacle, Workspace};
use crate::search::channel;
use crate::search::objective::Effort;
use crate::search::view::View;

/// Waypoints that are considered: those of the first keep-outs.
const MOST: usize = 64;

/// How to get to uncertain ground.
pub(crate) enum Way {
    /// Straight on.
    Straight(Vector),
    /// By a waypoint.
    Round(Vector),
}

struct Waypoint {
    site: Site,
    /// The length of the shortest way there that is known.
    length: f32,
    /// The first leg of that way.
    first: Vector,
    is_settled: bool,
}

/// The first leg of the shortest way from a position to uncertain ground. `straight` is the way to the nearest such
/// ground, whether it is in sight or not. `None` if no way leads there.
///
/// Cost: the looks of the sweeps between waypoints. When the looks are used up, the result is the best way so far.
pub(crate) fn begin<G: Workspace>(
    view: &View<'_, G>,
    from: Site,
    straight: Vector,
    effort: &mut Effort,
) -> Option<Way> {
    let area = view.area();
    let way_out = |site: Site| {
        view.way_out_from(site, |way| site.step(way).is_ok_and(|end| area.lets_pass(&[site, end])))
    };
    begin_by(area, view.step(), (from, straight), effort, way_out)
}

/// The same to a place, in an area for motions that are a step long at least.
pub(crate) fn begin_to<G: Workspace>(
    place: Site,
    (area, step): (&G, f32),
    from: Site,
    effort: &mut Effort,
) -> Option<Way> {
    let way_out = |site: Site| {
        let way = place - site;
        area.lets_pass(&[site, place]).then(|| (way, distance(way)))
    };
    begin_by(area, step, (from, place - from), effort, way_out)
}

/// The same to wherever the straight way leads from each position.
fn begin_by<G: Workspace>(
    area: &G,
    step: f32,
    (from, straight): (Site, Vector),
    effort: &mut Effort,
    way_out: impl Fn(Site) -> Option<(Vector, f32)>,
) -> Option<Way> {
    if area.is_open() {
        return Some(Way::Straight(straight));
    }
    let mut best = way_out(from).map(|(way, length)| (Way::Straight(way), length));
    if let Some(chart) = area.chart() {
        let straight = best.map(|(way, _)| way);
        let round = || channel::begin((area, chart, step), from, effort, way_out).map(Way::Round);
        return straight.or_else(round);
    }
    let mut waypoints: Vec<Waypoint, MOST, u8> = Vec::new();
    add_waypoints(&mut waypoints, (area, step), from);
    let is_shorter = |length: f32, best: &Option<(Way, f32)>| {
        best.as_ref().is_none_or(|(_, least)| length < *least)
    };
    while let Some(nearest) = nearest(&mut waypoints)
        && is_shorter(nearest.length, &best)
        && effort.take(4)
    {
        nearest.is_settled = true;
        let Waypoint { site, length, first, .. } = *nearest;
        if let Some((_, rest)) = way_out(site)
            && is_shorter(length + rest, &best)
        {
            best = Some((Way::Round(first), length + rest));
        }
        for other in &mut waypoints {
            let through = length + distance(other.site - site);
            if through < other.length
                && effort.take_sweep(area, &[site, other.site])
                && area.is_clear(&[site, other.site], step as u32)
            {
                (other.length, other.first) = (through, first);
            }
        }
    }
    best.map(|(way, _)| way)
}

/// Adds the waypoints in an area, each with the straight way there, as far as that is open.
fn add_waypoints<G: Workspace>(
    waypoints: &mut Vec<Waypoint, MOST, u8>,
    (area, step): (&G, f32),
    from: Site,
) {
    for keep_out in area.keep_outs() {
        let corners = octagon(&keep_out, 2.0 * step).into_iter().flatten();
        for site in corners.filter(|it| area.contains(*it)) {
            let first = site - from;
            let is_open = area.lets_pass(&[from, site]) && distance(first) > step;
            let length = if is_open { distance(first) } else { f32::INFINITY };
            let _ = waypoints.push(Waypoint { site, length, first, is_settled: false });
        }
    }
}

/// The nearest waypoint to which a way is known and from which none has been sought.
fn nearest(waypoints: &mut [Waypoint]) -> Option<&mut Waypoint> {
    let open = waypoints.iter_mut().filter(|it| !it.is_settled && it.length < f32::INFINITY);
    open.reduce(|a, b| if b.length < a.length { b } else { a })
}

/// The corners of the octagon that holds a keep-out with so much space to spare; those beyond the lattice are left out.
fn octagon(keep_out: &Obstacle<'_>, space: f32) -> [Option<Site>; 8] {
    const ONE: i32 = 1 << 29;
    const EIGHTH: f32 = core::f32::consts::FRAC_1_SQRT_2;
    let Some(&about) = keep_out.corners.first() else { return [None; 8] };
    let away = keep_out.radius.saturating_add(keep_out.margin) as f32 + space;
    let normal = |k: u32| {
        let Vector { x, z } = Heading(k << 29).unit().scaled(ONE);
        [x as f32 / ONE as f32, z as f32 / ONE as f32]
    };
    let height = |k: u32| {
        let [x, z] = normal(k % 8);
        let reach = |corner: &Site| x * (*corner - about).x as f32 + z * (*corner - about).z as f32;
        Span::of(keep_out.corners.iter().map(reach)).high + away
    };
    core::array::from_fn(|k| {
        let k = k as u32;
        let ([x, z], here) = (normal(k), height(k));
        let aside = (height(k + 1) - here * EIGHTH) / EIGHTH;
        let by = [here * x - aside * z, here * z + aside * x];
        about.step(Vector { x: by[0] as i32, z: by[1] as i32 }).ok()
    })
}
