//! How often the evidence of labels raises an alarm while the model is true.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::Given;
use host_sim::mission::recording::{Recorder, Recording};
use host_sim::world::World;
use host_sim::world::circle::Circle;
use host_sim::world::polygon::Polygon;
use nalgebra::{Point2, Vector2};
use planner_core::watch::{Alarm, Evidence};
use planner_core::{Accuracy, Angle, Belief as _, Goal, Line, Reading, Sample};
use tests::cases;
use tests::ensemble::{self, expect, noisy, percent};

/// The most evidence in a mission.
fn most_evidence(mission: &Mission) -> f32 {
    let mut evidence = Evidence::NONE;
    let mut before = mission.belief();
    let mut most = 0.0_f32;
    let flown = mission.fly(|step, after| {
        if let Some(Reading::Side(label)) = step.reading {
            evidence.observe(label, before.chance_of(step.pose.site, label));
        }
        before = after.boxed();
        most = most.max(evidence.value());
    });
    assert!(flown.is_ok());
    most
}

/// A mission on a standard field, of 30 labels in noise and of 20, 40 or 60 true ones.
fn of_labels(number: u64, algorithm: Algorithm, noise: Option<f64>) -> Mission {
    let steps = if noise.is_some() { 30 } else { 20 + 20 * (number % 3) as u32 };
    let mission = standard_field::standard(42, number, algorithm, steps);
    noise.map_or(mission.clone(), |p| noisy(mission, p, 0.5))
}

/// The mission whose line is a vertex of the lines that the given samples leave, moved a part of the way to their mean.
/// The bound holds on the average over lines, so it promises nothing here. Look-ahead halves what is left with each
/// label, and in a corner many labels in a row are alike: as of a sensor that is stuck.
fn in_a_corner(mission: Mission, number: u64, part: f64) -> Option<Mission> {
    let corners: Vec<_> = mission.lines().bounds().map(Line::from).collect();
    let corner = corners[number as usize % corners.len()].coefficients();
    let centre = mission.lines().centre().map(Line::from)?.coefficients();
    let [a, b, c] = [0, 1, 2].map(|k| (1.0 - part) * corner[k] + part * centre[k]);
    Some(Mission { world: World::divided_by(Line::from_coefficients(a, b, c)?), ..mission })
}

/// At most so many missions in a hundred raise an alarm: of 20 to 60 labels on the model, and of lines in a corner.
#[test]
fn an_alarm_is_rare_while_the_model_is_true() {
    use Algorithm::{Cfc, Lookahead, Scc};
    let parts = [(None, 1.0), (Some(0.02), 20.0), (Some(0.1), 1.0)];
    for (algorithm, noise, few) in [
        (Cfc, None, 60),
        (Lookahead, None, 60),
        (Scc, Some(0.7), 8),
        (Lookahead, Some(0.7), 8),
        (Lookahead, Some(0.9), 8),
    ] {
        for (part, most) in parts {
            let fields = if part.is_none() { cases(few, 10_000) } else { cases(20, 2_000) };
            let reached = ensemble::fly_some(fields, |number| {
                let mission = of_labels(number, algorithm, noise);
                Some(most_evidence(&match part {
                    Some(part) => in_a_corner(mission, number, part)?,
                    None => mission,
                }))
            });
            let what = format!("{algorithm:?}, {noise:?}, {part:?} of the way from a corner");
            expect(&what, percent(&reached, |it| *it >= Alarm::ALARM), ..=most);
            let warned = percent(&reached, |it| *it >= Alarm::WARNING);
            expect(format!("{what}, warned"), warned, ..=if part.is_none() { 5.0 } else { 100.0 });
        }
    }
}

/// Readings on the way that a belief leaves out are no evidence, whether the robot begins with points or with nothing.
#[test]
fn readings_on_the_way_raise_no_alarm() {
    use Algorithm::{Cfc, Lawnmower, Lookahead};
    let mut all = Vec::new();
    for (algorithm, knows) in
        [(Lawnmower, false), (Lookahead, false), (Lookahead, true), (Cfc, true)]
    {
        all.extend(ensemble::fly_some(cases(40, 2_000), |number| {
            let steps = [15, 25, 60][number as usize % 3];
            let mut mission = standard_field::standard(43, number, algorithm, steps);
            mission.readings = [2, 5, 9, 15, 50][number as usize % 5];
            if !knows {
                mission.given = Given::open(Vec::new());
            }
            let (mut recorder, mut most) = (Recorder::new(mission.clone()), 0.0_f32);
            let (_, refused) = mission.fly_in_sight(|step, sight, belief| {
                recorder.pass(sight.passed);
                recorder.take(step, sight.true_pose, belief);
                most = most.max(recorder.last().and_then(|it| it.evidence).unwrap_or(0.0));
            });
            assert_eq!(refused, None);
            Some(most)
        }));
    }
    expect("alarms", percent(&all, |it| *it >= Alarm::ALARM), ..=1.0);
    expect("warnings", percent(&all, |it| *it >= Alarm::WARNING), ..=5.0);
}

/// A mission of which the labels amount to an alarm does not promise that the line is known, whatever the boundary does.
#[test]
fn a_promise_and_an_alarm_exclude_each_other() {
    let area = standard_field::standard(44, 0, Algorithm::Lookahead, 1).config.area;
    let flown = ensemble::fly_some(cases(18, 4_000), |number| {
        // The 56th met its goal and had an alarm.
        let number = number + 42;
        let mission = standard_field::standard(44, number, Algorithm::Lookahead, 120);
        let [a, b, c] = mission.world.line()?.coefficients();
        let (normal, middle) = (Vector2::new(a, b), Point2::new(10.0, 10.0));
        let foot = middle - normal * (normal.dot(&middle.coords) + c);
        let radius = [15.0, 25.0, 60.0][number as usize % 3];
        let circle = Circle { middle: foot + normal * radius, radius };
        let world = World::divided_by_curve(Box::new(circle), &Polygon::from(area));
        let is_true = |it: &Sample| world.agrees(it.site, it.label);
        let are_true = mission.given.samples().iter().all(is_true);
        let degrees = [0.5, 2.0, 8.0][number as usize / 3 % 3];
        let accuracy = Accuracy::SlopeArc(Angle::from_degrees(degrees).expect("an angle"));
        let goal = Some(Goal { accuracy, level: 900_000 });
        let mission = Mission { world, goal, ..mission };
        let p = [0.95, 0.9, 0.8][number as usize / 9 % 3];
        let (recording, _) = Recording::until_refusal(&noisy(mission, p, 0.5));
        let end = recording.results.end;
        let alarm = end.alarm.is_some_and(|it| it.evidence >= Alarm::ALARM);
        let is_met = end.goal.is_some_and(|it| it.is_met) || end.reason == "known";
        are_true.then_some((number, is_met, alarm))
    });
    let both: Vec<_> = flown.iter().filter(|it| it.1 && it.2).collect();
    assert!(both.is_empty(), "{both:?}");
    expect("promises", percent(&flown, |it| it.1), 1.0..);
    expect("alarms", percent(&flown, |it| it.2), 1.0..);
}
