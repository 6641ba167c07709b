//! The figures that the README quotes: 1,000 standard fields, seed 1.

use host_sim::campaign::accuracy::{Accuracy, Row, Summary};
use host_sim::campaign::ensemble::Campaign;
use host_sim::mission::algorithm::Algorithm;
use host_sim::report::campaign as tables;
use host_sim::world::errors::Errors;
use planner_core::motion::unicycle::Grid;
use planner_core::{Crossing, Following, Options, Policy, Prior, Tolerance};

fn campaign(algorithm: Algorithm, following: Following, steps: u32) -> Summary {
    let campaign = Campaign {
        algorithm,
        fields: 1000,
        steps,
        readings: 1,
        every: false,
        seed: 1,
        crossing: Crossing::default(),
        following,
        vehicle: Grid::Paper.into(),
        noise: None,
        p_told: None,
        draws_p: false,
        errors: Errors::default(),
        tolerance: Tolerance::NONE,
        policy: Policy::default(),
        prior: Prior::default(),
    };
    let rows = campaign.run(&Accuracy).expect("there is room");
    let summary = Summary::of(&campaign, rows).expect("labels are true");
    println!("{}", tables::accuracy(&summary));
    summary
}

#[test]
fn algorithm_1_learns_what_it_should() {
    let summary = campaign(Algorithm::Cfc, Options::CFC.following, 20);
    let at = |step| summary.rows.iter().find(|row| row.step == step).expect("a mark");
    assert!(at(10).bits_per_step >= 0.65);
    assert!(at(10).centre_deg.median <= 1.5);
    assert!(at(20).centre_deg.median <= 0.20);
    assert!(summary.mean_examined <= 0.05 * summary.actions as f64);
    // A noiseless label tells one bit at most, on average.
    assert!(summary.rows.iter().all(|row| row.bits_per_step <= 1.0));
    let random = campaign(Algorithm::Random, Options::CFC.following, 20);
    let last = |summary: &Summary| summary.rows.last().expect("a mark").bits_per_step;
    assert!(last(&summary) > 4.0 * last(&random));
}

#[test]
fn p2_as_printed_learns_less() {
    let printed = campaign(Algorithm::Cfc, Following::Unrestricted, 10);
    let bits = printed.rows.last().expect("a mark").bits_per_step;
    assert!((0.54..0.58).contains(&bits), "{bits}");
}

#[test]
fn the_misclassified_area_falls_until_the_grid_can_hit_nothing_more() {
    let summary = campaign(Algorithm::Cfc, Options::CFC.following, 40);
    for estimate in [
        |row: &Row| row.centre_misclassified.median,
        |row: &Row| row.maximum_margin_misclassified.median,
    ] {
        let medians: Vec<_> = summary.rows.iter().map(estimate).collect();
        assert!(medians.is_sorted_by(|before, after| before > after), "{medians:?}");
        assert!(medians.last() < Some(&1e-4), "{medians:?}");
    }
    let ended: u64 = summary.ends.values().sum();
    assert_eq!(ended, summary.fields);
    assert!(summary.ends.keys().all(|reason| ["steps", "resolution"].contains(&&**reason)));
}
