//! Large areas, and labels that have a price: look-ahead goes where labels pay.

use host_sim::campaign::accuracy::{Accuracy, Row, Summary};
use host_sim::campaign::ensemble::Campaign;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::asking::Asking;
use host_sim::report::campaign as tables;
use planner_core::{AnyVehicle, Seeks, Unicycle};
use tests::{cases, is_long};

/// Motions without a goal end here.
const MOTIONS: u32 = 400;

/// The ensemble at the labels of each row.
fn flown(sides: [f64; 2], vehicle: AnyVehicle, asking: Asking, fields: u64) -> Summary {
    let usual = Campaign::of(Algorithm::Lookahead, MOTIONS);
    let campaign = Campaign { fields, sides, vehicle, asking, ..usual };
    let rows = campaign.run(&Accuracy { by_label: true }).expect("there is room");
    let summary = Summary::of(&campaign, rows).expect("labels are true");
    println!("{sides:?}, {asking:?}\n{}", tables::accuracy(&summary));
    summary
}

fn at(summary: &Summary, labels: u32) -> &Row {
    summary.rows.iter().find(|row| row.step == labels).expect("a stage")
}

/// A unicycle whose longest motion is so many metres, as finely as the usual one turns.
fn unicycle(reach: f64) -> AnyVehicle {
    let step_mm = (reach * 50.0) as u32;
    let unicycle = Unicycle::new(1, std::f64::consts::FRAC_PI_2, 21, step_mm);
    AnyVehicle::Unicycle(unicycle.expect("a vehicle"))
}

fn priced(price: f64, labels: u32) -> Asking {
    Asking { price: Some(price), labels: Some(labels), ..Asking::USUAL }
}

/// 800 m by 500 m with motions of 5 and 20 m, 24 labels: without a price the median is 2 degrees.
#[test]
fn twenty_four_labels_are_enough_for_a_lake() {
    for reach in [5.0, 20.0] {
        let summary = flown([800.0, 500.0], unicycle(reach), priced(81.25, 24), cases(100, 1_000));
        let Row { centre_deg, centre_misclassified, .. } = at(&summary, 24);
        assert!(centre_deg.median <= 0.1 && centre_deg.p90 <= 0.3, "{reach} m: {centre_deg:?}");
        assert!(centre_deg.worst <= 0.5, "{reach} m: {centre_deg:?}");
        assert!(centre_misclassified.worst <= 0.01, "{reach} m: {centre_misclassified:?}");
        assert_eq!(summary.ends.get("labels"), Some(&summary.fields), "{:?}", summary.ends);
    }
}

/// On standard fields, a few metres more for each label misclassify less with as many labels.
#[test]
fn a_price_makes_labels_worth_more() {
    let usual = AnyVehicle::from(Algorithm::Lookahead.grid());
    let chance = if is_long() { 1.0 } else { 1.15 };
    let summary = flown([20.0; 2], usual, priced(2.5, 20), cases(200, 1_000));
    for (labels, most) in [(10, 0.0045), (20, 0.0002)] {
        let row = at(&summary, labels);
        assert!(row.centre_misclassified.median <= most * chance, "{row:?}");
        assert!(row.bits_per_step >= 0.95, "{row:?}");
    }
}

/// The price says what a user wants: the higher it is, the farther the robot drives, and the more it learns from as many
/// labels. Bits save driving, accuracy saves labels.
#[test]
fn a_higher_price_drives_farther_for_more() {
    let fields = cases(60, 300);
    let flown = |asking| flown([800.0, 500.0], unicycle(5.0), asking, fields);
    let mut before = (0.0, f64::INFINITY);
    for price in [0.0, 5.0, 50.0, 200.0] {
        let summary = flown(priced(price, 16));
        let row = at(&summary, 16);
        assert!(row.metres > before.0 && row.centre_deg.median < before.1, "{price}: {row:?}");
        before = (row.metres, row.centre_deg.median);
    }
    let [accuracy, bits] =
        [Seeks::Accuracy, Seeks::Bits].map(|seeks| flown(Asking { seeks, ..priced(50.0, 16) }));
    let (accuracy, bits) = (at(&accuracy, 16), at(&bits, 16));
    assert!(bits.metres < 0.6 * accuracy.metres, "{} m, {} m", bits.metres, accuracy.metres);
    assert!(accuracy.centre_deg.median < bits.centre_deg.median, "{accuracy:?}, {bits:?}");
}
