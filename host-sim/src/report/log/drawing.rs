//! The drawing of a mission for a viewer: the area and the true line once, then what each step adds or replaces.

use foxglove::messages::{
    Color, CubePrimitive, LinePrimitive, SceneEntity, SceneUpdate, SpherePrimitive,
    TriangleListPrimitive, Vector3,
};
use planner_core::Label;

use crate::report::log::messages::{FRAME, ROBOT, point, pose, time};
use crate::report::page::scene::{BandRecord, Flight, GroundRecord, Mark, Place, Scene, SeenFront};
use crate::report::picture::Kind;
use crate::report::style;

/// Pixels.
const THIN: f64 = 1.0;
const THICK: f64 = 3.0;

/// A sample's size as a share of the area's.
const SAMPLE: f64 = 0.012;

/// The start: all that stands still, and every name under which a step draws. Rerun shows an error for a name that
/// first appears later.
pub(super) fn begin(flight: &Flight) -> SceneUpdate {
    let size = SAMPLE * flight.size();
    let border = line(&flight.area, true, THIN, opaque(style::PATH.colour));
    let keep_outs = flight.keep_outs.iter().map(|ring| fan(ring, opaque(KEEP_OUT)));
    let mut entities = vec![
        SceneEntity { lines: vec![border], triangles: keep_outs.collect(), ..entity("area", 0) },
        entity("path", 0),
        entity("samples", 0),
        samples(
            "given",
            0,
            flight.given.iter().map(|Mark { at, label }| (*at, *label)),
            1.5 * size,
        ),
    ];
    if let Some(truth) = &flight.truth {
        let line = line(&truth.ends, false, THICK, opaque(TRUTH));
        entities.push(SceneEntity { lines: vec![line], ..entity("true line", 0) });
    }
    for it in &flight.boundary {
        let lines = it.ways.iter().map(|way| line(way, false, THICK, opaque(TRUTH)));
        entities.push(SceneEntity { lines: lines.collect(), ..entity(it.name, 0) });
    }
    if flight.scenes.iter().any(|it| it.front.is_some()) {
        entities.push(entity("front", 0));
    }
    if let Some(scene) = flight.scenes.first() {
        entities.extend(known(scene, 0));
    }
    SceneUpdate { entities, ..SceneUpdate::default() }
}

/// The robot: a triangle that points ahead, in the robot's own frame.
pub(super) fn robot(flight: &Flight) -> SceneEntity {
    let size = SAMPLE * flight.size();
    let corners = [[1.5 * size, 0.0], [-size, size], [-size, -size]];
    let border = line(&corners, true, THICK, opaque(style::PATH.colour));
    SceneEntity { lines: vec![border], frame_id: ROBOT.to_owned(), ..entity("robot", 0) }
}

/// What each step adds.
pub(super) fn steps(flight: &Flight) -> impl Iterator<Item = SceneUpdate> {
    let size = SAMPLE * flight.size();
    let mut path: Vec<Place> = flight.scenes.iter().take(1).map(|scene| scene.at).collect();
    let mut read = Vec::new();
    let mut pieces: Vec<Vec<[Place; 3]>> = Vec::new();
    let mut was_found = false;
    (1..).zip(flight.scenes.iter().skip(1)).map(move |(second, scene)| {
        if let Some(moved) = &scene.motion {
            path.extend(&moved.way);
            read.extend(moved.label.map(|label| (scene.at, label)));
        }
        let way = line(&path, false, THIN, opaque(style::PATH.colour));
        let mut entities = vec![
            SceneEntity { lines: vec![way], ..entity("path", second) },
            samples("samples", second, read.iter().copied(), size),
        ];
        if let Some(SeenFront { at, ends: [left, right], .. }) = &scene.front {
            if !was_found {
                pieces.push(Vec::new());
            }
            pieces.last_mut().expect("it was begun").push([*at, *left, *right]);
        }
        was_found = scene.front.is_some();
        if flight.scenes.iter().any(|it| it.front.is_some()) {
            entities.push(front(&pieces, second));
        }
        entities.extend(known(scene, second));
        SceneUpdate { entities, ..SceneUpdate::default() }
    })
}

/// The map of a front: each piece with the borders of its 90 % band.
fn front(pieces: &[Vec<[Place; 3]>], second: u32) -> SceneEntity {
    let colour = style::FRONT.colour;
    let strokes = [(THICK, opaque(colour)), (THIN, opaque(SHADE)), (THIN, opaque(SHADE))];
    let lines = pieces.iter().flat_map(|piece| {
        strokes.into_iter().enumerate().map(|(k, (thickness, color))| {
            let way: Vec<_> = piece.iter().map(|rung| rung[k]).collect();
            line(&way, false, thickness, color)
        })
    });
    SceneEntity { lines: lines.collect(), ..entity("front", second) }
}

/// What is known: the ground and the estimate.
fn known(scene: &Scene, second: u32) -> [SceneEntity; 2] {
    let estimate = scene.estimate.iter();
    let estimate = estimate
        .map(|it| line(&it.ends, false, THICK, opaque(style::of_line(Kind::Estimate).colour)));
    let ground = entity("ground", second);
    let ground = match &scene.ground {
        GroundRecord::Certain(regions) => {
            let labels = [Label::Positive, Label::Negative];
            let certain = labels.into_iter().zip(regions).map(|(label, ring)| {
                fan(ring, Color { a: 0.25, ..opaque(style::of_label(label)) })
            });
            SceneEntity { triangles: certain.collect(), ..ground }
        }
        GroundRecord::Bands(bands) => {
            let borders = bands.iter().flat_map(|BandRecord { from, rings }| {
                let color = Color { a: 0.2 + 0.8 * from, ..opaque(SHADE) };
                rings.iter().map(move |ring| {
                    let places: Vec<_> = ring.chunks_exact(2).map(|at| [at[0], at[1]]).collect();
                    line(&places, true, THIN, color)
                })
            });
            SceneEntity { lines: borders.collect(), ..ground }
        }
        GroundRecord::Plain => ground,
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
    samples: impl Iterator<Item = (Place, i8)>,
    size: f64,
) -> SceneEntity {
    let mut entity = entity(id, second);
    for (at, label) in samples {
        let (pose, size) = (Some(pose(at, 0.0)), Some(Vector3 { x: size, y: size, z: size }));
        let color = |label| Some(opaque(style::of_label(label)));
        match label {
            1.. => {
                let color = color(Label::Positive);
                entity.spheres.push(SpherePrimitive { pose, size, color });
            }
            ..0 => {
                let color = color(Label::Negative);
                entity.cubes.push(CubePrimitive { pose, size, color });
            }
            0 => {}
        }
    }
    entity
}

const KEEP_OUT: &str = "#c9c9c9";
const SHADE: &str = "#8653a6";
/// Viewers have a dark ground or a light one, so the true line is not black, as it is in figures.
const TRUTH: &str = "#cc79a7";

/// A colour as figures name it, `#rrggbb`.
fn opaque(name: &str) -> Color {
    let part = |k: usize| {
        let digits = name.get(k..k + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
        f64::from(digits.unwrap_or_default()) / 255.0
    };
    Color { r: part(1), g: part(3), b: part(5), a: 1.0 }
}

fn line(places: &[Place], is_loop: bool, thickness: f64, color: Color) -> LinePrimitive {
    LinePrimitive {
        r#type: i32::from(is_loop),
        pose: Some(pose([0.0, 0.0], 0.0)),
        thickness,
        scale_invariant: true,
        points: places.iter().copied().map(point).collect(),
        color: Some(color),
        ..LinePrimitive::default()
    }
}

/// A convex polygon as triangles about its first corner.
fn fan(ring: &[Place], color: Color) -> TriangleListPrimitive {
    let corners = ring.split_first().map_or(&[][..], |(_, rest)| rest).windows(2);
    let points = corners.flat_map(|pair| [ring[0], pair[0], pair[1]]);
    TriangleListPrimitive {
        pose: Some(pose([0.0, 0.0], 0.0)),
        points: points.map(point).collect(),
        color: Some(color),
        ..TriangleListPrimitive::default()
    }
}
