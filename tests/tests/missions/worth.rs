//! A label that must be expected to carry so many bits: only such are read, and a mission says when there is none.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::world::noise::{Extent, NoiseModel, limit};
use planner_core::Stage;
use rayon::prelude::*;
use tests::cases;

/// Bits by which a plan's prediction differs from the exact one: it is in single precision.
const OFF: f64 = 0.03;

/// Where labels may be wrong, a plan also predicts by a limited number of directions. So many labels in a hundred may carry
/// less than asked by more than [`OFF`].
const SHORT: usize = 2;

fn mission(number: u64, p: Option<f64>, worth: f64) -> Mission {
    let mut mission = standard_field::standard(63, number, Algorithm::Lookahead, 40);
    mission.noise = p.map(|p| NoiseModel { p, extent: Extent::OutsideBalls(0.0) });
    mission.asking.worth = worth;
    mission.asking.price = (number % 2 == 1).then_some(3.0);
    mission
}

/// Labels that were read, how many of them were expected to carry far less than asked, and why the mission ended.
fn fly(mission: &Mission) -> (usize, usize, String) {
    let Recording { results, steps, .. } = Recording::of(mission).expect("labels agree");
    let asked = || steps.iter().zip(&results.steps).filter(|(step, _)| step.motion.wants_label);
    let of_plan = asked().filter(|(step, _)| step.motion.stage != Some(Stage::Audit));
    let bits = of_plan.map(|(_, result)| result.expected.expect("a label is asked for").bits);
    let short = bits.filter(|bits| *bits < mission.asking.worth - OFF).count();
    (asked().count(), short, results.end.reason.to_string())
}

#[test]
fn labels_carry_what_is_asked() {
    for p in [None, Some(0.9), Some(0.7)] {
        let most = p.map_or(1.0, limit);
        for share in [0.2, 0.6, 0.9] {
            let worth = (1e3 * share * most).round() * 1e-3;
            let flown = (0..cases(24, 300)).into_par_iter().map(|number| {
                let (labels, short, _) = fly(&mission(number, p, worth));
                (labels, short)
            });
            let of =
                |one: (usize, usize), other: (usize, usize)| (one.0 + other.0, one.1 + other.1);
            let (labels, short) = flown.reduce(|| (0, 0), of);
            println!("{p:?}, {worth}: {short} of {labels} labels fall short");
            assert!(labels as u64 > 4 * cases(24, 300), "{p:?}, {worth}: {labels} labels");
            let most = if p.is_some() { SHORT * labels / 100 } else { 0 };
            assert!(short <= most, "{p:?}, {worth}: {short} of {labels}");
        }
    }
}

/// Where nothing is worth asking, a mission ends after sixteen motions and says so.
#[test]
fn it_ends_where_no_label_carries_what_is_asked() {
    let flown = (0..cases(24, 300)).into_par_iter().map(|number| {
        let (_, _, reason) = fly(&mission(number, Some(0.9), 0.5309));
        assert!(["worth", "steps"].contains(&&*reason), "{number}: {reason}");
        reason == "worth"
    });
    let ended = flown.filter(|it| *it).count() as u64;
    assert!(2 * ended > cases(24, 300), "{ended}");
}

/// A mission without a least worth is the same as ever.
#[test]
fn no_worth_changes_nothing() {
    for number in 0..8 {
        let [as_ever, asked] = [0.0, 1e-3].map(|worth| {
            let steps =
                Recording::of(&mission(number, Some(0.8), worth)).expect("labels agree").steps;
            steps.iter().map(|step| (step.pose, step.reading)).collect::<Vec<_>>()
        });
        assert!(as_ever == asked, "{number}");
    }
}
