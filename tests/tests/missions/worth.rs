//! A label that must be expected to carry so many bits: only such are read, and a mission says when there is none.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::world::noise::limit;
use planner_core::Stage;
use tests::cases;
use tests::ensemble::{self, expect, noisy, percent};

fn fly(number: u64, p: Option<f64>, worth: f64) -> Recording {
    let mission = standard_field::standard(63, number, Algorithm::Lookahead, 40);
    let mut mission: Mission = p.map_or(mission.clone(), |p| noisy(mission, p, 0.0));
    mission.asking.worth = worth;
    mission.asking.price = (number % 2 == 1).then_some(3.0);
    Recording::of(&mission).expect("labels agree")
}

/// Where labels may be wrong, a plan predicts by a limited number of directions. So two labels in a hundred may carry less
/// than asked, by more than the rounding of a prediction.
#[test]
fn labels_carry_what_is_asked() {
    for p in [None, Some(0.9), Some(0.7)] {
        for share in [0.2, 0.6, 0.9] {
            let worth = (1e3 * share * p.map_or(1.0, limit)).round() * 1e-3;
            let bits = ensemble::fly(cases(24, 300), |number| {
                let Recording { results, steps, .. } = fly(number, p, worth);
                let asked = steps.iter().zip(&results.steps).filter(|(step, _)| {
                    step.motion.wants_label && step.motion.stage != Some(Stage::Audit)
                });
                let bits = asked.map(|(_, result)| result.expected.expect("a label").bits);
                bits.collect::<Vec<_>>()
            });
            let bits = bits.concat();
            assert!(bits.len() as u64 > 4 * cases(24, 300), "{p:?}, {worth}: {}", bits.len());
            let short = percent(&bits, |it| *it < worth - 0.03);
            let most = if p.is_some() { 2.0 } else { 0.0 };
            expect(format!("p = {p:?}, short of {worth}"), short, ..=most);
        }
    }
}

/// Where nothing is worth asking, a mission ends after sixteen motions and says so.
#[test]
fn it_ends_where_no_label_carries_what_is_asked() {
    let reasons = ensemble::fly(cases(24, 300), |it| fly(it, Some(0.9), 0.5309).results.end.reason);
    assert!(reasons.iter().all(|it| ["worth", "steps"].contains(&&**it)));
    expect("ended", percent(&reasons, |it| it == "worth"), 50.0..);
}

/// A worth that every label has changes nothing.
#[test]
fn no_worth_changes_nothing() {
    for number in 0..8 {
        let [as_ever, asked] = [0.0, 1e-3].map(|worth| {
            let steps = fly(number, Some(0.8), worth).steps;
            steps.iter().map(|step| (step.pose, step.reading)).collect::<Vec<_>>()
        });
        assert!(as_ever == asked, "{number}");
    }
}
