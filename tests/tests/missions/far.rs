//! Large areas, and labels that have a price: look-ahead goes where labels pay.

use host_sim::campaign::accuracy::{Accuracy, Row, Summary};
use host_sim::campaign::ensemble::Campaign;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::asking::Asking;
use host_sim::report::campaign as tables;
use nalgebra::Point2;
use planner_core::geometry::lattice::UNITS_PER_METRE;
use planner_core::{
    AnySight, AnyVehicle, Area, Far, Heading, Label, Lookahead, Near, NoGoal, Persist as _, Plan,
    Planner as _, Pose, Sample, Seeks, Sight, Site, Unicycle, VersionSpace,
};
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

/// What is read on the way to a place counts: another place may be worth more by then.
#[test]
fn readings_on_the_way_to_a_place_pay() {
    let campaign = |readings| Campaign {
        fields: cases(60, 300),
        sides: [800.0, 500.0],
        vehicle: unicycle(5.0),
        asking: priced(50.0, 10),
        readings,
        ..Campaign::of(Algorithm::Lookahead, MOTIONS)
    };
    let [one, five] = [1, 5].map(|readings| {
        let campaign = campaign(readings);
        let rows = campaign.run(&Accuracy { by_label: true }).expect("there is room");
        let summary = Summary::of(&campaign, rows).expect("labels are true");
        at(&summary, 10).clone()
    });
    println!("{one:?}\n{five:?}");
    assert!(five.centre_deg.median < 0.01 && five.centre_deg.p90 < 0.1, "{five:?}");
    assert!(one.centre_deg.median > 0.3 && five.metres < one.metres, "{one:?}, {five:?}");
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

type Seeing<S> = Lookahead<Unicycle, VersionSpace<32>, Area, NoGoal, S>;

fn site(x: f64, z: f64) -> Site {
    Site::try_from(Point2::new(x, z)).expect("as it should")
}

/// The line is `z = 250`, 500 m x 500 m large.
fn label(site: Site) -> Label {
    if site.z() >= 250 * UNITS_PER_METRE { Label::Positive } else { Label::Negative }
}

fn area() -> Area {
    Area::metres([0.0, 0.0], [500.0, 500.0]).expect("as it should")
}

fn planner<S: Sight>(sight: S) -> Seeing<S> {
    let places = [(200.0, 150.0), (210.0, 330.0), (300.0, 360.0), (310.0, 190.0)];
    let given = places.map(|(x, z)| site(x, z)).map(|site| Sample { site, label: label(site) });
    let space = VersionSpace::new(&given).expect("as it should");
    Lookahead::new(area(), Unicycle::default(), space).expect("as it should").seeing(sight)
}

fn start() -> Pose {
    Pose { site: site(200.0, 150.0), heading: Heading::default() }
}

/// Flies so many motions, has each looked at before it is made, and returns the labels.
fn fly<S: Sight>(sight: S, motions: u32, mut look: impl FnMut(&mut Seeing<S>, Pose)) -> u32 {
    let (mut planner, mut pose, mut labels) = (planner(sight), start(), 0);
    for _ in 0..motions {
        look(&mut planner, pose);
        let Plan::Move(motion) = planner.plan(pose) else { break };
        pose = motion.target;
        let reading = motion.wants_label.then(|| label(pose.site).into());
        labels += u32::from(reading.is_some());
        planner.observe(pose, reading).expect("as it should");
    }
    labels
}

#[test]
fn a_price_buys_driving_for_fewer_labels() {
    let [none, some, high] = [0.0, 50.0, 16_384.0]
        .map(|price| fly(Far::at_price(price).expect("as it should"), 400, |_, _| ()));
    assert!(none >= 28 && high < some && high >= 2, "{none}, {some}, {high} labels");
    assert!(Far::at_price(-1.0).is_err() && Far::at_price(f64::NAN).is_err());
}

/// A plan asked twice, and by a planner that was asleep on the way, is the same.
#[test]
fn a_way_goes_on_after_a_sleep() {
    let far = Far::across(&area());
    let mut silent = 0;
    fly(far, 150, |awake, pose| {
        let plan = awake.plan(pose);
        assert_eq!(plan, awake.plan(pose));
        let mut woken = planner(far);
        woken.restore(&awake.snapshot()).expect("as it should");
        assert_eq!(woken.plan(pose), plan);
        silent += u32::from(matches!(plan, Plan::Move(motion) if !motion.wants_label));
    });
    assert!(silent > 50, "{silent}");
}

#[test]
fn what_is_told_at_run_time_sees_as_far() {
    let far = Far::at_price(20.0).expect("as it should").seeking(Seeks::Bits);
    for told in [None, Some(far)] {
        let (mut near, mut distant, mut either) =
            (planner(Near), planner(far), planner(AnySight::from(told)));
        let mut pose = start();
        for _ in 0..60 {
            let plan = either.plan(pose);
            let same = if told.is_some() { distant.plan(pose) } else { near.plan(pose) };
            assert_eq!(plan, same);
            let Plan::Move(motion) = plan else { break };
            pose = motion.target;
            let reading = motion.wants_label.then(|| label(pose.site).into());
            near.observe(pose, reading).expect("as it should");
            distant.observe(pose, reading).expect("as it should");
            either.observe(pose, reading).expect("as it should");
        }
    }
}

#[test]
fn sight_is_far_by_default_where_the_area_is_large() {
    let vehicle = Unicycle::default();
    let square = |side: f64| Area::metres([0.0, 0.0], [side, side]).expect("as it should");
    assert_eq!(Far::usual(&square(20.0), &vehicle), None);
    assert_eq!(Far::usual(&square(32.0), &vehicle), None);
    let lake = Area::metres([0.0, 0.0], [800.0, 500.0]).expect("as it should");
    let usual = Far::usual(&lake, &vehicle).expect("as it should");
    assert!((usual.price() - 81.25).abs() < 1e-3, "{}", usual.price());
}

/// More motions than a number of 16 bits holds lead to the places of a large area, where motions are of millimetres.
#[test]
fn a_way_may_be_of_any_length() {
    let area = Area::metres([0.0, 0.0], [8_000.0, 8_000.0]).expect("an area");
    let places = [(800.0, 400.0), (800.0, 7_200.0), (4_800.0, 7_600.0), (7_200.0, 800.0)];
    let given = places.map(|(x, z)| site(x, z)).map(|site| {
        let label =
            if site.z() > 4_000 * UNITS_PER_METRE { Label::Positive } else { Label::Negative };
        Sample { site, label }
    });
    let space = VersionSpace::<32>::new(&given).expect("an oracle");
    let vehicle = Unicycle::new(1, std::f64::consts::FRAC_PI_2, 3, 1).expect("a vehicle");
    let far = Far::at_price(16_384.0).expect("a price");
    let mut planner = Lookahead::new(area, vehicle, space).expect("room").seeing(far);
    let mut pose = Pose { site: given[0].site, heading: Heading::default() };
    for motion in 0..100 {
        let Plan::Move(next) = planner.plan(pose) else { panic!("it ends after {motion}") };
        assert!(!next.wants_label, "it gives up after {motion}");
        pose = next.target;
        planner.observe(pose, None).expect("no label");
    }
}
