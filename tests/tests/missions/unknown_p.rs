//! Stated probabilities where nobody knows how often labels are true, over many fields.

use host_sim::campaign::calibration::{Calibrated, Row, Summary};
use host_sim::campaign::ensemble::Campaign;
use host_sim::mission::algorithm::Algorithm;
use host_sim::world::errors::Errors;
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::{
    AnyReliability, Crossing, Policy, Prior, Reliability, Tolerance, UnknownReliability,
};
use tests::cases;

const LABELS: u32 = 30;

/// What planners are told: a number, or Beta(8, 2).
#[derive(Clone, Copy, Debug)]
enum Told {
    Number(f64),
    Beta,
}

/// The ensemble after 30 labels. Without a real `p`, each field's is drawn from Beta(8, 2).
fn flown(told: Told, real: Option<f64>, algorithm: Algorithm, fields: u64) -> Row {
    let told: AnyReliability = match told {
        Told::Number(p) => Reliability::new(p).expect("a probability").into(),
        Told::Beta => UnknownReliability::beta(8.0, 2.0).expect("a prior").into(),
    };
    let extent = Extent::OutsideBalls(0.0);
    let campaign = Campaign {
        algorithm,
        fields,
        steps: LABELS + 6,
        readings: 1,
        every: false,
        seed: 1,
        crossing: Crossing::default(),
        following: algorithm.following(),
        vehicle: algorithm.grid().into(),
        noise: Some(NoiseModel { p: real.unwrap_or(0.8), extent }),
        p_told: Some(told),
        draws_p: real.is_none(),
        errors: Errors::default(),
        tolerance: Tolerance::NONE,
        policy: Policy::default(),
        prior: Prior::Area,
    };
    let rows = campaign.run(&Calibrated).expect("there is room");
    let summary = Summary::of(&campaign, rows).expect("no field is refused");
    summary.rows.into_iter().find(|row| row.labels == LABELS).expect("30 labels")
}

/// The 90 % set holds the line as often as it says, however often labels are true in each field.
#[test]
fn on_average_over_the_prior_stated_probabilities_are_right() {
    let fields = cases(400, 10_000);
    for algorithm in [Algorithm::Lookahead, Algorithm::Scc] {
        let row = flown(Told::Beta, None, algorithm, fields);
        let by_area = &row.calibration[0];
        println!(
            "{algorithm:?}, {} fields: holds {:.4}, states {:.4}, {:.2} bits",
            row.missions, by_area.coverage, by_area.stated, row.bits
        );
        // Three standard deviations of a share, and at most a point in the long run.
        let most = 3.0 * (0.09 / row.missions as f64).sqrt();
        assert!((by_area.coverage - by_area.stated).abs() < most, "{algorithm:?}: {by_area:?}");
    }
}

/// A prior costs little where its mean is right, and keeps much of the coverage that a wrong number loses.
#[test]
fn a_prior_bears_a_sensor_that_is_worse_than_stated() {
    let fields = cases(100, 4_000);
    for real in [0.55, 0.6, 0.7, 0.8, 0.9, 0.99] {
        let of = |told| flown(told, Some(real), Algorithm::Lookahead, fields);
        let [right, wrong, prior] = [Told::Number(real), Told::Number(0.8), Told::Beta].map(of);
        let coverage = |row: &Row| 100.0 * row.calibration[0].coverage;
        println!(
            "real {real}: told it {:.1} ({:.2} bits), told 0.8 {:.1} ({:.2}), Beta(8, 2) {:.1} (states {:.1}, {:.2})",
            coverage(&right),
            right.bits,
            coverage(&wrong),
            wrong.bits,
            coverage(&prior),
            100.0 * prior.calibration[0].stated,
            prior.bits,
        );
        if real < 0.7 {
            assert!(coverage(&prior) > coverage(&wrong) + 15.0, "real {real}");
        }
        if real >= 0.8 {
            assert!(coverage(&prior) > 85.0, "real {real}");
        }
    }
}
