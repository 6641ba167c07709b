//! Robots whose positions err: what a version space keeps, how missions end, and what they find out.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::results::Ending;
use host_sim::world::errors::{CUT, Errors};
use planner_core::belief::tolerance::Tolerance;
use rayon::prelude::*;
use tests::cases;

/// A mission in a standard field with a robot that errs, and a planner that is told by how much.
fn erring(number: u64, algorithm: Algorithm, errors: Errors) -> Mission {
    let mut mission = standard_field::standard(12, number, algorithm, 20);
    mission.errors = errors;
    let tolerance = Tolerance::new(CUT * errors.position).expect("a distance");
    mission.config.tolerance = tolerance;
    mission
}

/// How missions ended that did not come to their last step, and the slope errors of all, in order, degrees.
fn fly(algorithm: Algorithm, errors: Errors, count: u64) -> (Vec<String>, Vec<f64>) {
    let each = |number| {
        let mission = erring(number, algorithm, errors);
        let flown = mission.fly(|_, _| {});
        let flown = flown.unwrap_or_else(|refused| panic!("field {number}: {refused}"));
        let space = flown.belief.version_space().expect("true labels");
        let holds = mission.world.is_among(space.lines()) == Some(true);
        assert!(holds, "field {number}: {algorithm:?} lost the truth");
        let centre = flown.belief.estimates().centre.expect("a line");
        let truth = mission.world.line().expect("a line divides it");
        let early =
            (flown.ending != Ending::Steps).then(|| format!("{number}: {:?}", flown.ending));
        (early, planner_core::geometry::line::Line::from(centre).angle_to_deg(truth))
    };
    let all: Vec<_> = (0..count).into_par_iter().map(each).collect();
    let mut degrees: Vec<f64> = all.iter().map(|(_, degrees)| *degrees).collect();
    degrees.sort_by(f64::total_cmp);
    (all.into_iter().filter_map(|(early, _)| early).collect(), degrees)
}

#[test]
fn the_truth_is_kept_and_missions_end_by_their_steps() {
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
        for position in [0.01, 0.05, 0.3] {
            let errors = Errors { position, ..Errors::default() };
            let (early, degrees) = fly(algorithm, errors, cases(200, 10_000));
            let median = degrees[degrees.len() / 2];
            println!("{algorithm:?}, {position} m: {median:.3} deg; early {early:?}");
            assert!(early.is_empty(), "{algorithm:?}, {position} m: {early:?}");
        }
    }
}

#[test]
fn motions_that_err_change_little() {
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
        for motion in [0.01, 0.05, 0.3] {
            let errors = Errors { motion, turn: 0.02, heading: 0.01, ..Errors::default() };
            let (early, degrees) = fly(algorithm, errors, cases(100, 1_000));
            println!(
                "{algorithm:?}, {motion} m: {:.3} deg; early {early:?}",
                degrees[degrees.len() / 2]
            );
            assert!(early.is_empty(), "{algorithm:?}, {motion} m: {early:?}");
        }
    }
}

/// What the tolerance is for: without it true labels are refused, or cut the truth off.
#[test]
fn without_a_tolerance_the_truth_is_lost() {
    let errors = Errors { position: 0.05, ..Errors::default() };
    let lost = |number: &u64| {
        let mut mission = erring(*number, Algorithm::Cfc, errors);
        mission.config.tolerance = Tolerance::NONE;
        let Ok(flown) = mission.fly(|_, _| {}) else { return true };
        let space = flown.belief.version_space().expect("true labels");
        mission.world.is_among(space.lines()) == Some(false)
    };
    let lost = (0..100).filter(lost).count();
    assert!(lost > 20, "{lost} of 100");
}
