//! A mission's results in plain words and figures.

use std::fmt::Write as _;

use planner_core::Line;
use planner_core::watch::{Alarm, Suspect};

use crate::mission::algorithm::Algorithm;
use crate::mission::allowance::{ToleranceRecord, tidy};
use crate::mission::from_nothing::SeekRecord;
use crate::mission::results::{
    AUDIT, AlarmRecord, End, FitRecord, LineRecord, PTold, ReliabilityRecord, Results,
    SampleRecord, Start, StepResult,
};
use crate::mission::stop::{AuditRecord, GoalRecord};
use crate::mission::vehicle::VehicleTable;
use crate::output::plain;
use crate::report::table::{Cells, Column, Table};
use crate::report::{diagnosis, front};
use crate::world::boundary::{BoundaryRecord, CoastRecord};
use crate::world::noise::limit;

/// Slope intervals as text.
pub fn arcs(intervals: &[[f64; 2]]) -> String {
    let one = |[from, to]: &[f64; 2]| format!("{} to {}", fixed(*from, 2), fixed(*to, 2));
    intervals.iter().map(one).collect::<Vec<_>>().join(" or ")
}

/// An intercept range as text.
pub fn range(intercept: Option<[f64; 2]>) -> String {
    intercept.map_or("unbounded".into(), |[low, high]| {
        format!("{} to {}", fixed(low, 3), fixed(high, 3))
    })
}

/// A number with this many decimal places. Zero has no sign.
pub(crate) fn fixed(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    let is_nothing = text.bytes().all(|it| b"-0.".contains(&it));
    if is_nothing { text.replace('-', "") } else { text }
}

/// A line as text, with its angle: `z` by `x`, or, where it is steep, `x` by `z`.
pub fn line(line: &LineRecord) -> String {
    /// Beyond this slope the intercept says little.
    const STEEP: f64 = 10.0;
    let &LineRecord { slope, intercept, angle, coefficients: [a, b, c], .. } = line;
    match (slope, intercept) {
        (Some(slope), Some(intercept)) if slope.abs() <= STEEP => {
            format!("z = {slope:.4} x {intercept:+.4}   ({angle:.2} deg)")
        }
        (None, _) => format!("x = {:.4}   (vertical)", -c / a),
        _ => {
            let lean = format!("{:+.4} z", -b / a);
            let lean = if lean.ends_with("0.0000 z") { String::new() } else { format!(" {lean}") };
            format!("x = {:.4}{lean}   ({angle:.2} deg)", -c / a)
        }
    }
}

const BISECTOR: &str = "bisector (the paper's)";

/// The names of the estimates that assume all labels to be true.
pub const NAMES: [&str; 3] = ["centre of the version space", "maximum margin", BISECTOR];

/// Their names where labels may err.
const NOISY_NAMES: [&str; 3] = ["posterior mean", "margin of the likeliest", BISECTOR];

/// What the recommended estimate is called, where labels may err or not.
pub(crate) const fn recommended(labels_err: bool) -> &'static str {
    if labels_err { NOISY_NAMES[0] } else { NAMES[0] }
}

/// Names and lines of a mission's estimates, the recommended one first.
pub fn estimates(results: &Results) -> [(&'static str, Option<LineRecord>); 3] {
    let [centre, margin, bisector] = if results.end.best.is_some() { NOISY_NAMES } else { NAMES };
    let it = &results.end.estimates;
    [(centre, it.centre), (margin, it.maximum_margin), (bisector, it.bisector)]
}

/// The same, with the one that the paper prints first. For true labels it is the bisector. For labels that may err it
/// is the most likely hypothesis, which its maximum margin stands for.
pub fn printed_estimates(results: &Results) -> [(&'static str, Option<LineRecord>); 3] {
    let [centre, margin, bisector] = estimates(results);
    if results.end.best.is_some() { [margin, centre, bisector] } else { [bisector, centre, margin] }
}

/// The story of a mission: a table of steps, then the estimates beside the truth.
pub fn mission(title: &str, results: &Results) -> String {
    story(title, results) + "\n" + &end(results, &estimates(results))
}

/// The story of a mission as the paper prints it, with its own estimate first.
pub fn printed(title: &str, results: &Results) -> String {
    let by_its_prior = if results.end.best.is_some() {
        "Bits are by the paper's prior, so they are more than the labels told: it takes all sequences\n\
         for alike, however few lines realise them.\n\n"
    } else {
        ""
    };
    story(title, results) + "\n" + by_its_prior + &end(results, &printed_estimates(results))
}

/// The results of a mission, without its steps.
pub fn outcome_alone(title: &str, results: &Results) -> String {
    format!("{title}\n{}", end(results, &estimates(results)))
}

fn story(title: &str, results: &Results) -> String {
    let beginning = beginning(&results.start);
    let steps = if results.end.best.is_some() {
        noisy_steps(&results.steps)
    } else {
        steps(&results.steps, &results.start)
    };
    format!("{title}\n{beginning}{steps}")
}

fn end(results: &Results, estimates: &[(&str, Option<LineRecord>); 3]) -> String {
    let why = why(&results.end.reason);
    let mut text = format!(
        "Ended: {why}. {} samples in {} steps, {:.1} m travelled, control cost {:.1}.\n",
        results.samples(),
        results.steps.len(),
        results.travelled(),
        results.cost(),
    );
    for (of, words) in ended(results) {
        // Only what is said of a diagnosis needs its heading.
        let heading =
            if diagnosis::HEADINGS.contains(&of) { format!("{of}: ") } else { String::new() };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{heading}{}", words.trim_end());
    }
    if results.end.front.is_some() {
        return text;
    }
    text.push('\n');
    text + &outcome(&results.end) + &errors(results, estimates)
}

/// What a mission came to beside its lines: sentences with their headings.
pub(crate) fn ended(results: &Results) -> Vec<(&'static str, String)> {
    let End { reason, seek, front, goal, reliability, diagnosis, .. } = &results.end;
    let mut told = Vec::new();
    told.extend(readings(results).map(|it| ("Readings", it)));
    told.extend(seek.iter().map(|it| ("Sought", sought(it))));
    told.extend(front.iter().map(|it| ("Map", front::map(it, "step"))));
    told.extend(goal.iter().map(|it| ("Goal", promise(it, reason))));
    let is_sure = goal.is_some_and(|it| it.is_met && it.level.is_none());
    let tolerance = results.start.tolerance.filter(|_| is_sure);
    told.extend(tolerance.and_then(|it| Some(("Boundary", of_the_boundary(&it)?))));
    told.extend(reliability.iter().map(|it| ("Sensor", shown(it))));
    told.extend(warning(&results.end).map(|it| ("Warning", it)));
    told.extend(diagnosis.iter().flat_map(|it| diagnosis::told(it, &line(&it.line))));
    told.extend(remedy(results).map(|it| ("Advice", it.to_owned())));
    told
}

/// What a mission came to, in one sentence for somebody who sees it for the first time.
pub fn plainly(results: &Results) -> String {
    let End { reason, front, goal, fit, .. } = &results.end;
    let counted = |many: usize, what: &str| match many {
        1 => format!("1 {what}"),
        _ => format!("{many} {what}s"),
    };
    let is_audit = |it: &&StepResult| it.problem.as_deref() == Some(AUDIT) && it.label.is_some();
    let audit = match results.steps.iter().filter(is_audit).count() {
        0 => String::new(),
        many => format!(" ({many} of them for the audit)"),
    };
    let (steps, labels) = (results.steps.len(), counted(results.samples(), "label"));
    let took = format!("with {labels}{audit} and {}", counted(steps, "motion"));
    let why = match &**reason {
        "steps" => format!("all {steps} steps are taken"),
        _ => why(reason).to_owned(),
    };
    let off = estimates(results)[0].1.and_then(|it| it.error).filter(|_| fit.is_none());
    let is_whole = &**reason == "closed";
    match (front, goal, off) {
        (Some(map), ..) if is_whole && front::has_gaps(map) => {
            format!("The robot found the boundary, but for {:.0} m of it, {took}.", map.gaps.ceil())
        }
        (Some(_), ..) if is_whole => format!("The robot found the boundary {took}."),
        (Some(map), ..) if map.found.is_some() => {
            format!("The robot found a part of the boundary {took}: {why}.")
        }
        (None, Some(goal), _) if goal.is_met => format!("The robot found the boundary {took}."),
        (None, None, Some(error)) => {
            let degrees = fixed(error.degrees, 2);
            format!("The robot's line is {degrees} deg off the boundary {took}: {why}.")
        }
        _ => format!("The robot did NOT find the boundary {took}: {why}."),
    }
}

/// How many readings there were on the way and at the ends of motions, where there are such on the way.
fn readings(results: &Results) -> Option<String> {
    let (readings, cuts) = results.readings();
    let told = if results.start.labels_err { "were taken in" } else { "ruled out lines" };
    (readings > 0).then(|| {
        format!("{readings} readings on the way and at ends of motions; {cuts} of them {told}.")
    })
}

/// What seeking the boundary from nothing came to, in words.
fn sought(record: &SeekRecord) -> String {
    let &SeekRecord { found, labels, metres, label, radius, patch, coast } = record;
    let took = format!("{labels} labels and {metres:.1} m");
    match (found, label, radius, coast) {
        (Some(step), ..) => format!("The boundary was found at step {step}, with {took}.\n"),
        (None, Some(label), Some(radius), Some(coast)) => {
            let of_patch = patch.map_or(String::new(), |patch| {
                format!(
                    "A patch that holds a disc of {radius:.1} m is left with probability {patch:.3}, if every second area has one. \
                     A smaller one may have been missed.\n"
                )
            });
            format!(
                "All of the area most likely has the label {label}: it took {took}.\n{of_patch}\
                 A boundary that cuts off more than {:.1} m is left with probability {coast:.3}, if every second area has one.\n",
                0.5 * radius
            )
        }
        _ => format!("The boundary was not found with {took}.\n"),
    }
}

/// Why a mission ended, in words.
pub(crate) fn why(reason: &str) -> &str {
    match reason {
        "steps" => "all steps are taken",
        "labels" => "all labels are read",
        "known" => "what was asked for is known",
        "resolution" => "what is uncertain is thinner than the action grid can hit",
        "no line" => "no straight, still line explains the labels",
        "one label" => "the area most likely has one label",
        "closed" => "the robot has gone along all of the front",
        "worth" => "no label in sight was expected to carry the bits asked for",
        "tolerance" => {
            "what is uncertain is so thin that no label tells more, as positions err by the tolerance"
        }
        "samples full" => "the planner has no room for another sample",
        "outside area" => "the robot is outside the area, and no motion leads back",
        "cornered" => {
            "no motion leads to uncertain ground, as the border or a keep-out is in the way"
        }
        "undecided" => "none of the ways that a plan tries leads to uncertain ground",
        other => other,
    }
}

/// Advice on what to change so that a mission goes further, if it ended before its steps.
fn remedy(results: &Results) -> Option<&'static str> {
    let is_unmet = results.end.goal.as_ref().is_some_and(|goal| !goal.is_met);
    Some(match &*results.end.reason {
        "resolution" => "To go on, allow finer turns and speeds: turn_step, step.",
        "worth" => "To go on, ask for fewer bits a label: ask.worth (or --worth).",
        "tolerance" if results.start.tolerance.is_some() && is_unmet => {
            "This goal cannot be reached with this tolerance: accept a wider one, take a shorter stretch of the \
             boundary or less time (a smaller bend and drift), or bring better positions."
        }
        "tolerance" if results.start.tolerance.is_some() => {
            "To know more, take a shorter stretch of the boundary or less time (a smaller bend and drift), or bring \
             better positions."
        }
        "tolerance" if is_unmet => {
            "This goal cannot be reached with this tolerance: accept a wider one, or bring better positions."
        }
        "tolerance" => "To know more, bring better positions: a smaller tolerance.",
        "samples full" => "A planner with room for more samples goes on.",
        "outside area" => "Bring the robot back, or enlarge the area.",
        "cornered" => {
            "To go on, turn or move the robot by hand, allow sharper turns, or enlarge the area."
        }
        "undecided" => "To go on, allow shorter motions or finer turns, or move the robot by hand.",
        _ => return results.end.front.as_ref().and_then(front::remedy),
    })
}

/// Whether the goal is met, in words, of a mission that ended for a reason.
fn promise(goal: &GoalRecord, reason: &str) -> String {
    let &GoalRecord { slope_arc_deg, misclassified, level, is_met, audit } = goal;
    let sure = level.map_or(String::new(), |level| format!(" with probability {level} at least"));
    let is_refuted = audit.is_some_and(|audit| audit.refuted.is_some());
    let is_cut_short = is_met && audit.is_some() && reason != "known";
    let known = match () {
        () if is_cut_short => "Known, if a straight, still line fits,",
        () if is_met => "Known",
        () if is_refuted || reason == "known" => "Not known",
        () => "Not known yet",
    };
    let lines = if level.is_some() {
        "the line is one of a set of which any two"
    } else {
        "any two of the lines left"
    };
    let percent = |share: f64| (share * 1e8).round() / 1e6;
    let what = match (slope_arc_deg, misclassified) {
        (Some(degrees), _) => format!("differ by {degrees} deg at most"),
        (_, share) => {
            let percent = percent(share.unwrap_or_default());
            format!("disagree on no more than {percent} % of the area")
        }
    };
    let audit = audit.map(|it| audited(&it)).unwrap_or_default();
    let more = if is_cut_short { "The audit is not finished: allow more steps.\n" } else { "" };
    format!("{known}{sure}: {lines} {what}.\n{audit}{more}")
}

/// What a promise means for a boundary that bends or moves.
fn of_the_boundary(&ToleranceRecord { bend, drift, .. }: &ToleranceRecord) -> Option<String> {
    (bend + drift != 0.0).then(|| {
        format!(
            "If the boundary bends by at most {bend} m and moves by at most {drift} m, one of these lines was within \
             {bend} m of it at each time."
        )
    })
}

/// What an audit came to, in words.
fn audited(audit: &AuditRecord) -> String {
    let &AuditRecord { agreed, disagreed, refuted, is_by_alarm, motions, metres } = audit;
    let price = format!("{motions} motions, {metres:.1} m");
    match (refuted, disagreed) {
        (Some(step), _) if is_by_alarm => {
            format!("Refuted: up to step {step} the labels of the mission amount to an alarm.\n")
        }
        (Some(step), Some(others)) => format!(
            "Refuted: up to step {step} {others} labels disagreed where the side is all but certain, and {agreed} agreed \
             ({price}).\n"
        ),
        (None, Some(others)) => format!(
            "Audited: {agreed} labels beside the estimate agree, and {others} disagree, as labels that may be wrong do \
             ({price}).\n"
        ),
        (Some(step), None) => format!(
            "Refuted: step {step} read a label on certain ground that no line left has there, after {agreed} that agreed \
             ({price}).\n"
        ),
        (None, None) => format!("Audited: {agreed} labels on certain ground agree ({price}).\n"),
    }
}

/// What speaks against a straight, still line, or against a front as it was told, in words.
fn warning(end: &End) -> Option<String> {
    let AlarmRecord { step, evidence, suspect } = end.alarm?;
    let alarm = match suspect {
        Suspect::Coin if end.front.is_some() => front::BENDS_MORE.to_owned(),
        _ => Alarm { evidence, suspect }.to_string(),
    };
    let (name, level) = (level(evidence), Alarm::ALARM);
    let much = much(evidence);
    Some(format!("{name}: {alarm}. The evidence is {much} at step {step}; {level} is an alarm.\n"))
}

/// What evidence against the model is called.
pub(crate) fn level(evidence: f32) -> &'static str {
    if evidence >= Alarm::ALARM { "Alarm" } else { "Warning" }
}

/// The evidence against the model after a step, in words.
pub(crate) fn evidence(evidence: f32) -> String {
    let (much, level) = (much(evidence), Alarm::ALARM);
    format!("The labels speak against the model: the evidence is {much}, {level} is an alarm")
}

fn much(evidence: f32) -> String {
    if evidence < 1e4 { format!("{evidence:.0}") } else { "over 10000".to_owned() }
}

/// What a mission is, before it begins: sentences, a line each.
pub(crate) fn beginning(start: &Start) -> String {
    let mut text = String::new();
    let truth = match (&start.truth, &start.boundary) {
        (Some(truth), _) => format!("line, unknown to the agent: {}", line(truth)),
        (_, Some(boundary)) => {
            format!("boundary, unknown to the agent: {}", self::boundary(boundary))
        }
        _ => "line, unknown to the agent: not known".into(),
    };
    // Writing to a string cannot fail.
    let _ = writeln!(text, "True {truth}\n{}", given(start));
    if let Some(told) = &start.tolerance {
        let _ = writeln!(text, "{}.", tolerance(told));
    }
    if let Some(faults) = faults(start) {
        let _ = writeln!(text, "The sensor fails, unknown to the agent: {faults}");
    }
    let _ = writeln!(
        text,
        "It starts at ({}, {}), heading {} deg{}\n",
        tidy(start.pose.x),
        tidy(start.pose.z),
        fixed(start.pose.heading.to_degrees(), 1),
        possible(start),
    );
    if let Some(price) = start.price {
        let _ = writeln!(text, "A label costs as much as {price} m of driving.\n");
    }
    if let Some(worth) = start.worth {
        let _ =
            writeln!(text, "A label is read where it is expected to carry {worth} bits or more.\n");
    }
    if start.labels_err {
        let (each, most) = (limit(start.p), start.labels.unwrap_or(start.steps));
        let _ = writeln!(
            text,
            "{} is true with probability {}, so it tells {each:.3} bits at most on average, \
             {} of them {:.2}.\n",
            a_label(start),
            start.p,
            most,
            f64::from(most) * each,
        );
        if let Some(told) = told(start) {
            let _ = writeln!(text, "{told}\n");
        }
    }
    text
}

/// What is possible at the start, at the end of a sentence.
fn possible(start: &Start) -> String {
    let slopes = || format!("; slopes {} deg are possible.", arcs(&start.slope_arcs));
    let radius = start.vehicle.as_ref().and_then(VehicleTable::radius);
    start.front.as_ref().map_or_else(slopes, |told| format!(".\n{}", front::told(told, radius)))
}

/// The oracle's points, what is known of the line beside them, and what others read before: a line of text each.
pub(crate) fn given(start: &Start) -> String {
    let points = |what, samples: &[SampleRecord]| {
        let points = samples.iter();
        let points = points.map(|s| format!("({}, {}) is {:+}", tidy(s.x), tidy(s.z), s.label));
        let points = points.collect::<Vec<_>>().join(", ");
        (!points.is_empty()).then(|| format!("{what}: {points}"))
    };
    let known = Some(known(start)).filter(|it| !it.is_empty());
    let oracle = points("The oracle's points", &start.oracle).into_iter();
    let before = points("Read before the first step", &start.samples);
    oracle.chain(known).chain(before).collect::<Vec<_>>().join("\n")
}

/// What is known of the line beside the oracle's points, if anything.
fn known(start: &Start) -> String {
    let bounds = start.bounds.unwrap_or_default();
    let slope = bounds.slope.map(|[a, b]| format!("it runs at {a} to {b} deg"));
    let intercept = bounds.intercept.map(|[a, b]| format!("it crosses x = 0 at z = {a} to {b}"));
    let known: Vec<_> = slope.into_iter().chain(intercept).collect();
    if known.is_empty() {
        String::new()
    } else {
        format!("Known of the line: {}", known.join(", "))
    }
}

/// The tolerance and its parts, in words.
fn tolerance(told: &ToleranceRecord) -> String {
    format!(
        "The planner takes a label to be true of the straight line within {} of the reported position",
        told.words()
    )
}

/// What planners are told of how often labels are true, if that is another thing.
fn told(start: &Start) -> Option<String> {
    Some(match start.p_told? {
        PTold::Number(p) => format!("The planner takes it to be true with probability {p}."),
        PTold::Beta([a, b]) => {
            let mean = fixed(a / (a + b), 3);
            format!(
                "The planner does not know this probability: its prior is Beta({a}, {b}), with the mean {mean}."
            )
        }
    })
}

/// What labels have shown of how often they are true, in words.
fn shown(&ReliabilityRecord { mean, deviation }: &ReliabilityRecord) -> String {
    let [mean, deviation] = [mean, deviation].map(|it| fixed(it, 3));
    format!(
        "Labels are true with a probability of {mean} +- {deviation}, as they show themselves.\n"
    )
}

/// A boundary that is no fixed line, in words.
fn boundary(record: &BoundaryRecord) -> String {
    let base = || record.line.and_then(|[a, b, c]| Line::from_coefficients(a, b, c));
    let base = base().map_or(String::new(), |line| {
        let words = self::line(&line.into());
        words.split_whitespace().collect::<Vec<_>>().join(" ")
    });
    let drift = record.drift.filter(|_| record.line.is_none() || record.sine.is_some());
    let moves = drift.map_or(String::new(), |[x, z]| {
        format!("; each motion moves it by {x} m along x and {z} m along z")
    });
    let what = match record {
        BoundaryRecord { circle: Some([x, z, radius]), .. } => {
            format!("a circle about ({x}, {z}) with a radius of {radius} m, +1 inside")
        }
        BoundaryRecord { sine: Some([height, length, phase]), .. } => format!(
            "a sine of height {height} m, length {length} m and phase {phase} rad about {base}"
        ),
        BoundaryRecord { polyline: Some(points), .. } => {
            format!("a polyline through {} points, +1 above", points.len())
        }
        BoundaryRecord { polygon: Some(corners), .. } => {
            format!("a polygon of {} corners, +1 inside", corners.len())
        }
        BoundaryRecord { raster: Some(file), threshold: Some(threshold), .. } => {
            format!("the raster {}, +1 from {threshold} up", plain::name(file))
        }
        BoundaryRecord { geojson: Some(file), .. } => {
            format!("the polygons of {}, +1 inside", plain::name(file))
        }
        BoundaryRecord { drift: Some([offset, turn]), .. } => {
            format!(
                "{base} at the start; each motion moves it by {offset} m and turns it by {turn} deg"
            )
        }
        BoundaryRecord { coast: Some(CoastRecord { height, length, seed }), .. } => format!(
            "a random coast (seed {seed}), its heights {height} m and alike over {length} m, +1 above"
        ),
        _ => "not known".to_owned(),
    };
    what + &moves
}

/// How the sensor fails, if it does.
fn faults(start: &Start) -> Option<String> {
    let each = start.sensor.iter().map(ToString::to_string).collect::<Vec<_>>();
    (!each.is_empty()).then(|| each.join("; "))
}

/// A label that no fault of the sensor spoils, at the beginning of a sentence.
fn a_label(start: &Start) -> &'static str {
    if start.sensor.is_empty() { "A label" } else { "A label that no fault spoils" }
}

/// The columns of a step's motion.
const MOTION: [Cells<'static, StepResult>; 5] = [
    (Column::right("step", 4), &|it| it.step.to_string()),
    (Column::left("problem", 7).apart(), &|it| it.problem.as_deref().unwrap_or("-").to_owned()),
    (Column::right("turn deg", 8), &|it| fixed(f64::from(it.action.w).to_degrees(), 1)),
    (Column::right("go m", 5), &|it| fixed(it.action.v.into(), 1)),
    (Column::left("now at m", 16).apart(), &|it| {
        format!("({}, {})", fixed(it.pose.x, 3), fixed(it.pose.z, 3))
    }),
];

pub(crate) fn signed(label: Option<i8>) -> String {
    label.map_or("-".into(), |label| format!("{label:+}"))
}

/// The steps of a mission with true labels, and what these leave.
fn steps(steps: &[StepResult], start: &Start) -> Table {
    if start.front.is_some() {
        let label: [Cells<StepResult>; 1] = [(Column::right("label", 5), &|it| {
            signed(it.label) + if it.is_wrong() { " !" } else { "  " }
        })];
        return Table::of(steps, &[&MOTION[..], &label, &front::KNOWN].concat());
    }
    let notes = notes(steps, start);
    let left: [Cells<StepResult>; 5] = [
        (Column::right("label", 5), &|it| signed(it.label)),
        (Column::left("slopes left, deg", 26).apart(), &|it| arcs(&it.slope_arcs)),
        (Column::left("intercepts left, m", 19), &|it| range(it.intercept)),
        (Column::right("bits", 5), &|it| fixed(it.bits, 2)),
        (Column::left("", 0).apart(), &|it| notes[it.step - 1].to_owned()),
    ];
    Table::of(steps, &[&MOTION[..], &left].concat())
}

/// What is worth a note, for each step.
fn notes(steps: &[StepResult], start: &Start) -> Vec<&'static str> {
    if start.algorithm == Algorithm::Random {
        return vec![""; steps.len()];
    }
    let mut past = start.oracle.first().map_or(0, |first| first.label);
    let noted = steps.iter().map(|step| {
        let label = step.label.filter(|label| *label != 0);
        let flipped = label.is_some_and(|label| label != past);
        past = label.unwrap_or(past);
        let is_spoilt = !start.sensor.is_empty() && step.is_wrong();
        if is_spoilt { "the label is wrong" } else { note(step, flipped) }
    });
    noted.collect()
}

fn note(step: &StepResult, flipped: bool) -> &'static str {
    match (step.recovery.as_deref(), step.label) {
        (Some("reorient"), _) => "nothing uncertain ahead: turns in place",
        (Some("transit"), _) => "nothing uncertain near: drives on",
        _ if step.problem.as_deref() == Some(AUDIT) => "",
        (_, Some(0)) => "exactly on the line: no flip",
        (Some("undirected"), _) if flipped => "no way across: any direction; flipped",
        (Some("undirected"), _) => "no way across: any direction",
        _ if flipped => "the label flipped",
        _ => "",
    }
}

/// The steps of a mission whose labels may err: what was seen, what was true, and what is known.
fn noisy_steps(steps: &[StepResult]) -> Table {
    let wrong = |it: &StepResult| if it.is_wrong() { " !" } else { "  " };
    let trusted = |it: &StepResult| if it.trusted == Some(true) { "  (trusted)" } else { "" };
    let said: [Cells<StepResult>; 6] = [
        (Column::right("label", 5), &|it| signed(it.label)),
        (Column::right("in fact", 6), &|it| signed(it.fact) + wrong(it)),
        (Column::right("hypotheses", 10), &|it| it.hypotheses.unwrap_or_default().to_string()),
        (Column::right("entropy", 7), &|it| fixed(it.entropy.unwrap_or_default(), 2)),
        (Column::right("bits", 5), &|it| fixed(it.bits, 2)),
        (Column::left("slopes of the 90 % set, deg", 0).apart(), &|it| {
            arcs(&it.slope_arcs) + trusted(it)
        }),
    ];
    Table::of(steps, &[&MOTION[..], &said].concat())
}

fn outcome(end: &End) -> String {
    let (Some(best), Some(credible)) = (&end.best, &end.credible) else { return String::new() };
    let truth = |holds: Option<bool>| match holds {
        Some(true) => "; holds the truth",
        Some(false) => "; misses the truth",
        None => "",
    };
    format!(
        "Most likely hypothesis (the paper's outcome): slope {} deg, intercept {} m, \
         probability {:.2}{}\n\
         Credible set: slope {} deg, intercept {} m, probability {:.2} in {} of {} hypotheses{}\n\n",
        arcs(&best.slope_arcs),
        range(best.intercept),
        best.probability,
        truth(best.holds),
        arcs(&credible.slope_arcs),
        range(credible.intercept),
        credible.probability,
        credible.cells.unwrap_or_default(),
        credible.hypotheses,
        truth(credible.holds),
    )
}

/// The estimates beside the truth.
fn errors(results: &Results, estimates: &[(&str, Option<LineRecord>); 3]) -> String {
    let mut table = Table::new([
        Column::left("", 28),
        Column::left("line", 36),
        Column::right("error deg", 9),
        Column::right("misclassified", 13),
    ]);
    if let Some(truth) = &results.start.truth {
        table.row(["truth".into(), line(truth)]);
    }
    if let Some(FitRecord { line: best, misclassified, .. }) = results.end.fit.as_deref() {
        let share = format!("{:.3}%", 100.0 * misclassified);
        table.row(["line that fits best".into(), line(best), String::new(), share]);
    }
    // Where no line explains the labels, the others may be anywhere.
    let is_line = results.end.fit.is_none() && results.end.diagnosis.is_none();
    for &(name, estimate) in &estimates[..if is_line { estimates.len() } else { 1 }] {
        let Some(estimate) = estimate else {
            table.line(&format!("{name:<28} none"));
            continue;
        };
        let error = estimate.error.map(|error| {
            [format!("{:.3}", error.degrees), format!("{:.3}%", 100.0 * error.misclassified)]
        });
        table.row([name.into(), line(&estimate)].into_iter().chain(error.into_iter().flatten()));
    }
    table.to_string()
}
