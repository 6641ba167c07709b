//! Whole missions over the standard fields, and traces that come out the same again.

use std::path::Path;

use host_sim::field;
use host_sim::mission::{Algorithm, Known};
use host_sim::recording::Recording;
use host_sim::scenario::{self, Overrides};
use host_sim::{trace, world};
use nalgebra::Point2;
use planner_core::candidates::Certainty;
use planner_core::lattice::Site;
use planner_core::sample::Reading;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

#[test]
fn ten_thousand_fields_never_contradict_themselves_or_the_truth() {
    let certain: u64 = (0..10_000u64)
        .into_par_iter()
        .map(|number| {
            let mission = field::standard(2, number, Algorithm::Cfc, 40);
            let mut rng = ChaCha8Rng::seed_from_u64(number);
            let truth = mission.truth;
            let mut certain = 0;
            let end = mission.run(|step, known| {
                let Known::Lines(space) = known else { return };
                let place = format!("field {number} at {:?}", step.pose);
                assert!(mission.config.area.contains(step.pose.site), "{place}: outside the area");
                // What is certain is true.
                for _ in 0..4 {
                    let mut metres = || rng.random_range(0.0..field::SIDE_M);
                    let q = Site::try_from(Point2::new(metres(), metres())).expect("near");
                    if let Certainty::Certain(label) = space.certainty(q) {
                        let reading = world::reading(&truth, q);
                        assert_eq!(reading, Reading::Side(label), "{place}: certain of {q:?}");
                        certain += 1;
                    }
                }
                // The truth is among the candidates: its slope and its intercept.
                let angle = truth.angle_deg();
                let arcs = space.slope_arc().intervals_deg();
                let inside = |[from, to]: &[f64; 2]| from - 1e-9 <= angle && angle <= to + 1e-9;
                assert!(arcs.iter().any(inside), "{place}: {angle} not in {arcs:?}");
                if let Some([low, high]) = space.intercepts() {
                    let c = truth.intercept().expect("no vertical line is left");
                    let slack = 1e-9 * (1.0 + c.abs());
                    assert!(low - slack <= c && c <= high + slack, "{place}: {c}");
                }
                // So no label can contradict it.
                for sample in space.samples() {
                    assert_eq!(world::reading(&truth, sample.site), Reading::Side(sample.label));
                }
            });
            assert!(end.is_ok(), "field {number}: {end:?}");
            certain
        })
        .sum();
    println!("10,000 fields of 40 steps; {certain} certain positions, all of them true");
    assert!(certain > 1_000_000);
}

#[test]
fn a_mission_comes_out_the_same_again_byte_for_byte() {
    for algorithm in [Algorithm::Cfc, Algorithm::Random] {
        for number in 0..50 {
            let trace = || {
                let mission = field::standard(3, number, algorithm, 40);
                trace::lines(&Recording::of(&mission).expect("noiseless"))
            };
            assert_eq!(trace(), trace(), "field {number}");
        }
    }
}

#[test]
fn a_seed_changes_the_random_walk_and_nothing_else() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenarios");
    let run = |algorithm, seed| {
        let overrides = Overrides { algorithm: Some(algorithm), steps: None, seed: Some(seed) };
        let mission = scenario::read(&folder.join("paper-noiseless.toml"), overrides);
        let recording = Recording::of(&mission.expect("a good file")).expect("noiseless");
        recording.steps.iter().map(|s| s.step.pose).collect::<Vec<_>>()
    };
    assert_eq!(run(Algorithm::Cfc, 1), run(Algorithm::Cfc, 2));
    assert_ne!(run(Algorithm::Random, 1), run(Algorithm::Random, 2));
}
