//! Missions in which everything is drawn at random.

use std::f64::consts::{PI, TAU};

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::CAPACITY;
use host_sim::world::World;
use host_sim::world::errors::Errors;
use host_sim::world::noise::{Extent, NoiseModel, limit};
use nalgebra::{Point2, Vector2};
use planner_core::bounds::slope_within_degrees;
use planner_core::dynamics::ActionGrid;
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::link::message::{MOST_CORNERS, MOST_KEEP_OUTS, MissionArea};
use planner_core::{
    Accuracy, Angle, AnyVehicle, Boat, Car, CarShape, Goal, Heading, Hull, KeepOut, Label, Line,
    Pose, Sample, Site, Tolerance, Unicycle, VersionSpace, Workspace as _, aimed_for,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::plain::{Ground, metres};
use crate::ensemble;
use crate::terrain::on_circle;

/// Motions of a mission at most.
pub const MOTIONS: u32 = 200;

/// The mission with this number. It depends on nothing but seed and number.
pub fn draw(seed: u64, number: u64) -> Mission {
    let mut rng = ensemble::rng(seed, number);
    loop {
        if let Some(mission) = attempt(&mut rng, seed ^ number.rotate_left(32)) {
            return mission;
        }
    }
}

/// A number between two, its logarithm uniform.
pub(super) fn scale(rng: &mut ChaCha8Rng, least: f64, most: f64) -> f64 {
    rng.random_range(least.ln()..most.ln()).exp()
}

fn site(p: Point2<f64>) -> Option<Site> {
    Site::try_from(p).ok()
}

fn attempt(rng: &mut ChaCha8Rng, seed: u64) -> Option<Mission> {
    let side = match rng.random_range(0..6) {
        0 => 5.0,
        1 => 20.0,
        2 => 800.0,
        3 => 4_000.0,
        _ => scale(rng, 5.0, 4_000.0),
    };
    let (algorithm, is_noisy) = [
        (Algorithm::Cfc, false),
        (Algorithm::Lookahead, false),
        (Algorithm::Lookahead, false),
        (Algorithm::Lookahead, true),
        (Algorithm::Scc, true),
    ][rng.random_range(0..5)];
    let tolerance = if rng.random() { 0.0 } else { side * scale(rng, 1e-5, 0.03) };
    let area = area(rng, side)?;
    let ground = Ground::of(&area);
    let tolerance_told = Tolerance::new(tolerance).ok()?;
    let inset = area.inset(tolerance_told.units())?;
    let anywhere = |rng: &mut ChaCha8Rng| {
        (0..200).find_map(|_| {
            let p = Point2::new(rng.random_range(0.0..side), rng.random_range(0.0..side));
            site(p).filter(|site| area.contains(*site))
        })
    };
    let (truth, mut given) = field(rng, side, &area)?;
    if rng.random_range(0..6) == 0 {
        let [a, b, _] = truth.coefficients();
        let degrees = (-a).atan2(b).to_degrees();
        let [before, after] = [(); 2].map(|()| scale(rng, 0.1, 60.0));
        given.extend(slope_within_degrees(&area, [degrees - before, degrees + after]).ok()?);
    }
    let lines = VersionSpace::<CAPACITY>::new(&given).ok()?;
    lines.clone().with_tolerance(tolerance_told).ok()?;
    let vehicle = vehicle(rng, side)?;
    // A quarter of the starts are as near to the border or a keep-out as is allowed.
    let start = if rng.random_range(0..4) == 0 {
        let near = tolerance.max(0.002 * side);
        (0..400).filter_map(|_| anywhere(rng)).find(|it| ground.margin(metres(*it)) < near)?
    } else {
        anywhere(rng)?
    };
    let mut mission = standard_field::standard(seed, 0, algorithm, MOTIONS);
    mission.seed = seed;
    mission.config.area = area;
    mission.config.tolerance = tolerance_told;
    mission.vehicle = vehicle;
    aimed_for(area, &vehicle, tolerance_told).ok()?;
    mission.start = Pose { site: start, heading: Heading(rng.random()) };
    (mission.world, mission.given) = (World::divided_by(truth), lines.into());
    if is_noisy {
        let p = rng.random_range(0.55..0.999);
        let radius = if rng.random() { 0.0 } else { 0.02 * side };
        mission.noise = Some(NoiseModel { p, extent: Extent::OutsideBalls(radius) });
    }
    if rng.random() {
        let position = if rng.random() { tolerance / 3.0 } else { 0.0 };
        let motion = if rng.random() { position } else { 0.0 };
        let [turn, heading] = [motion, position].map(|it| if it > 0.0 { 0.02 } else { 0.0 });
        mission.errors = Errors { motion, turn, position, heading };
    }
    if algorithm == Algorithm::Lookahead && rng.random_range(0..3) == 0 {
        let accuracy = if rng.random() {
            Accuracy::SlopeArc(Angle::from_radians(scale(rng, 1e-5, 0.3)).ok()?)
        } else {
            Accuracy::Misclassified(scale(rng, 20.0, 100_000.0) as u32)
        };
        mission.goal = Some(Goal { accuracy, level: 900_000 });
    }
    if algorithm == Algorithm::Lookahead && rng.random() {
        mission.asking.price = Some(side * scale(rng, 1e-3, 3.0));
        mission.asking.labels = rng.random::<bool>().then_some(mission.steps);
    }
    if algorithm == Algorithm::Lookahead && rng.random_range(0..4) == 0 {
        let most = mission.noise.map_or(1.0, |noise| limit(noise.p));
        mission.asking.worth = most * rng.random_range(0.0..1.0);
    }
    if algorithm == Algorithm::Lookahead && rng.random_range(0..4) == 0 {
        mission.readings = rng.random_range(2..=50);
    }
    inset.encloses(given[0].site).then_some(mission)
}

/// A rectangle or an octagon with as many keep-outs as a mission has room for.
fn area(rng: &mut ChaCha8Rng, side: f64) -> Option<MissionArea> {
    let border = if rng.random() {
        let height = side * rng.random_range(0.4..1.0);
        let corners = [(0.0, 0.0), (side, 0.0), (side, height), (0.0, height)];
        let sites: Option<Vec<Site>> =
            corners.iter().map(|(x, z)| site(Point2::new(*x, *z))).collect();
        Hull::new(&sites?).ok()?
    } else {
        let middle = [0.5 * side; 2];
        Hull::new(&on_circle(rng, middle, 0.5 * side, MOST_CORNERS)).ok()?
    };
    let mut keep_outs: Vec<KeepOut<MOST_CORNERS>> = Vec::new();
    if rng.random() {
        for _ in 0..rng.random_range(1..=MOST_KEEP_OUTS) {
            let middle = [rng.random_range(0.0..side), rng.random_range(0.0..side)];
            let size = side * scale(rng, 0.005, 0.12);
            keep_outs.push(if rng.random() {
                let radius = (size * f64::from(UNITS_PER_METRE)) as u32;
                KeepOut { hull: Hull::new(&[site(Point2::from(middle))?]).ok()?, radius }
            } else {
                let count = rng.random_range(2..=MOST_CORNERS);
                KeepOut { hull: Hull::new(&on_circle(rng, middle, size, count)).ok()?, radius: 0 }
            });
        }
    }
    MissionArea::new(border, &keep_outs).ok()
}

/// A line through the area, and four to six labelled places about it, both labels twice at least.
fn field(rng: &mut ChaCha8Rng, side: f64, area: &MissionArea) -> Option<(Line, Vec<Sample>)> {
    let point = Point2::new(0.5 * side, 0.5 * side)
        + Vector2::new(rng.random_range(-0.3..0.3), rng.random_range(-0.3..0.3)) * side;
    let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
    let line = Line::through(point, Vector2::new(cos, sin))?;
    let mut given = Vec::new();
    for wanted in [-1.0, 1.0, 1.0, -1.0] {
        let far = rng.random_range(0.005..0.2) * side;
        given.push((0..300).find_map(|_| {
            let p = Point2::new(rng.random_range(0.0..side), rng.random_range(0.0..side));
            let site = site(p).filter(|it| area.contains(*it))?;
            let distance = wanted * line.distance(Point2::from(site));
            let label = if wanted > 0.0 { Label::Positive } else { Label::Negative };
            (distance > far).then_some(Sample { site, label })
        })?);
    }
    Some((line, given))
}

fn vehicle(rng: &mut ChaCha8Rng, side: f64) -> Option<AnyVehicle> {
    let longest_mm = f64::from(ActionGrid::LONGEST_MM) - 1.0;
    let reach_mm = (1e3 * side * scale(rng, 0.02, 1.0)).min(longest_mm);
    let speeds = [2, 3, 6, 21, 41, 101][rng.random_range(0..6)];
    let speed_step_mm = (reach_mm / (f64::from(speeds) - 1.0)) as u32;
    let turn_step_urad = match rng.random_range(0..4) {
        0 => 1,
        1 => 10_000,
        2 => scale(rng, 1.0, 1e5) as u32,
        _ => scale(rng, 1e4, 7e5) as u32,
    };
    let speeds = speeds as u16;
    Some(match rng.random_range(0..3) {
        0 => {
            let sharpest = if rng.random() { PI / 2.0 } else { rng.random_range(0.05..PI) };
            let step = turn_step_urad.min((sharpest * 1e6) as u32);
            AnyVehicle::Unicycle(Unicycle::new(step, sharpest, speeds, speed_step_mm).ok()?)
        }
        1 => {
            let sharpest = rng.random_range(0.1..1.2);
            let step = turn_step_urad.min((sharpest * 1e6) as u32);
            let steps = Unicycle::new(step, sharpest, speeds, speed_step_mm).ok()?;
            AnyVehicle::Boat(Boat::new(steps).ok()?)
        }
        _ => {
            let radius_mm = (reach_mm * scale(rng, 0.1, 3.0)) as u32;
            let shortest_mm = speed_step_mm * rng.random_range(1..=3);
            let shape = CarShape { radius_mm, shortest_mm, turn_step_urad, speeds, speed_step_mm };
            AnyVehicle::Car(Car::new(shape).ok()?)
        }
    })
}
