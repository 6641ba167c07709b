//! Margin sampling beside a slow twin that knows samples alone.
//!
//! The twin tries every action and finds the maximum-margin line among all pairs of samples. It calls a place uncertain
//! if a sample of either label there could be separated from the others.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use nalgebra::{Point2, Vector2};
use planner_core::dynamics::{Action, Dynamics as _};
use planner_core::search::recovery::Recovery;
use planner_core::{
    Belief as _, Label, Line, Pose, Reading, Sample, Site, Step, Unicycle, Workspace as _,
};
use tests::ensemble::noisy;

/// A line in lattice units: where `normal . q` is `offset`, with the normal of length 1.
#[derive(Clone, Copy)]
struct Between {
    normal: Vector2<f64>,
    offset: f64,
    margin: f64,
}

impl Between {
    fn distance(&self, site: Site) -> f64 {
        (self.normal.dot(&vector(site)) - self.offset).abs()
    }
}

fn vector(site: Site) -> Vector2<f64> {
    Vector2::new(f64::from(site.x()), f64::from(site.z()))
}

/// The widest strip between the two labels: its normal joins two samples of opposite labels, or is at right angles
/// to two of the same. Products of lattice units are exact in double precision, so that the sign of a gap is.
fn widest(samples: &[Sample]) -> Option<Between> {
    let of =
        |label: Label| samples.iter().filter(move |s| s.label == label).map(|s| vector(s.site));
    let mut widest: Option<Between> = None;
    for a in samples {
        for b in samples {
            let apart = vector(a.site) - vector(b.site);
            let normal = if a.label == b.label { Vector2::new(-apart.y, apart.x) } else { apart };
            for normal in [normal, -normal] {
                let least =
                    of(Label::Positive).map(|p| normal.dot(&p)).fold(f64::INFINITY, f64::min);
                let most =
                    of(Label::Negative).map(|q| normal.dot(&q)).fold(f64::NEG_INFINITY, f64::max);
                let (gap, length) = (least - most, normal.norm());
                if gap > 0.0 && widest.is_none_or(|it| gap / length > it.margin) {
                    widest = Some(Between {
                        normal: normal / length,
                        offset: f64::midpoint(least, most) / length,
                        margin: gap / length,
                    });
                }
            }
        }
    }
    widest
}

/// Whether a place could have either label.
fn is_open(samples: &[Sample], site: Site) -> bool {
    [Label::Positive, Label::Negative]
        .into_iter()
        .all(|label| widest(&[samples, &[Sample { site, label }]].concat()).is_some())
}

/// The nearest of all drives to the line, if any; when it is to `ask`, of those that end where it can.
fn nearest(
    mission: &Mission,
    pose: Pose,
    distance: impl Fn(Site) -> f64,
    can_ask: Option<&[Sample]>,
) -> Option<(f64, Action)> {
    let unicycle = Unicycle::paper();
    let mut drives: Vec<_> = (0..unicycle.grid().actions())
        .map(|index| Action(index as _))
        .filter_map(|action| {
            let target = unicycle.target(pose, action)?.site;
            let control = unicycle.control(pose, action);
            let moves = control.distance_m > 0.0 && mission.config.area.contains(target);
            moves.then(|| (distance(target), control, action, target))
        })
        .collect();
    drives.sort_by(|(near, a, ..), (far, b, ..)| {
        let smaller_turn = a.turn_rad.abs().total_cmp(&b.turn_rad.abs());
        let shorter = a.distance_m.total_cmp(&b.distance_m);
        near.total_cmp(far).then(smaller_turn).then(shorter).then(b.turn_rad.total_cmp(&a.turn_rad))
    });
    let chosen = drives
        .into_iter()
        .find(|(.., target)| can_ask.is_none_or(|samples| is_open(samples, *target)));
    chosen.map(|(distance, _, action, _)| (distance, action))
}

/// What the twin does at a pose.
fn choice(
    mission: &Mission,
    pose: Pose,
    distance: impl Fn(Site) -> f64 + Copy,
    ground: &[Sample],
) -> (Option<Recovery>, Action) {
    if let Some((_, action)) = nearest(mission, pose, distance, Some(ground)) {
        return (None, action);
    }
    let unicycle = Unicycle::paper();
    let last = unicycle.grid().actions() - unicycle.grid().actions() / 317;
    let mut turns: Vec<_> = [last, 0] // to the left, to the right
        .into_iter()
        .filter_map(|index| {
            let action = Action(index as _);
            let turned = unicycle.target(pose, action)?;
            let (distance, _) = nearest(mission, turned, distance, Some(ground))?;
            Some((distance, action))
        })
        .collect();
    turns.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, action)) = turns.first() {
        return (Some(Recovery::Reorient), *action);
    }
    match nearest(mission, pose, distance, None) {
        Some((_, action)) => (Some(Recovery::Transit), action),
        None => (Some(Recovery::Reorient), Action(last as _)),
    }
}

/// The steps of a mission, each with the pose from which it was made.
fn steps(mission: &Mission) -> Vec<(Pose, Step)> {
    let (mut pose, mut steps) = (mission.start, Vec::new());
    let flown = mission.fly(|step, _| {
        steps.push((pose, *step));
        pose = step.pose;
    });
    assert!(flown.is_ok());
    steps
}

fn sample(step: &Step) -> Option<Sample> {
    match step.reading {
        Some(Reading::Side(label)) => Some(Sample { site: step.pose.site, label }),
        _ => None,
    }
}

/// It never waits, and what is uncertain is asked again and again.
#[test]
fn of_true_labels_it_asks_nearest_to_the_widest_strip_s_middle() {
    let mut recoveries = 0;
    for number in 0..4 {
        let mission = standard_field::standard(3, number, Algorithm::Margin, 24);
        let (mut samples, mut silent) = (mission.given.samples().to_vec(), 0);
        for (pose, step) in steps(&mission) {
            silent = if step.motion.wants_label { 0 } else { silent + 1 };
            assert!(pose != step.pose && silent < 20, "field {number}: {silent} without a label");
            let line = widest(&samples).expect("they are separable");
            let (recovery, action) = choice(&mission, pose, |site| line.distance(site), &samples);
            let found = (step.motion.recovery, step.motion.action);
            assert_eq!(found, (recovery, action), "field {number}: {:?}", step.motion);
            assert_eq!(step.motion.wants_label, recovery.is_none());
            recoveries += u32::from(recovery.is_some());
            samples.extend(sample(&step));
        }
    }
    assert!(recoveries > 0, "rungs are tried too");
}

#[test]
fn of_labels_that_err_it_asks_where_the_start_leaves_doubt() {
    for number in 0..4 {
        let mission = standard_field::standard(4, number, Algorithm::Margin, 12);
        let mission = noisy(mission, 0.7, 0.0);
        let given = mission.given.samples().to_vec();
        let mut line: Line = mission.table().estimates().maximum_margin.expect("a line").into();
        let (mut pose, mut steps) = (mission.start, 0);
        let flown = mission.fly(|step, belief| {
            let before = line;
            let distance = |site: Site| before.distance(Point2::from(site)).abs();
            let found = (step.motion.recovery, step.motion.action);
            assert_eq!(found, choice(&mission, pose, distance, &given), "field {number}");
            line = belief.estimates().maximum_margin.expect("a line").into();
            (pose, steps) = (step.pose, steps + 1);
        });
        assert!(flown.is_ok() && steps == 12);
    }
}
