//! The audit before a goal's promise where labels may be wrong: it rarely accuses a straight line, and it finds sensors
//! that fail.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::recording::Recording;
use host_sim::world::faults::{Fault, FaultKind};
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::{Goal, Label};
use rayon::prelude::*;
use tests::cases;

/// Motions of a mission at most.
const MOTIONS: u32 = 600;

/// What a mission came to.
struct Flown {
    /// `"known"`, `"no line"` or another reason.
    reason: String,
    /// The real misclassified share.
    wrong: f64,
    /// Labels, motions and metres of the audit.
    audit: Option<[f64; 3]>,
}

impl Flown {
    fn of(number: u64, p: f64, degrees: f64, fault: Option<Fault>) -> Self {
        let mut mission = standard_field::standard(44, number, Algorithm::Lookahead, MOTIONS);
        mission.noise = Some(NoiseModel { p, extent: Extent::OutsideBalls(0.5) });
        mission.goal = Some(Goal::slope_within_degrees(degrees).expect("an angle").into());
        mission.sensor = fault.into_iter().collect();
        let recording = Recording::of(&mission).unwrap_or_else(|error| panic!("{number}: {error}"));
        let end = recording.results.end;
        let audit = end.goal.and_then(|goal| goal.audit);
        let wrong = end.estimates.centre.and_then(|it| it.error);
        Self {
            reason: end.reason.into_owned(),
            wrong: wrong.map_or(1.0, |it| it.misclassified),
            audit: audit.map(|it| {
                let labels = it.agreed + it.disagreed.expect("labels may be wrong");
                [labels as f64, it.motions as f64, it.metres]
            }),
        }
    }

    fn is_known(&self) -> bool {
        self.reason == "known"
    }
}

fn percent(flown: &[Flown], of: impl Fn(&Flown) -> bool) -> f64 {
    100.0 * flown.iter().filter(|it| of(it)).count() as f64 / flown.len() as f64
}

#[test]
fn a_straight_line_is_rarely_accused() {
    for (p, degrees) in [(0.9, 4.0), (0.9, 2.0), (0.8, 6.0)] {
        let numbers = (0..cases(40, 2_000)).into_par_iter();
        let flown: Vec<_> = numbers.map(|it| Flown::of(it, p, degrees, None)).collect();
        let audits: Vec<_> =
            flown.iter().filter(|it| it.is_known()).filter_map(|it| it.audit).collect();
        let mean = |k: usize| audits.iter().map(|it| it[k]).sum::<f64>() / audits.len() as f64;
        let [known, refuted] =
            ["known", "no line"].map(|reason| percent(&flown, |it| it.reason == reason));
        let [labels, motions, metres] = [0, 1, 2].map(mean);
        println!(
            "p = {p}, {degrees} deg: {known:.1} % known, {refuted:.2} % refuted of {}; the audit took {labels:.1} \
             labels, {motions:.1} motions, {metres:.1} m",
            flown.len()
        );
        assert!(refuted <= 1.0 && labels >= 6.0, "{refuted}, {labels}");
    }
}

#[test]
fn sensors_that_fail_are_found_out() {
    let stuck = FaultKind::Stuck(Label::Positive);
    for (kind, most) in [(stuck, 5.0), (FaultKind::Inverted, 20.0), (FaultKind::Garbage, 20.0)] {
        for from in [1, 5, 10] {
            let fault = Some(Fault { kind, from, to: u32::MAX });
            let numbers = (0..cases(40, 600)).into_par_iter();
            let flown: Vec<_> = numbers.map(|it| Flown::of(it, 0.9, 4.0, fault)).collect();
            let wrong = percent(&flown, |it| it.wrong > 0.05);
            let known = percent(&flown, Flown::is_known);
            let silent = percent(&flown, |it| it.wrong > 0.05 && it.is_known());
            println!(
                "{kind:?} from label {from}: {wrong:.1} % wrong by over 5 % of the area, {known:.1} % known, \
                 {silent:.1} % both, of {}",
                flown.len()
            );
            assert!(silent <= most, "{kind:?} from {from}: {silent}");
        }
    }
}
