//! The drawing of a mission for a viewer: the area and the true line once, then what each step adds or replaces.
//!
//! A viewer replaces what has the same name. So what grows with every step is drawn in parts: the last steps, written with
//! each step, the earlier ones, written with every 64th, and the earliest, written with every 4,096th.

use std::ops::Range;

use foxglove::messages::{
    Color, CubePrimitive, LinePrimitive, SceneEntity, SceneUpdate, SpherePrimitive,
    TriangleListPrimitive, Vector3,
};
use nalgebra::Point2;
use planner_core::Label;

use crate::report::bands::Band;
use crate::report::ground::Ground;
use crate::report::log::messages::{FRAME, ROBOT, point, pose, time};
use crate::report::page::scene::{Flight, MapPlace, Scene, SeenFront};
use crate::report::style::{self, ESTIMATE, FRONT, KEEP_OUT, PATH, SHADES, Stroke};
use crate::world::way::Way;

/// Pixels.
const THIN: f64 = 1.0;
const THICK: f64 = 3.0;

/// A sample's size as a share of the area's.
const SAMPLE: f64 = 0.012;

/// The start: all that stands still, and every name under which a step draws. Rerun shows an error for a name that
/// first appears later.
pub(super) fn begin(flight: &Flight) -> SceneUpdate {
    let size = SAMPLE * flight.size();
    let border = line(&flight.area.0, true, THIN, of(PATH));
    let keep_outs = flight.keep_outs.iter().map(|ring| fan(&ring.0, opaque(KEEP_OUT.colour)));
    let mut entities = vec![
        SceneEntity { lines: vec![border], triangles: keep_outs.collect(), ..entity("area", 0) },
        samples("given", 0, flight.given.iter().copied(), 1.5 * size),
    ];
    let still = flight.boundary.iter().filter(|it| !it.ways.is_empty());
    entities.extend(still.map(|it| truth(&it.name, &it.ways, 0)));
    entities.extend(names(flight).flat_map(|part| grown(part, flight, &(0..0), 0)));
    if let Some(scene) = flight.scenes.first() {
        entities.extend(seen(flight, scene, 0));
    }
    SceneUpdate { entities, ..SceneUpdate::default() }
}

/// The robot: a triangle that points ahead, in the robot's own frame.
pub(super) fn robot(flight: &Flight) -> SceneEntity {
    let size = SAMPLE * flight.size();
    let corners = [[1.5 * size, 0.0], [-size, size], [-size, -size]].map(Point2::from);
    let border = line(&corners, true, THICK, of(PATH));
    SceneEntity { lines: vec![border], frame_id: ROBOT.to_owned(), ..entity("robot", 0) }
}

/// Steps after which they belong to the next part.
const PART: usize = 64;

/// What the names of parts begin with, the last steps first.
const PARTS: [&str; 3] = ["", "earlier ", "earliest "];

/// The parts that a step changes: the beginning of the name of each, and the steps after the first and up to the last of
/// its range.
fn parts(step: usize) -> impl Iterator<Item = (&'static str, Range<usize>)> {
    PARTS.into_iter().enumerate().filter_map(move |(level, name)| {
        let unit = PART.pow(level as u32);
        let is_last = level + 1 == PARTS.len();
        let begin = if is_last { 0 } else { step - step % (unit * PART) };
        step.is_multiple_of(unit).then_some((name, begin..step))
    })
}

/// The names of the parts that a mission comes to.
fn names(flight: &Flight) -> impl Iterator<Item = &'static str> {
    let last = flight.scenes.len().saturating_sub(1);
    (0..)
        .zip(PARTS)
        .filter(move |(level, _)| *level == 0 || last >= PART.pow(*level))
        .map(|it| it.1)
}

/// What each step adds.
pub(super) fn steps(flight: &Flight) -> impl Iterator<Item = SceneUpdate> {
    (1..).zip(flight.scenes.iter().skip(1)).map(move |(second, scene)| {
        let parts = parts(second as usize);
        let grown = parts.flat_map(|(part, steps)| grown(part, flight, &steps, second));
        let entities = grown.chain(seen(flight, scene, second)).collect();
        SceneUpdate { entities, ..SceneUpdate::default() }
    })
}

/// What grows with every step: a part of it, of some steps.
fn grown(part: &str, flight: &Flight, steps: &Range<usize>, second: u32) -> Vec<SceneEntity> {
    let path = path(part, flight, steps, second);
    let read = read(part, flight, steps, second);
    let front = follows(flight).then(|| front(part, flight, steps, second));
    [path, read].into_iter().chain(front).collect()
}

/// The way of some steps.
fn path(part: &str, flight: &Flight, steps: &Range<usize>, second: u32) -> SceneEntity {
    let moved =
        flight.scenes[steps.start + 1..=steps.end].iter().filter_map(|it| it.motion.as_ref());
    let begin = flight.scenes[steps.start].at;
    let way: Vec<_> = [begin].into_iter().chain(moved.flat_map(|it| it.way.clone())).collect();
    let way = line(&way, false, THIN, of(PATH));
    let lines = if steps.is_empty() { Vec::new() } else { vec![way] };
    SceneEntity { lines, ..entity(&format!("{part}path"), second) }
}

/// The samples of some steps.
fn read(part: &str, flight: &Flight, steps: &Range<usize>, second: u32) -> SceneEntity {
    let scenes = flight.scenes[steps.start + 1..=steps.end].iter();
    let read = scenes.filter_map(|it| Some((it.at, it.motion.as_ref()?.label?)));
    samples(&format!("{part}samples"), second, read, SAMPLE * flight.size())
}

/// The map of a front after some steps, and from the one before on: each piece with the borders of its 90 % band.
fn front(part: &str, flight: &Flight, steps: &Range<usize>, second: u32) -> SceneEntity {
    let before = flight.scenes[..=steps.start].iter().rev().find_map(|it| it.mapped.last());
    let added = flight.scenes[steps.start + 1..=steps.end].iter().flat_map(|it| &it.mapped);
    let is_end = steps.end + 1 == flight.scenes.len();
    let rest = flight.rest.iter().filter(|_| is_end && !steps.is_empty());
    let mut pieces: Vec<Vec<[Point2<f64>; 3]>> = vec![before.map(rung).into_iter().collect()];
    for it in added.chain(rest) {
        if it.begins {
            pieces.push(Vec::new());
        }
        pieces.last_mut().expect("at least one").push(rung(it));
    }
    // One that begins with the place before, and has no other, is drawn in an earlier part.
    let is_old = pieces[0].len() < 2;
    let pieces = pieces.iter().skip(is_old.into());
    SceneEntity { lines: band(pieces), ..entity(&format!("{part}front"), second) }
}

/// A place of a map, and the ends of its interval.
fn rung(MapPlace { at, ends: [left, right], .. }: &MapPlace) -> [Point2<f64>; 3] {
    [*at, *left, *right]
}

/// Pieces of a front, each with the borders of its band.
fn band<'a>(pieces: impl Iterator<Item = &'a Vec<[Point2<f64>; 3]>>) -> Vec<LinePrimitive> {
    let strokes =
        [(THICK, of(FRONT)), (THIN, opaque(SHADES[4].colour)), (THIN, opaque(SHADES[4].colour))];
    let lines = pieces.flat_map(|piece| {
        strokes.into_iter().enumerate().map(|(k, (thickness, color))| {
            let way: Vec<_> = piece.iter().map(|it| it[k]).collect();
            line(&way, false, thickness, color)
        })
    });
    lines.collect()
}

/// What the robot has passed since the last place of the map, as it was known then: the map may drop it.
fn ahead(flight: &Flight, second: u32) -> SceneEntity {
    let scenes = &flight.scenes[..=second as usize];
    let last = scenes.iter().rev().find_map(|it| it.mapped.last());
    let is_whole =
        scenes.len() == flight.scenes.len() && (last.is_some() || !flight.rest.is_empty());
    let passed = if is_whole { scenes.len() } else { last.map_or(0, |it| it.passed + 1) };
    let pieces = scenes[passed.min(scenes.len())..].split(|it| it.front.is_none());
    let rungs = |piece: &[Scene]| -> Vec<_> {
        let known = piece.iter().filter_map(|it| it.front.as_ref());
        known.map(|SeenFront { at, ends: [left, right], .. }| [*at, *left, *right]).collect()
    };
    let pieces: Vec<_> = pieces.map(rungs).filter(|it| !it.is_empty()).collect();
    SceneEntity { lines: band(pieces.iter()), ..entity("front not mapped yet", second) }
}

/// What each step replaces: what is known, the front beside the robot, and the true boundary if it moves.
fn seen(flight: &Flight, scene: &Scene, second: u32) -> impl Iterator<Item = SceneEntity> {
    let now = flight.boundary.last().zip(scene.boundary.as_ref());
    let front = follows(flight).then(|| ahead(flight, second));
    let known = known(scene, second).into_iter().chain(front);
    known.chain(now.map(|(it, ways)| truth(&it.name, ways, second)))
}

/// Whether a front is followed, and found.
fn follows(flight: &Flight) -> bool {
    flight.scenes.iter().any(|it| it.front.is_some())
}

/// The true boundary.
fn truth(name: &str, ways: &[Way], second: u32) -> SceneEntity {
    let lines = ways.iter().map(|way| line(way, false, THICK, opaque(TRUTH)));
    SceneEntity { lines: lines.collect(), ..entity(name, second) }
}

/// What is known: the ground and the estimate.
fn known(scene: &Scene, second: u32) -> [SceneEntity; 2] {
    let estimate = scene.estimate.iter();
    let estimate = estimate.map(|it| line(&it.ends, false, THICK, of(ESTIMATE)));
    let ground = entity("ground", second);
    let ground = match &scene.ground {
        Ground::Labelled(regions) => {
            let labels = [Label::Positive, Label::Negative];
            let certain = labels.into_iter().zip(regions).map(|(label, ring)| {
                fan(&ring.0, Color { a: 0.25, ..opaque(style::of_label(label)) })
            });
            SceneEntity { triangles: certain.collect(), ..ground }
        }
        Ground::Credible(bands) => {
            let borders = bands.iter().flat_map(|Band { from, rings }| {
                let color = Color { a: 0.2 + 0.8 * from, ..opaque(SHADES[4].colour) };
                rings.iter().map(move |ring| line(ring, true, THIN, color))
            });
            SceneEntity { lines: borders.collect(), ..ground }
        }
        Ground::Plain => ground,
    };
    [ground, SceneEntity { lines: estimate.collect(), ..entity("estimate", second) }]
}

fn entity(id: &str, second: u32) -> SceneEntity {
    let timestamp = Some(time(second));
    SceneEntity {
        timestamp,
        frame_id: FRAME.to_owned(),
        id: id.to_owned(),
        ..SceneEntity::default()
    }
}

/// Spheres for +1, cubes for -1.
fn samples(
    id: &str,
    second: u32,
    samples: impl Iterator<Item = (Point2<f64>, i8)>,
    size: f64,
) -> SceneEntity {
    let mut entity = entity(id, second);
    for (at, label) in samples {
        let (pose, size) =
            (Some(pose(at.into(), 0.0)), Some(Vector3 { x: size, y: size, z: size }));
        let color = |label| Some(opaque(style::of_label(label)));
        match label {
            0 => {}
            1.. => {
                let color = color(Label::Positive);
                entity.spheres.push(SpherePrimitive { pose, size, color });
            }
            ..0 => {
                let color = color(Label::Negative);
                entity.cubes.push(CubePrimitive { pose, size, color });
            }
        }
    }
    entity
}

/// Viewers have a dark ground or a light one, so the true line is not black, as it is in figures.
const TRUTH: &str = "#cc79a7";

/// The colour of a stroke.
fn of(stroke: Stroke) -> Color {
    opaque(stroke.colour)
}

/// A colour as figures name it, `#rrggbb`.
fn opaque(name: &str) -> Color {
    let part = |k: usize| {
        let digits = name.get(k..k + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
        f64::from(digits.unwrap_or_default()) / 255.0
    };
    Color { r: part(1), g: part(3), b: part(5), a: 1.0 }
}

fn line(places: &[Point2<f64>], is_loop: bool, thickness: f64, color: Color) -> LinePrimitive {
    LinePrimitive {
        r#type: i32::from(is_loop),
        pose: Some(pose([0.0, 0.0], 0.0)),
        thickness,
        scale_invariant: true,
        points: places.iter().copied().map(|at| point(at.into())).collect(),
        color: Some(color),
        ..LinePrimitive::default()
    }
}

/// A convex polygon as triangles about its first corner.
fn fan(ring: &[Point2<f64>], color: Color) -> TriangleListPrimitive {
    let corners = ring.split_first().map_or(&[][..], |(_, rest)| rest).windows(2);
    let points = corners.flat_map(|pair| [ring[0], pair[0], pair[1]]);
    TriangleListPrimitive {
        pose: Some(pose([0.0, 0.0], 0.0)),
        points: points.map(|at| point(at.into())).collect(),
        color: Some(color),
        ..TriangleListPrimitive::default()
    }
}
