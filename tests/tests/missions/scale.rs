//! Look-ahead at any scale: what its labels tell, by the area's size, the reach and the vehicle.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::read_out::ReadOut;
use host_sim::world::World;
use nalgebra::{Point2, Vector2};
use planner_core::dynamics::ActionGrid;
use planner_core::motion::car::{self};
use planner_core::{
    AnyVehicle, Area, Boat, Car, Line, Pose, Sample, Site, Unicycle, VersionSpace, aimed_for,
};
use rayon::prelude::*;
use tests::{cases, is_long};

/// A standard field, blown up by a factor.
fn scaled(number: u64, factor: f64) -> Mission {
    let mut mission = standard_field::standard(41, number, Algorithm::Lookahead, 400);
    let at = |site: Site| {
        let p = Point2::<f64>::from(site);
        Site::try_from(p * factor).expect("within the lattice")
    };
    let side = standard_field::SIDE_M * factor;
    let area = Area::new(at(Site::ORIGIN), Site::try_from(Point2::new(side, side)).expect("near"));
    mission.config.area = area.expect("an area").into();
    let given: Vec<Sample> = mission
        .given
        .samples()
        .iter()
        .map(|sample| Sample { site: at(sample.site), label: sample.label })
        .collect();
    mission.given = VersionSpace::new(&given).expect("as before").into();
    mission.start = Pose { site: at(mission.start.site), ..mission.start };
    let [a, b, c] = mission.world.line().expect("a line").coefficients();
    let normal = Vector2::new(a, b);
    let foot = Point2::from(normal * (-c * factor / normal.norm_squared()));
    mission.world = World::divided_by(Line::through(foot, normal).expect("a line"));
    mission
}

fn vehicle(kind: &str, reach_mm: f64) -> AnyVehicle {
    let speeds = 101_u16;
    let step = (reach_mm / f64::from(speeds - 1)) as u32;
    let steps = |sharpest: f64| Unicycle::new(1, sharpest, speeds, step).expect("a grid");
    match kind {
        "unicycle" => AnyVehicle::Unicycle(steps(FRAC_PI_2)),
        "boat" => AnyVehicle::Boat(Boat::new(steps(0.35)).expect("a boat")),
        _ => AnyVehicle::Car(
            Car::new(car::Shape {
                radius_mm: (reach_mm / 2.0) as u32,
                shortest_mm: step,
                turn_step_urad: 1,
                speeds,
                speed_step_mm: step,
            })
            .expect("a car"),
        ),
    }
}

/// Labels of a mission, and for a vehicle that turns on the spot its motions.
const STEPS: u32 = 20;

/// How missions of a vehicle went.
struct Taught {
    /// Bits told by a step, on average.
    bits: f64,
    /// The median of the slope error of the centre, degrees.
    degrees: f64,
    /// Why missions ended before.
    early: BTreeMap<String, u32>,
}

fn teach(kind: &str, side: f64, reach_mm: f64, fields: u64) -> Option<Taught> {
    let fly = |number| {
        let mut mission = scaled(number, side / standard_field::SIDE_M);
        mission.vehicle = vehicle(kind, reach_mm);
        aimed_for(mission.config.area, &mission.vehicle, mission.config.tolerance).ok()?;
        let truth = *mission.world.line().expect("a line");
        let read_out = |belief: &dyn ReadOut| {
            let centre = belief.estimates().centre.expect("a line");
            (belief.information(), Line::from(centre).angle_to_deg(&truth))
        };
        let (mut labels, mut motions, mut told) = (0, 0, None);
        let flown = mission.fly(|step, belief| {
            labels += u32::from(step.reading.is_some());
            motions += 1;
            let done = if kind == "unicycle" { motions } else { labels };
            if done == STEPS && told.is_none() {
                told = Some(read_out(belief));
            }
        });
        let flown = flown.expect("labels are true");
        let early = told.is_none().then(|| format!("{:?}", flown.ending));
        let (bits, degrees) = told.unwrap_or_else(|| read_out(&*flown.belief));
        Some((bits / f64::from(STEPS), degrees, early))
    };
    let all: Option<Vec<_>> = (0..fields).into_par_iter().map(fly).collect();
    let all = all?;
    let mut degrees: Vec<f64> = all.iter().map(|(_, degrees, _)| *degrees).collect();
    degrees.sort_by(f64::total_cmp);
    let mut early = BTreeMap::new();
    for ending in all.iter().filter_map(|(.., early)| early.clone()) {
        *early.entry(ending).or_default() += 1;
    }
    let bits = all.iter().map(|(bits, ..)| bits).sum::<f64>() / all.len() as f64;
    Some(Taught { bits, degrees: degrees[degrees.len() / 2], early })
}

#[test]
fn more_reach_never_hurts() {
    let fields = cases(48, 120);
    println!(
        "bits a step of 20 (a label of boats and cars), slope error; reach in per cent of the area's side"
    );
    // Of boats and cars nothing is held but that they fly.
    let kinds = ["unicycle", "boat", "car"];
    for &kind in &kinds[..if is_long() { 3 } else { 1 }] {
        for side in [5.0, 20.0, 800.0, 4_000.0] {
            for percent in [2.0_f64, 5.0, 10.0, 15.0, 20.0, 50.0, 100.0] {
                let reach_mm = (10.0 * side * percent).min(f64::from(ActionGrid::LONGEST_MM) - 1e3);
                let Some(Taught { bits, degrees, early }) = teach(kind, side, reach_mm, fields)
                else {
                    println!("{kind}, {side} m, {percent} %: its circle has no room");
                    continue;
                };
                println!(
                    "{kind}, {side} m, {percent} %: {bits:.3}, {degrees:.4} deg; early {early:?}"
                );
                let least = match (kind, percent) {
                    ("unicycle", 2.0) => 0.69,
                    ("unicycle", 5.0) => 0.87,
                    ("unicycle", _) => 0.965,
                    _ => 0.0,
                };
                assert!(bits >= least, "{kind}, {side} m, {percent} %: {bits}");
                assert!(kind != "unicycle" || early.is_empty(), "{side} m, {percent} %: {early:?}");
            }
        }
    }
}
