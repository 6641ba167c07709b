//! Stated probabilities where nobody knows how often labels are true, over many fields.

use host_sim::campaign::calibration::{Calibrated, Row, Summary};
use host_sim::campaign::ensemble::Campaign;
use host_sim::mission::algorithm::Algorithm;
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::{AnyReliability, Reliability, UnknownReliability};
use tests::cases;
use tests::ensemble::expect;

const LABELS: u32 = 30;

/// The ensemble after 30 labels, by a planner that is told a number or Beta(8, 2). Without a real `p`, each field's is
/// drawn from Beta(8, 2).
fn flown(told: Option<f64>, real: Option<f64>, algorithm: Algorithm, fields: u64) -> Row {
    let told: AnyReliability = match told {
        Some(p) => Reliability::new(p).expect("a probability").into(),
        None => UnknownReliability::beta(8.0, 2.0).expect("a prior").into(),
    };
    let extent = Extent::OutsideBalls(0.0);
    let campaign = Campaign {
        fields,
        noise: Some(NoiseModel { p: real.unwrap_or(0.8), extent }),
        p_told: Some(told),
        draws_p: real.is_none(),
        ..Campaign::of(algorithm, LABELS + 6)
    };
    let rows = campaign.run(&Calibrated).expect("there is room");
    let summary = Summary::of(&campaign, rows).expect("no field is refused");
    summary.rows.into_iter().find(|row| row.labels == LABELS).expect("30 labels")
}

/// The 90 % set holds the line as often as it says, however often labels are true in each field.
#[test]
fn on_average_over_the_prior_stated_probabilities_are_right() {
    for algorithm in [Algorithm::Lookahead, Algorithm::Scc] {
        let row = flown(None, None, algorithm, cases(120, 10_000));
        // Three standard deviations of a share, and at most a point in the long run.
        let most = 3.0 * (0.09 / row.missions as f64).sqrt();
        expect(format!("{algorithm:?}"), row.coverage - row.stated, -most..=most);
    }
}

/// A prior costs little where its mean is right, and keeps much of the coverage that a wrong number loses.
#[test]
fn a_prior_bears_a_sensor_that_is_worse_than_stated() {
    for real in [0.55, 0.6, 0.8, 0.9, 0.99] {
        let coverage = |told| {
            let row = flown(told, Some(real), Algorithm::Lookahead, cases(40, 4_000));
            100.0 * row.coverage
        };
        let prior = coverage(None);
        if real < 0.7 {
            expect(format!("real {real}: more covered"), prior - coverage(Some(0.8)), 15.0..);
        } else {
            expect(format!("real {real}: covered"), prior, 85.0..);
        }
    }
}
