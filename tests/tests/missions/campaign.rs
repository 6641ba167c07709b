//! The figures that the README quotes: 1,000 standard fields, seed 1.

use host_sim::campaign::accuracy::{Accuracy, Row, Summary};
use host_sim::campaign::ensemble::Campaign;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::names::FanName;
use planner_core::{Following, Options};
use tests::ensemble::expect;

fn campaign(algorithm: Algorithm, following: Following, steps: u32) -> Summary {
    let vehicle = FanName::Paper.into();
    let campaign = Campaign { following, vehicle, ..Campaign::of(algorithm, steps) };
    let rows = campaign.run(&Accuracy { by_label: false }).expect("there is room");
    Summary::of(&campaign, rows).expect("labels are true")
}

fn last_bits(algorithm: Algorithm, following: Following, steps: u32) -> f64 {
    campaign(algorithm, following, steps).rows.last().expect("a mark").bits_per_step
}

#[test]
fn algorithm_1_learns_what_it_should() {
    let summary = campaign(Algorithm::Cfc, Options::CFC.following, 40);
    let at = |step| summary.rows.iter().find(|row| row.step == step).expect("a mark");
    expect("bits a step, 10", at(10).bits_per_step, 0.65..);
    expect("degrees, 10", at(10).centre_deg.median, ..=1.5);
    expect("degrees, 20", at(20).centre_deg.median, ..=0.20);
    expect("actions looked at", summary.mean_examined, ..=0.05 * summary.actions as f64);
    // A noiseless label tells one bit at most, on average.
    assert!(summary.rows.iter().all(|row| row.bits_per_step <= 1.0));
    let random = last_bits(Algorithm::Random, Options::CFC.following, 20);
    expect("beside a random walk", at(20).bits_per_step / random, 4.0..);
    let printed = last_bits(Algorithm::Cfc, Following::Unrestricted, 10);
    expect("P2 as printed", printed, 0.54..0.58);
    // The misclassified area falls until the grid can hit nothing more.
    for estimate in [
        |row: &Row| row.centre_misclassified.median,
        |row: &Row| row.maximum_margin_misclassified.median,
    ] {
        let medians: Vec<_> = summary.rows.iter().map(estimate).collect();
        assert!(medians.is_sorted_by(|before, after| before > after), "{medians:?}");
        assert!(medians.last() < Some(&1e-4), "{medians:?}");
    }
    assert_eq!(summary.ends.values().sum::<u64>(), summary.fields);
    assert!(summary.ends.keys().all(|reason| ["steps", "resolution"].contains(&&**reason)));
}
