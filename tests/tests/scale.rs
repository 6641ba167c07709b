//! Look-ahead at any scale: what its labels tell, by the area's size, the reach and the vehicle.

use std::collections::BTreeMap;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::world::World;
use nalgebra::{Point2, Vector2};
use planner_core::belief::sample::Sample;
use planner_core::belief::version_space::VersionSpace;
use planner_core::geometry::area::Area;
use planner_core::geometry::lattice::Site;
use planner_core::geometry::line::Line;
use planner_core::motion::action::ActionGrid;
use planner_core::motion::any_vehicle::AnyVehicle;
use planner_core::motion::boat::Boat;
use planner_core::motion::car::{self, Car};
use planner_core::motion::dynamics::Pose;
use planner_core::motion::unicycle::Unicycle;
use rayon::prelude::*;
use tests::cases;

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
    mission.given = VersionSpace::new(&given).expect("as before");
    mission.start = Pose { site: at(mission.start.site), ..mission.start };
    let [a, b, c] = mission.world.line().expect("a line").coefficients();
    let normal = Vector2::new(a, b);
    let foot = Point2::from(normal * (-c * factor / normal.norm_squared()));
    mission.world = World::divided_by(Line::through(foot, normal).expect("a line"));
    mission
}

fn vehicle(kind: &str, reach_mm: f64) -> AnyVehicle {
    let speeds = if reach_mm < 2e5 { 21_u16 } else { 101 };
    let step = (reach_mm / f64::from(speeds - 1)) as u32;
    let steps = |sharpest: f64| Unicycle::new(1, sharpest, speeds, step).expect("a grid");
    match kind {
        "unicycle" => AnyVehicle::Unicycle(steps(1.570_796_3)),
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

#[test]
fn more_reach_never_hurts() {
    let fields: u64 = std::env::var("FIELDS").map_or(cases(40, 400), |it| it.parse().expect("a number"));
    let steps = 20;
    for kind in ["unicycle", "boat", "car"] {
        for side in [5.0, 20.0, 800.0, 4_000.0] {
            let mut row = String::new();
            for percent in [2.0, 5.0, 10.0, 15.0, 20.0, 50.0, 100.0] {
                let reach_mm = (1e3 * side * percent / 100.0_f64).min(f64::from(ActionGrid::LONGEST_MM) - 1e3);
                let flown: Vec<_> = (0..fields)
                    .into_par_iter()
                    .map(|number| {
                        let mut mission = scaled(number, side / standard_field::SIDE_M);
                        mission.vehicle = vehicle(kind, reach_mm);
                        if mission.config.admits(&mission.vehicle).is_err() {
                            return None;
                        }
                        let (mut labels, mut motions, mut bits, mut error) = (0, 0, 0.0, 90.0);
                        let truth = *mission.world.line().expect("a line");
                        let flown = mission.fly(|step, belief| {
                            labels += u32::from(step.reading.is_some());
                            motions += u32::from(labels <= steps);
                            let is_due = if kind == "unicycle" { motions == steps } else { labels == steps };
                            if is_due && bits == 0.0 {
                                bits = belief.information();
                                error = belief.estimates().centre.map_or(90.0, |it| Line::from(it).angle_to_deg(&truth));
                            }
                        });
                        let flown = flown.expect("labels are true");
                        if bits == 0.0 {
                            bits = flown.belief.information();
                            error = flown.belief.estimates().centre.map_or(90.0, |it| Line::from(it).angle_to_deg(&truth));
                        }
                        let ended = (labels < steps).then(|| format!("{:?}", flown.ending));
                        Some((bits / f64::from(steps), error, ended))
                    })
                    .flatten()
                    .collect();
                if flown.is_empty() { row += "      -       "; continue; }
                let mean = flown.iter().map(|it| it.0).sum::<f64>() / flown.len() as f64;
                let mut errors: Vec<f64> = flown.iter().map(|it| it.1).collect();
                errors.sort_by(f64::total_cmp);
                let mut ends = BTreeMap::new();
                for end in flown.iter().filter_map(|it| it.2.clone()) { *ends.entry(end).or_insert(0) += 1; }
                row += &format!(" {mean:.3} {:.4}", errors[errors.len() / 2]);
                if !ends.is_empty() { row += &format!("{ends:?}").replace("Stopped", ""); }
            }
            println!("{kind} {side}: {row}");
        }
    }
}

#[test]
fn one() {
    let Ok(one) = std::env::var("ONE") else { return };
    let mut it = one.split(' ');
    let kind = it.next().unwrap();
    let side: f64 = it.next().unwrap().parse().unwrap();
    let percent: f64 = it.next().unwrap().parse().unwrap();
    for number in 0..20 {
        let mut mission = scaled(number, side / standard_field::SIDE_M);
        mission.vehicle = vehicle(kind, 1e3 * side * percent / 100.0);
        eprintln!("=== {number}");
        let (mut n, mut l) = (0, 0);
        let flown = mission.fly(|step, _| {
            n += 1; l += u32::from(step.reading.is_some());
            eprintln!("step {n} {:?} {:?}", step.motion.recovery, step.pose);
        }).unwrap();
        eprintln!("END {:?} {l}", flown.ending);
    }
}
