//! Missions in which everything is drawn at random keep what every mission must keep.

use std::collections::BTreeMap;

use rayon::prelude::*;
use tests::anything::draw::draw;
use tests::anything::flight::{Finding, fly};
use tests::cases;

const SEED: u64 = 21;

/// What a plan may ask of its area, in corners of keep-outs; some 100 instructions each.
const MOST_ASKED: u64 = 1_500_000;

#[test]
fn random_missions_keep_every_invariant() {
    let from: u64 = std::env::var("FROM").map_or(0, |it| it.parse().expect("a number"));
    let count: u64 = std::env::var("COUNT").map_or(cases(400, 20_000), |it| it.parse().expect("a number"));
    let flights: Vec<_> = (from..from + count)
        .into_par_iter()
        .map(|number| {
            let mission = draw(SEED, number);
            let flight = std::panic::catch_unwind(|| fly(&mission, MOST_ASKED));
            (number, mission, flight.unwrap_or_else(|_| panic!("mission {number} panics")))
        })
        .collect();
    let (mut found, mut endings) = (BTreeMap::<Finding, u32>::new(), BTreeMap::new());
    let mut worst = (0, 0);
    for (number, mission, flight) in &flights {
        for (finding, text) in &flight.findings {
            *found.entry(*finding).or_default() += 1;
            let kind = format!("{:?}", mission.vehicle);
            let kind = kind.split('(').next().unwrap_or_default();
            println!("{number} {finding:?} {kind} {:?} tol {} errs {}: {text}", mission.algorithm,
                mission.config.tolerance.metres(), mission.errors.position > 0.0 || mission.errors.motion > 0.0);
        }
        let kind = format!("{:?}", mission.vehicle);
        let kind = kind.split('(').next().unwrap_or_default().to_owned();
        *endings.entry((kind, format!("{:?}", flight.ending))).or_insert(0) += 1;
        worst = worst.max((flight.asked, *number));
    }
    for (ending, count) in endings {
        println!("{ending:?}: {count}");
    }
    let motions: u32 = flights.iter().map(|(.., flight)| flight.motions).sum();
    let labels: u32 = flights.iter().map(|(.., flight)| flight.labels).sum();
    println!("{motions} motions, {labels} labels, {} asked at most by mission {}", worst.0, worst.1);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn one() {
    let Ok(number) = std::env::var("ONE") else { return };
    let mission = draw(SEED, number.parse().expect("a number"));
    let vehicle = planner_core::motion::any_vehicle::Shape::from(mission.vehicle);
    println!("{:?} {vehicle:?}\n{:?}\n{:?} {:?} {:?} {:?}", mission.algorithm,
        tests::anything::plain::Ground::of(&mission.config.area), mission.config.tolerance.metres(), mission.noise, mission.errors, mission.goal);
    let flight = fly(&mission, MOST_ASKED);
    println!("{:?} {} motions {} labels", flight.ending, flight.motions, flight.labels);
    for finding in flight.findings { println!("{finding:?}"); }
}
