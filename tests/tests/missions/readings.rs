//! Readings on the way of motions: what planners learn from them, and what they leave as it is.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use planner_core::error::ObservationError;
use planner_core::watch::Watched;
use planner_core::{
    Angle, Belief as _, CellPosterior, Certainty, Goal, Label, Noise, Persist as _, Plan,
    Planner as _, Pose, Prior, Reading, Sample, Site, Stage, VersionSpace,
};
use tests::cases;
use tests::ensemble::{self, noisy};

fn standard(number: u64, algorithm: Algorithm, steps: u32) -> Mission {
    standard_field::standard(51, number, algorithm, steps)
}

/// What a perfect sensor reads there.
fn truth(mission: &Mission, site: Site) -> Label {
    let Reading::Side(label) = mission.world.reading(site) else { panic!("on the line") };
    label
}

/// Places of the area in rows of 20.
fn places() -> impl Iterator<Item = Site> {
    let place = |n: u32| [f64::from(n % 20), f64::from(n / 20)].map(|it| it + 0.31);
    (0..400).map(move |n| Site::metres(place(n)).expect("in the area"))
}

/// A place of which the label is not known.
fn open(space: &VersionSpace<68>) -> Option<Site> {
    places().find(|site| space.certainty(*site) == Certainty::Uncertain)
}

/// With several readings a motion the line is found sooner.
#[test]
fn more_readings_tell_more() {
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead, Algorithm::Margin, Algorithm::Random] {
        let bits = [1, 2, 5, 20].map(|readings| {
            let bits = ensemble::fly(cases(40, 400), |number| {
                let mission = Mission { readings, ..standard(number, algorithm, 10) };
                let recording = Recording::of(&mission).expect("labels are true");
                let (read, cut) = recording.results.readings();
                let is_counted = if readings == 1 { read == 0 } else { read > 0 && cut <= read };
                assert!(is_counted, "{number}: {read} readings, {cut} cut");
                recording.results.steps.last().map_or(0.0, |step| step.bits)
            });
            bits.into_iter().sum::<f64>()
        });
        assert!(bits.is_sorted(), "{algorithm:?}: {bits:?}");
        // Look-ahead chooses motions by what all labels tell together: without that it has 1.94 times as much.
        let times = if algorithm == Algorithm::Lookahead { 1.955 } else { 1.3 };
        assert!(bits[2] > times * bits[0], "{algorithm:?}: {bits:?}");
    }
}

/// A reading on the way changes what Algorithm 1 knows, and not where it stands.
#[test]
fn algorithm_1_stays_in_its_phase() {
    let mut checked = 0;
    for number in 0..20 {
        let mission = standard(number, Algorithm::Cfc, 10);
        let mut planner = mission.cfc(mission.config.area, mission.vehicle);
        let mut pose = mission.start;
        for step in 0..10 {
            let Plan::Move(motion) = planner.plan(pose) else { break };
            let mut without = planner.clone();
            let Some(site) = open(planner.belief()) else { break };
            let label = truth(&mission, site);
            assert_eq!(planner.observe_on_the_way(site, label.into()), Ok(true));
            assert_eq!(planner.phase(), without.phase());
            pose = motion.target;
            let reading = Some(truth(&mission, pose.site).into());
            planner.observe(pose, reading).expect("true");
            without.observe(pose, reading).expect("true");
            assert_eq!(planner.phase(), without.phase(), "field {number}");
            // Where the label is known, it tells nothing, and where it is not that, the model is wrong.
            let before = planner.snapshot();
            assert_eq!(planner.observe_on_the_way(site, label.into()), Ok(false));
            let refused = planner.observe_on_the_way(site, (-label).into());
            let contrary = Sample { site, label: -label };
            assert_eq!(refused, Err(ObservationError::Contradiction(contrary)));
            assert_eq!(planner.snapshot(), before);
            checked = checked.max(step);
        }
    }
    assert!(checked > 2, "{checked} steps");
}

/// Algorithm 2 takes turns by the labels at the ends of motions alone.
#[test]
fn algorithm_2_takes_turns_by_motions() {
    for passes in 0..4 {
        let mission = noisy(standard(3, Algorithm::Scc, 8), 0.8, 0.0);
        let mut planner = mission.scc(mission.config.area, mission.vehicle);
        let mut pose = mission.start;
        for motions in 0..8 {
            let Plan::Move(motion) = planner.plan(pose) else { panic!("no motion") };
            let due = if motions % 2 == 0 { Stage::P1 } else { Stage::P2 };
            assert_eq!(motion.stage, Some(due), "{passes} a motion");
            let start = planner.belief().start();
            let open = places().filter(|it| start.certainty(*it) == Certainty::Uncertain);
            let open: Vec<_> = open.step_by(7).take(passes).collect();
            for site in open {
                assert_eq!(planner.observe_on_the_way(site, Label::Positive.into()), Ok(true));
            }
            pose = motion.target;
            planner.observe(pose, Some(Label::Negative.into())).expect("any label");
        }
    }
}

/// What is read on the way to a place of an audit settles nothing there.
#[test]
fn an_audit_visits_its_places_all_the_same() {
    for (number, readings) in (0..10).flat_map(|number| [(number, 1), (number, 10)]) {
        let mission = standard(number, Algorithm::Lookahead, 60);
        let goal = Some(Goal::slope_within_degrees(5.0).expect("a goal").into());
        let recording = Recording::of(&Mission { readings, goal, ..mission }).expect("true labels");
        let goal = recording.results.end.goal.as_ref().expect("a goal");
        assert!(goal.is_met, "field {number}");
        assert_eq!(goal.audit.expect("an audit").agreed, 6, "field {number}");
    }
}

/// The last room is for the label at the end of the motion.
#[test]
fn a_reading_on_the_way_leaves_room_for_the_label_at_the_end() {
    let mission = standard(0, Algorithm::Lookahead, 1);
    let given = mission.given.samples();
    let noise = Noise::new(0.8).expect("a probability");
    let mut table = CellPosterior::<8, 30>::new(given, Prior::Area, noise).expect("four");
    let is_open = |site: &Site| table.start().certainty(*site) == Certainty::Uncertain;
    let open_ones: Vec<_> = places().filter(is_open).step_by(9).collect();
    let mut open_ones = open_ones.into_iter();
    let mut site = || open_ones.next().expect("enough");
    let heard = [(); 5].map(|()| table.observe_on_the_way(site(), Label::Positive.into()));
    assert_eq!(heard, [Ok(true), Ok(true), Ok(true), Ok(false), Ok(false)]);
    assert!(!table.is_full());
    table.observe(site(), Label::Positive.into()).expect("there is room");
    assert!(table.is_full());
    // Of true labels as well.
    let mut space = VersionSpace::<5>::new(given).expect("four");
    let site = open(&mission.lines()).expect("something is open");
    let label = truth(&mission, site).into();
    assert_eq!(space.observe_on_the_way(site, label), Ok(false));
    space.observe(site, label).expect("there is room");
    assert!(space.is_full());
}

/// A sensor that is stuck is noticed by what it reads on the way.
#[test]
fn labels_on_the_way_are_evidence() {
    let mission = noisy(standard(1, Algorithm::Lookahead, 1), 0.9, 0.0);
    let mut planner = Watched::new(mission.doubtful(mission.config.area, mission.vehicle));
    let below = places().filter(|site| mission.world.distance(*site) < -1.0).step_by(5);
    for site in below.take(40) {
        planner.observe_on_the_way(site, Label::Positive.into()).expect("any label");
    }
    assert!(planner.alarm().is_some());
}

/// Where the robot stands still there is nothing on the way.
#[test]
fn a_turn_on_the_spot_has_no_readings_on_the_way() {
    let mission = Mission { readings: 5, ..standard(2, Algorithm::Lookahead, 1) };
    let from = mission.start;
    let to = Pose { heading: from.heading.turned(Angle(1 << 30)), ..from };
    assert_eq!(mission.way().sites(from, to).count(), 0);
}
