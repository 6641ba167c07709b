//! What look-ahead promises, and what it learns for its cost.

use host_sim::campaign::accuracy::{self, Accuracy as Accurate};
use host_sim::campaign::calibration::{self, Calibrated};
use host_sim::campaign::ensemble::Campaign;
use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::{Mission, Table};
use host_sim::mission::names::FanName;
use host_sim::mission::results::Ending;
use host_sim::world::noise::{Extent, NoiseModel, limit};
use host_sim::world::polygon::misclassified;
use planner_core::{
    Accuracy, Angle, Goal, Label, Line, Plan, Planner as _, PosteriorView, Reliability, Sample,
    StopReason, Unicycle,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::ensemble::{self, expect, noisy, percent};
use tests::{cases, is_long};

/// The half degree, and the thousandth of the area, that missions are to come to.
const SLOPE_ARC_DEG: f64 = 0.5;
const MISCLASSIFIED: f64 = 1e-3;

/// Probability of a credible set, millionths.
const LEVEL: u32 = 900_000;

fn slope_arc() -> Accuracy {
    Accuracy::SlopeArc(Angle::from_degrees(SLOPE_ARC_DEG).expect("an angle"))
}

fn mission(number: u64, steps: u32, accuracy: Accuracy) -> Mission {
    let mut mission = standard_field::standard(31, number, Algorithm::Lookahead, steps);
    mission.vehicle = FanName::Fine.into();
    mission.goal = Some(Goal { accuracy, level: LEVEL });
    mission
}

/// With true labels, a mission that ends because the line is known keeps its promise: for the centre, for the true
/// line, and for any two lines that are left.
#[test]
fn true_labels_keep_every_promise() {
    for accuracy in [slope_arc(), Accuracy::Misclassified((MISCLASSIFIED * 1e6) as u32)] {
        let known = ensemble::fly(cases(100, 1_000), |number| {
            let mission = mission(number, 60, accuracy);
            let flown = mission.fly(|_, _| {}).expect("labels are true");
            if flown.ending != Ending::Stopped(StopReason::Known) {
                return false;
            }
            let centre = Line::from(flown.belief.estimates().centre.expect("lines are left"));
            let left = flown.belief.version_space().expect("labels are true");
            let mut lines: Vec<_> = left.bounds().map(Line::from).collect();
            lines.extend([*mission.world.line().expect("a line"), centre]);
            for (k, one) in lines.iter().enumerate() {
                for other in &lines[..k] {
                    let (off, promised) = match accuracy {
                        Accuracy::SlopeArc(_) => (one.angle_to_deg(other), SLOPE_ARC_DEG),
                        Accuracy::Misclassified(_) => {
                            (misclassified(mission.config.area, one, other), MISCLASSIFIED)
                        }
                    };
                    assert!(off <= promised, "field {number}: {off} of {accuracy:?}");
                }
            }
            true
        });
        expect(format!("known, {accuracy:?}"), percent(&known, |it| *it), 90.0..);
    }
}

/// With labels that may be wrong, a goal bounds the angles between the lines of a set. The set contains the true line
/// with at least the probability `LEVEL`. Take the missions that end because the line is known. In at least that share
/// of them, the true line makes no larger angle with any line of the set.
#[test]
fn labels_that_may_be_wrong_keep_promises_as_often_as_stated() {
    for p in [0.8, 0.9] {
        let kept = ensemble::fly_some(cases(60, 1_000), |number| {
            let mission = noisy(mission(number, 400, slope_arc()), p, 0.0);
            let flown = mission.fly(|_, _| {}).expect("doubtful labels");
            if flown.ending != Ending::Stopped(StopReason::Known) {
                return None;
            }
            let table = flown.belief.hypotheses().expect("labels may be wrong");
            let truth = mission.world.line().expect("a line");
            let posterior = PosteriorView::new(table);
            let set = posterior.credible(f64::from(LEVEL) / 1e6);
            let mut lines = posterior.members(&set).flat_map(|it| table.lines(it).bounds());
            assert!(set.slope_arc.width_deg() <= SLOPE_ARC_DEG, "field {number}");
            Some(lines.all(|line| Line::from(line).angle_to_deg(truth) <= SLOPE_ARC_DEG))
        });
        let (count, level) = (kept.len() as f64, f64::from(LEVEL) / 1e6);
        assert!(count * 4.0 >= cases(60, 1_000) as f64, "{count}");
        // Three standard deviations of so many draws at the level.
        let allowance = 3.0 * (level * (1.0 - level) / count).sqrt();
        let share = percent(&kept, |kept| *kept);
        expect(format!("kept, p = {p}"), share, 100.0 * (level - allowance)..);
    }
}

/// What 30 labels, each true with a probability of its own, were expected to tell and could have: after 10, 20 and 30.
fn mixed(number: u64) -> [[f64; 2]; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(number);
    let mission = standard_field::standard(32, number, Algorithm::Lookahead, 40);
    // What the planner believes of labels that nobody tells it about.
    let mission = noisy(mission, 0.8, 0.0);
    let mut known: Table = mission.table();
    let mut planner = mission.doubtful(mission.config.area, Unicycle::from(FanName::Paper));
    let (mut pose, mut told, mut marks) = (mission.start, [0.0; 2], Vec::new());
    while marks.len() < 30 {
        let Plan::Move(motion) = planner.plan(pose) else { panic!("field {number}: no motion") };
        pose = motion.target;
        if !motion.wants_label {
            continue;
        }
        let p = [0.6, 0.7, 0.8, 0.9, 0.99][rng.random_range(0..5)];
        let reliability = Reliability::new(p).expect("a probability");
        let is_above = (mission.world.distance(pose.site) > 0.0) == rng.random_bool(p);
        let label = if is_above { Label::Positive } else { Label::Negative };
        let sample = Sample { site: pose.site, label };
        let share = PosteriorView::new(&known).share_above(pose.site);
        told[0] += limit(p) - limit(share * p + (1.0 - share) * (1.0 - p));
        told[1] += limit(p);
        known.take(sample, reliability).expect("room");
        planner.belief_mut().take(sample, reliability).expect("room");
        marks.push(told);
    }
    [marks[9], marks[19], marks[29]]
}

#[test]
fn labels_of_reliabilities_of_their_own_tell_nearly_what_they_can() {
    let of_each = ensemble::fly(cases(100, 1_000), mixed);
    for k in 0..3 {
        let [told, most] = [0, 1].map(|part| of_each.iter().map(|it| it[k][part]).sum::<f64>());
        expect(format!("{} labels, of what they can tell", 10 * (k + 1)), told / most, 0.94..);
    }
}

fn campaign(seed: u64, steps: u32, noise: Option<NoiseModel>) -> Campaign {
    let (fields, vehicle) = (cases(100, 1_000), FanName::Fine.into());
    Campaign { fields, seed, vehicle, noise, ..Campaign::of(Algorithm::Lookahead, steps) }
}

/// How much of a figure of 1,000 fields chance may take from one of fewer.
fn chance() -> f64 {
    if is_long() { 1.0 } else { 0.985 }
}

#[test]
fn true_labels_teach_what_they_should() {
    for seed in [1, 2] {
        let campaign = campaign(seed, 40, None);
        let rows = campaign.run(&Accurate { by_label: false }).expect("there is room");
        let summary = accuracy::Summary::of(&campaign, rows).expect("labels are true");
        let at = |step| summary.rows.iter().find(|row| row.step == step).expect("a mark");
        for (step, bits) in [(10, 0.955), (20, 0.97), (30, 0.95), (40, 0.94)] {
            // A noiseless label tells one bit at most, on average.
            expect(format!("bits, {step}"), at(step).bits_per_step, bits * chance()..=1.0);
        }
        let slack = if is_long() { 1.0 } else { 1.5 };
        for (step, degrees) in [(10, 1.2), (20, 0.04), (40, 1e-3)] {
            expect(format!("degrees, {step}"), at(step).centre_deg.median, ..=degrees * slack);
        }
        expect("control cost", at(20).control_cost, ..=if is_long() { 25.0 } else { 28.0 });
        // A search that closes in more slowly finds as good places, but asks more of them.
        expect("places asked a plan", summary.mean_examined, ..=120.0);
        // Where no label is in reach the ladder looks for a way on.
        assert!(summary.most_examined <= planner_core::parts::LOOKS);
    }
}

#[test]
fn labels_that_may_be_wrong_teach_what_they_should() {
    let reliabilities: &[f64] = if is_long() { &[0.6, 0.7, 0.8, 0.9, 0.99] } else { &[0.7, 0.9] };
    for seed in if is_long() { 1..=2 } else { 1..=1 } {
        for &p in reliabilities {
            let noise = NoiseModel { p, extent: Extent::OutsideBalls(0.0) };
            let campaign = campaign(seed, 36, Some(noise));
            let rows = campaign.run(&Calibrated).expect("there is room");
            let summary = calibration::Summary::of(&campaign, rows).expect("no field is refused");
            let at = |labels| summary.rows.iter().find(|row| row.labels == labels).expect("a mark");
            let shares = if p > 0.85 { [0.94; 3] } else { [0.96, 0.97, 0.97] };
            for (labels, share) in [10, 20, 30].into_iter().zip(shares) {
                let told = at(labels).expected_share.expect("labels tell something");
                expect(format!("of what {labels} can tell, p = {p}"), told, share * chance()..);
            }
            if is_long() && (0.65..0.75).contains(&p) {
                expect("bits", at(30).bits, 3.4..);
                expect("control cost", at(30).control_cost, ..=45.0);
            }
        }
    }
}
