//! A label that must be expected to carry so many bits. The random missions of `anything` check that others are not read.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use tests::cases;
use tests::ensemble::{self, expect, noisy, percent};

fn fly(number: u64, p: f64, worth: f64) -> Recording {
    let mission = standard_field::standard(63, number, Algorithm::Lookahead, 40);
    let mut mission: Mission = noisy(mission, p, 0.0);
    mission.asking.worth = worth;
    mission.asking.price = (number % 2 == 1).then_some(3.0);
    Recording::of(&mission).expect("labels agree")
}

/// Where nothing is worth asking, a mission ends after sixteen motions and says so.
#[test]
fn it_ends_where_no_label_carries_what_is_asked() {
    let reasons = ensemble::fly(cases(24, 300), |it| fly(it, 0.9, 0.5309).results.end.reason);
    assert!(reasons.iter().all(|it| ["worth", "steps"].contains(&&**it)));
    expect("ended", percent(&reasons, |it| it == "worth"), 50.0..);
}

/// A worth that every label has changes nothing.
#[test]
fn no_worth_changes_nothing() {
    for number in 0..8 {
        let [as_ever, asked] = [0.0, 1e-3].map(|worth| {
            let steps = fly(number, 0.8, worth).steps;
            steps.iter().map(|step| (step.pose, step.reading)).collect::<Vec<_>>()
        });
        assert!(as_ever == asked, "{number}");
    }
}
