//! The audit before a goal's promise where labels may be wrong: it rarely accuses a straight line, and it finds sensors
//! that fail.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::recording::Recording;
use host_sim::world::faults::{Fault, FaultKind};
use planner_core::{Goal, Label};
use tests::ensemble::{self, expect, mean, noisy, percent};
use tests::{cases, is_long};

/// What a mission came to.
struct Flown {
    is_known: bool,
    is_refuted: bool,
    /// Its estimate misclassifies over 5 % of the area.
    is_wrong: bool,
    /// Labels of the audit.
    audited: Option<f64>,
}

fn fly(p: f64, degrees: f64, fault: Option<Fault>, fields: u64) -> Vec<Flown> {
    ensemble::fly(fields, |number| {
        let mission = standard_field::standard(44, number, Algorithm::Lookahead, 600);
        let mut mission = noisy(mission, p, 0.5);
        mission.goal = Some(Goal::slope_within_degrees(degrees).expect("an angle").into());
        mission.sensor = fault.into_iter().collect();
        let end = Recording::of(&mission).expect("doubtful labels").results.end;
        let is_known = end.reason == "known";
        let audit = end.goal.and_then(|goal| goal.audit).filter(|_| is_known);
        let error = end.estimates.centre.and_then(|it| it.error);
        Flown {
            is_known,
            is_refuted: end.reason == "no line",
            is_wrong: error.is_none_or(|it| it.misclassified > 0.05),
            audited: audit.map(|it| (it.agreed + it.disagreed.unwrap_or(0)) as f64),
        }
    })
}

#[test]
fn a_straight_line_is_rarely_accused() {
    for (p, degrees) in [(0.9, 4.0), (0.9, 2.0), (0.8, 6.0)] {
        let flown = fly(p, degrees, None, cases(40, 2_000));
        let what = format!("p = {p}, {degrees} deg");
        expect(format!("{what}, refuted"), percent(&flown, |it| it.is_refuted), ..=1.0);
        expect(format!("{what}, audit"), mean(flown.iter().filter_map(|it| it.audited)), 6.0..);
    }
}

#[test]
fn sensors_that_fail_are_found_out() {
    let stuck = FaultKind::Stuck(Label::Positive);
    for (kind, most) in [(stuck, 5.0), (FaultKind::Inverted, 20.0), (FaultKind::Garbage, 20.0)] {
        for &from in if is_long() { &[1, 5, 10][..] } else { &[5] } {
            let fault = Some(Fault { kind, from, to: u32::MAX });
            let flown = fly(0.9, 4.0, fault, cases(40, 600));
            let wrong = percent(&flown, |it| it.is_wrong);
            let silent = percent(&flown, |it| it.is_wrong && it.is_known);
            expect(format!("{kind:?} from {from}: {wrong:.1} % wrong, known"), silent, ..=most);
        }
    }
}
