//! How often the evidence of labels raises an alarm while the model is true.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::world::World;
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::watch::{Alarm, Evidence, Suspect};
use planner_core::{Belief as _, Line, Reading};
use rayon::prelude::*;
use tests::cases;

/// Missions in noise of a long run.
const NOISY: u64 = 10_000;

/// The most evidence in a mission, and what was suspected then.
fn most_evidence(mission: &Mission) -> (f32, Option<Suspect>) {
    let mut evidence = Evidence::NONE;
    let mut before = mission.belief();
    let (mut most, mut suspect) = (0.0_f32, None);
    let flown = mission.fly(|step, after| {
        if let Some(Reading::Side(label)) = step.reading {
            evidence.observe(label, before.chance_of(step.pose.site, label));
        }
        before = after.boxed();
        if evidence.value() > most {
            (most, suspect) = (evidence.value(), evidence.alarm().map(|it| it.suspect));
        }
    });
    assert!(flown.is_ok());
    (most, suspect)
}

/// The shares of missions that reach a warning and an alarm, per cent.
fn alarms(name: &str, reached: &[(f32, Option<Suspect>)]) -> [f64; 2] {
    let share = |least: f32| {
        100.0 * reached.iter().filter(|it| it.0 >= least).count() as f64 / reached.len() as f64
    };
    let shares = [Alarm::WARNING, Alarm::ALARM].map(share);
    println!("{name}: {:.2} % warnings, {:.2} % alarms of {}", shares[0], shares[1], reached.len());
    shares
}

/// A mission on a standard field, of 30 labels in noise and of 20, 40 or 60 true ones.
fn of_labels(number: u64, algorithm: Algorithm, noise: Option<f64>) -> Mission {
    let steps = if noise.is_some() { 30 } else { 20 + 20 * (number % 3) as u32 };
    let mut mission = standard_field::standard(42, number, algorithm, steps);
    mission.noise = noise.map(|p| NoiseModel { p, extent: Extent::OutsideBalls(0.5) });
    mission
}

/// On the model: missions of 20 to 60 labels that raise an alarm.
#[test]
fn an_alarm_is_rare_while_the_model_is_true() {
    for (algorithm, noise, few, many) in [
        (Algorithm::Cfc, None, 100, 10_000),
        (Algorithm::Lookahead, None, 100, 10_000),
        (Algorithm::Scc, Some(0.7), 8, NOISY),
        (Algorithm::Lookahead, Some(0.7), 8, NOISY),
        (Algorithm::Lookahead, Some(0.9), 8, NOISY),
    ] {
        let numbers = (0..cases(few, many)).into_par_iter();
        let reached: Vec<_> =
            numbers.map(|number| most_evidence(&of_labels(number, algorithm, noise))).collect();
        let [warnings, alarms] = alarms(&format!("{algorithm:?}, {noise:?}"), &reached);
        assert!(alarms <= 1.0 && warnings <= 5.0);
    }
}

/// Lines in the corners of the start: each is a vertex of the lines that the given samples leave, moved a part of the way
/// to their mean. The bound holds on the average over lines, so it promises nothing here. Look-ahead halves what is left
/// with each label, and in a corner many labels in a row are alike: as of a sensor that is stuck.
#[test]
fn lines_in_the_corners_of_the_start_raise_few_alarms() {
    for (algorithm, noise, few) in [
        (Algorithm::Cfc, None, 50),
        (Algorithm::Lookahead, None, 50),
        (Algorithm::Scc, Some(0.7), 50),
        (Algorithm::Lookahead, Some(0.9), 50),
    ] {
        for (part, most) in [(0.02, 20.0), (0.1, 1.0)] {
            let fly = |number: u64| {
                let mut mission = of_labels(number, algorithm, noise);
                let corners: Vec<_> = mission.lines().bounds().map(Line::from).collect();
                let corner = corners[number as usize % corners.len()].coefficients();
                let centre = mission.lines().centre().map(Line::from)?.coefficients();
                let [a, b, c] = [0, 1, 2].map(|k| (1.0 - part) * corner[k] + part * centre[k]);
                mission.world = World::divided_by(Line::from_coefficients(a, b, c)?);
                Some(most_evidence(&mission))
            };
            let numbers = (0..cases(few, 2_000)).into_par_iter();
            let reached: Vec<_> = numbers.filter_map(fly).collect();
            let name = format!("corners, {part} of the way, {algorithm:?}, {noise:?}");
            let [_, alarms] = alarms(&name, &reached);
            assert!(alarms <= most, "{alarms}");
        }
    }
}
