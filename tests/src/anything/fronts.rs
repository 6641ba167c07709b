//! Missions along fronts in which everything is drawn at random: the front, what is told of it, what is given.

use std::f64::consts::TAU;

use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::asking::Asking;
use host_sim::mission::bounds::Bounds;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::Given;
use host_sim::world::World;
use host_sim::world::boundary::{CoastRecord, Curve};
use host_sim::world::circle::Circle;
use host_sim::world::polygon::Polygon;
use host_sim::world::polyline::Polyline;
use host_sim::world::sine::Sine;
use nalgebra::{Point2, Vector2};
use planner_core::{
    AnyReliability, Front, Line, Reading, Sample, Seeking, UnknownReliability, Workspace as _,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::draw::{draw, scale};
use crate::ensemble;

/// The mission with this number. Area, vehicle, start, tolerance and errors are those of a random mission.
///
/// # Panics
/// Never: what it draws is in range.
pub fn draw_front(seed: u64, number: u64) -> Mission {
    let mission = draw(seed, number);
    let rng = &mut ensemble::rng(seed ^ 0x00f2_0713, number);
    let area = mission.config.area;
    let bounds = area.bounds();
    let [min, max] = [bounds.min(), bounds.max()].map(Point2::<f64>::from);
    let side = (max - min).amax();
    let curve = curve(rng, [min, max], side);
    let drift = if rng.random() { 0.0 } else { side * scale(rng, 1e-5, 0.02) };
    let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
    let drift = Vector2::new(cos, sin) * drift;
    let world = World::divided_by_moving_curve(curve, &Polygon::from(area), drift);
    let most = rng.random_range(0..=mission.given.samples().len());
    let given = mission.given.samples().iter().take(most).filter(|it| area.contains(it.site));
    let given = given.filter_map(|it| match world.reading(it.site) {
        Reading::Side(label) => Some(Sample { site: it.site, label }),
        Reading::Boundary => None,
    });
    let given = Given::of_front(given.collect());
    let told = match rng.random_range(0..5) {
        0 => Front::STRAIGHT,
        _ => Front::bending((side * scale(rng, 0.01, 5.0)).max(0.1)).expect("a radius"),
    };
    let speed = if rng.random() { 0.0 } else { side * scale(rng, 1e-5, 0.02) };
    let p_told = (mission.noise.is_some() && rng.random_range(0..4) == 0).then(|| {
        let prior = UnknownReliability::beta(8.0, 2.0).expect("a prior");
        AnyReliability::Unknown(prior)
    });
    // Some watch a stretch. The other draws stay as they are.
    let share = [0.02, 0.1, 0.5][(number / 4 % 3) as usize];
    let watch = number.is_multiple_of(4).then(|| (share * side).max(0.1));
    Mission {
        algorithm: Algorithm::Track,
        world,
        given,
        front: told.moving(speed).expect("a speed"),
        watch,
        seeking: Seeking::USUAL.several(1 + (number % 3) as u8).expect("few"),
        until_closed: rng.random(),
        p_told,
        goal: None,
        asking: Asking::USUAL,
        bounds: Bounds::default(),
        readings: if rng.random_range(0..4) == 0 { rng.random_range(2..=20) } else { 1 },
        ..mission
    }
}

fn curve(rng: &mut ChaCha8Rng, [min, max]: [Point2<f64>; 2], side: f64) -> Box<dyn Curve> {
    let anywhere = Point2::new(rng.random_range(min.x..max.x), rng.random_range(min.y..max.y));
    let phase = rng.random_range(0.0..TAU);
    match rng.random_range(0..4) {
        0 => Box::new(Circle { middle: anywhere, radius: side * scale(rng, 0.02, 2.0) }),
        1 => {
            let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
            let base = Line::through(anywhere, Vector2::new(cos, sin)).expect("a direction");
            let length = side * scale(rng, 0.05, 2.0);
            Box::new(Sine { base, height: length * rng.random_range(0.0..0.3), length, phase })
        }
        2 => {
            let length = side * scale(rng, 0.02, 1.0);
            let height = length * rng.random_range(0.01..0.5);
            let record = CoastRecord { height, length, seed: rng.random() };
            Box::new(Polyline::coast(record, anywhere, 2.0 * side).expect("a coast"))
        }
        // Nowhere, or all over: one label alone.
        _ => {
            let far = anywhere + Vector2::new(4.0, 4.0) * side;
            Box::new(Circle { middle: far, radius: side * [0.5, 9.0][rng.random_range(0..2)] })
        }
    }
}
