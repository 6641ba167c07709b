//! A step of a mission in words: what was planned, what was expected of it, what was read, what is known.

use std::iter;

use planner_core::AnyVehicle;
use serde::Serialize;

use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::front::VertexRecord;
use crate::mission::read_out::{Expectation, Knowledge};
use crate::mission::results::{AUDIT, LineRecord, Results, Start, StepResult};
use crate::report::text;

/// A sentence under its heading.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Told {
    /// The heading, a word.
    pub(crate) of: &'static str,
    /// The sentence.
    pub(crate) text: String,
}

impl Told {
    pub(crate) fn new(of: &'static str, text: impl Into<String>) -> Self {
        Self { of, text: text.into() }
    }
}

/// The sentences for a step, with the increase of the information in bits, or for the start without one. They get what
/// is known with the bits learnt, and the recommended estimate.
pub(crate) fn stage(
    (mission, start): (&Mission, &Start),
    step: Option<(&StepResult, f64)>,
    (knowledge, bits): (&Knowledge, f64),
    estimate: Option<&LineRecord>,
) -> Vec<Told> {
    let mut told = if let Some((step, rise)) = step {
        vec![
            Told::new("Planned", planned(mission, step)),
            Told::new("Expected", expected(step.expected)),
            Told::new("Read", read(step, rise)),
        ]
    } else {
        vec![Told::new("Given", given(start))]
    };
    let evidence = step.and_then(|(step, _)| step.evidence);
    told.extend(evidence.map(|it| Told::new(text::level(it), format!("{}.", text::evidence(it)))));
    if !mission.algorithm.seeks_line() {
        let found = step.and_then(|(step, _)| step.front);
        told.push(Told::new("Front", found.map_or("not known.".into(), |it| on_front(&it))));
        return told;
    }
    told.push(Told::new("Known", known(knowledge, bits)));
    let name = text::recommended(mission.is_noisy());
    told.push(Told::new("Estimate", estimated(name, estimate, start)));
    told
}

/// Where a front is known best.
fn on_front(vertex: &VertexRecord) -> String {
    let &VertexRecord { x, z, heading, curvature, half_width, .. } = vertex;
    let bends = match curvature {
        bend if bend.abs() < 1e-4 => "straight".to_owned(),
        bend if bend > 0.0 => format!("bends left, radius {:.0} m", 1.0 / bend),
        bend => format!("bends right, radius {:.0} m", -1.0 / bend),
    };
    minus(&format!(
        "at ({x:.2}, {z:.2}) within {half_width:.2} m (90 %), direction {:.1} deg, {bends}.",
        heading.to_degrees()
    ))
}

/// Why a mission ended, and what it came to.
pub(crate) fn ended(results: &Results) -> impl Iterator<Item = Told> {
    let why = ("Ended", format!("{}.", text::why(&results.end.reason)));
    let all = iter::once(why).chain(text::ended(results));
    all.map(|(of, words)| Told::new(of, minus(&sentence(words.trim_end()))))
}

/// What a mission is, before it begins, but the places: the map shows them.
pub(crate) fn about(start: &Start) -> Vec<String> {
    const PLACES: [&str; 3] = ["It starts at", "The oracle's points", "Read before"];
    let beginning = text::beginning(start);
    let is_told = |it: &&str| !it.is_empty() && !PLACES.iter().any(|place| it.starts_with(place));
    beginning.lines().filter(is_told).map(minus).collect()
}

fn given(start: &Start) -> String {
    let given = text::given(start);
    let lines = given.lines().filter(|it| !it.is_empty()).map(|it| format!("{it}."));
    minus(&lines.collect::<Vec<_>>().join(" "))
}

/// The planner's choice, and the likely reason for it.
fn planned(mission: &Mission, step: &StepResult) -> String {
    let why = match (step.problem.as_deref(), step.recovery.as_deref()) {
        (Some("seek"), _) => "The front is not known, so it is sought",
        (Some("follow"), _) => "Along the front, as far as it is known",
        (Some("pass"), _) => "Round a keep-out on the front",
        (Some("return"), _) => "Back to the front",
        (_, Some("reorient")) => "Nothing uncertain ahead, so it turns in place",
        (_, Some("transit")) => "Nothing uncertain in reach, so it drives on",
        (Some("P1"), None) => "P1, look for the opposite label",
        (Some("P2"), None) => "P2, follow the boundary",
        (Some("P3"), None) => "P3, explore where no hypothesis has the boundary run",
        (Some(AUDIT), _) => {
            "An audit: to certain ground beside the estimate, where all lines left agree"
        }
        (Some("P4"), None) => "P4, explore where some hypothesis has the boundary run",
        (Some("P1"), Some(_)) => "P1, no way across, so in any direction",
        (Some("P2"), Some(_)) => "P2, no way along, so in any direction",
        (_, Some(_)) => "No way in the problem's directions, so in any",
        (_, None) => match mission.algorithm {
            Algorithm::Lookahead if mission.asking.price.is_some() && step.expected.is_none() => {
                "On the way to the place whose label is worth the most"
            }
            Algorithm::Lookahead if mission.asking.price.is_some() => {
                "Where a label is worth the most for its price and the way"
            }
            Algorithm::Lookahead => "Where this label and the next tell the most for their cost",
            Algorithm::Chords => "The middle of what is left of a chord, or beside it",
            Algorithm::Margin => "The place in reach nearest to the maximum-margin line",
            Algorithm::Lawnmower => "Along the tracks of its survey",
            _ => "At random",
        },
    };
    let unproven =
        if step.proven == Some(false) { " The best so far: its looks were used up." } else { "" };
    let (at, way) = (step.pose, motion(mission, step));
    format!("{why}: {way}, to ({:.3}, {:.3}).{unproven}", at.x, at.z)
}

/// The one-step problem and the rung of the recovery ladder, as the trace names them.
pub(crate) fn problem(step: &StepResult) -> String {
    let named: Vec<_> = step.problem.iter().chain(&step.recovery).map(|name| &**name).collect();
    if named.is_empty() { "\u{2013}".to_owned() } else { named.join(", ") }
}

/// How it moves.
pub(crate) fn motion(mission: &Mission, step: &StepResult) -> String {
    let degrees = f64::from(step.action.w).to_degrees();
    let side = if degrees < 0.0 { "right" } else { "left" };
    let turn = format!("{:.1} deg {side}", degrees.abs());
    let metres = step.action.v;
    let is_car = matches!(mission.vehicle, AnyVehicle::Car(_));
    match (degrees.abs() < 0.05, metres > 0.0) {
        (true, _) => format!("straight on for {metres:.1} m"),
        (false, true) if is_car => format!("an arc of {metres:.1} m that turns {turn}"),
        (false, true) => format!("turn {turn}, go {metres:.1} m"),
        (false, false) => format!("turn {turn}"),
    }
}

fn expected(expectation: Option<Expectation>) -> String {
    expectation.map_or("No label is asked for.".into(), |Expectation { chance, bits }| {
        format!("+1 with a chance of {:.0} %; {bits:.3} bits on average.", 100.0 * chance)
    })
}

fn read(step: &StepResult, rise: f64) -> String {
    let Some(label) = step.label else { return "Nothing.".into() };
    let judged = match label {
        0 => ", exactly on the line",
        _ if step.is_wrong() => ", which is wrong",
        _ => "",
    };
    let change = if rise < 0.0 { "fall" } else { "rise" };
    format!("{}{judged}. Bits told {change} by {:.3}.", signed(label), rise.abs())
}

fn known(knowledge: &Knowledge, bits: f64) -> String {
    let Knowledge { slope_arcs, intercept, doubt, .. } = knowledge;
    let (arcs, range) = (minus(&text::arcs(slope_arcs)), minus(&text::range(*intercept)));
    let metres = if intercept.is_some() { " m" } else { "" };
    let (of, doubt) = doubt.map_or((String::new(), String::new()), |doubt| {
        let entropy = text::fixed(doubt.entropy, 2);
        let many = if doubt.hypotheses == 1 { "hypothesis" } else { "hypotheses" };
        let among = format!(" {} {many}, entropy {entropy} bits.", doubt.hypotheses);
        (" of the 90 % set".to_owned(), among)
    });
    let bits = minus(&format!("{bits:.2}"));
    format!("Slopes{of} {arcs} deg, intercepts {range}{metres}. {bits} bits told so far.{doubt}")
}

fn estimated(name: &str, estimate: Option<&LineRecord>, start: &Start) -> String {
    let Some(estimate) = estimate else { return format!("{}: none.", sentence(name)) };
    let truth = if start.boundary.is_some() { "the best line" } else { "the truth" };
    let off = estimate.error.map_or(String::new(), |error| {
        let share = 100.0 * error.misclassified;
        format!(
            "; {} deg off {truth}, {} % of the area misjudged",
            small(error.degrees),
            small(share)
        )
    });
    format!("{}: {}{off}.", sentence(name), line(estimate))
}

/// A line, with single spaces.
pub(crate) fn line(record: &LineRecord) -> String {
    let words = text::line(record);
    minus(&words.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// A label with its sign, as one reads it.
pub(crate) fn signed(label: i8) -> String {
    minus(&format!("{label:+}")).replace("+0", "0")
}

/// A size that may be very small, to three digits or so.
pub(crate) fn small(size: f64) -> String {
    match size {
        _ if size == 0.0 => "0".into(),
        1.0.. => format!("{size:.2}"),
        0.01.. => format!("{size:.3}"),
        1e-5.. => format!("{size:.6}"),
        _ => format!("{size:.1e}"),
    }
}

/// With true minus signs, which screen readers say.
pub(crate) fn minus(text: &str) -> String {
    let (mut signed, mut before) = (String::with_capacity(text.len()), ' ');
    for (at, it) in text.char_indices() {
        let is_before_digit = || text[at + 1..].starts_with(|it: char| it.is_ascii_digit());
        let is_sign =
            it == '-' && !before.is_ascii_alphanumeric() && before != '-' && is_before_digit();
        signed.push(if is_sign { '\u{2212}' } else { it });
        before = it;
    }
    signed
}

fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| {
        iter::once(first.to_ascii_uppercase()).chain(letters).collect()
    })
}
