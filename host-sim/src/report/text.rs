//! What happened, in plain words and figures.

use std::fmt::Write as _;

use nalgebra::Point2;
use planner_core::belief::estimate::Estimates;
use planner_core::belief::hypotheses::Prior;
use planner_core::belief::posterior::Posterior;
use planner_core::belief::sample::Reading;
use planner_core::geometry::line::Line;
use planner_core::planner::{Recovery, StopReason};
use planner_core::robot::agent::Step;

use crate::campaign::noisy::limit;
use crate::mission::definition::{Algorithm, End, Table};
use crate::mission::recording::{LEVEL, Outcome, Recorded, Recording, stage_name};
use crate::world::polygon::misclassified;
use crate::world::truth::{self, reading};

/// Slope intervals as text.
pub fn arcs(intervals: &[[f64; 2]]) -> String {
    let one = |[from, to]: &[f64; 2]| format!("{from:.2} to {to:.2}");
    intervals.iter().map(one).collect::<Vec<_>>().join(" or ")
}

/// An intercept range as text.
pub fn range(intercept: Option<[f64; 2]>) -> String {
    intercept.map_or("unbounded".into(), |[low, high]| format!("{low:.3} to {high:.3}"))
}

/// A line as text, with its angle: `z` by `x`, or, where it is steep, `x` by `z`.
pub fn line(line: &Line) -> String {
    /// Beyond this slope the intercept says little.
    const STEEP: f64 = 10.0;
    let ([a, b, c], angle) = (line.coefficients(), line.angle_deg());
    match (line.slope(), line.intercept()) {
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

/// Names and lines of a mission's estimates, the recommended one first.
pub fn estimates(recording: &Recording) -> [(&'static str, Option<Line>); 3] {
    let names = match recording.outcome {
        Outcome::Lines(_) => NAMES,
        Outcome::Hypotheses(_) => ["posterior mean", "margin of the likeliest", BISECTOR],
    };
    named(names, &recording.estimates())
}

const BISECTOR: &str = "bisector (the paper's)";

/// What the estimates are called that follow from all labels being true.
pub const NAMES: [&str; 3] = ["centre of the version space", "maximum margin", BISECTOR];

/// The estimates with these names, the recommended one first.
pub fn named(
    [centre, margin, bisector]: [&'static str; 3],
    estimates: &Estimates,
) -> [(&'static str, Option<Line>); 3] {
    [(centre, estimates.centre), (margin, estimates.maximum_margin), (bisector, estimates.bisector)]
}

/// A step's motion in columns: number, problem, turn, drive, place.
fn motion(number: usize, step: &Step) -> String {
    let at = Point2::<f64>::from(step.pose.site);
    format!(
        "{number:>4}  {:<7} {:>8.1} {:>5.1}  {:<16}",
        step.motion.stage.map_or("-", stage_name),
        f64::from(step.motion.control.w).to_degrees(),
        step.motion.control.v,
        format!("({:.3}, {:.3})", at.x, at.y),
    )
}

fn note(recorded: &Recorded, flipped: bool) -> &'static str {
    match (recorded.step.motion.recovery, recorded.step.reading) {
        (Some(Recovery::Reorient), _) => "nothing uncertain ahead: turns in place",
        (Some(Recovery::Transit), _) => "nothing uncertain near: drives on",
        (_, Some(Reading::Boundary)) => "exactly on the line: no flip",
        (Some(Recovery::Undirected), _) if flipped => "no way across: any direction; flipped",
        (Some(Recovery::Undirected), _) => "no way across: any direction",
        _ if flipped => "the label flipped",
        _ => "",
    }
}

/// The story of a mission: a table of steps, then the estimates beside the truth.
pub fn mission(title: &str, recording: &Recording) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_mission(&mut text, title, recording);
    text
}

/// A noisy mission: what was seen, what it says, how much.
fn write_noisy_steps(text: &mut String, recording: &Recording) -> std::fmt::Result {
    writeln!(
        text,
        "{:>4}  {:<7} {:>8} {:>5}  {:<16} {:>5} {:>6} {:>10} {:>7} {:>5}  {:<26}",
        "step",
        "problem",
        "turn deg",
        "go m",
        "now at m",
        "label",
        "in fact",
        "hypotheses",
        "entropy",
        "bits",
        "slopes of the 90 % set, deg"
    )?;
    for (recorded, number) in recording.steps.iter().zip(1..) {
        let (step, Some(noisy)) = (&recorded.step, recorded.noisy) else { continue };
        let fact = reading(&recording.mission.truth, step.pose.site);
        let seen = |reading: Reading| format!("{:+}", reading.sign());
        let wrong = if step.reading.is_some_and(|seen| seen != fact) { " !" } else { "  " };
        writeln!(
            text,
            "{} {:>5} {:>6} {:>10} {:>7.2} {:>5.2}  {}{}",
            motion(number, step),
            step.reading.map_or("-".into(), seen),
            format!("{}{wrong}", seen(fact)),
            noisy.hypotheses,
            noisy.entropy,
            recorded.bits,
            arcs(&recorded.slope_arcs),
            if noisy.trusted { "  (trusted)" } else { "" },
        )?;
    }
    Ok(())
}

fn write_outcome(text: &mut String, recording: &Recording, table: &Table) -> std::fmt::Result {
    let truth = |inside: bool| if inside { "holds the truth" } else { "misses the truth" };
    let line = &recording.mission.truth;
    let holds = |hypothesis| truth::agrees(line, table.candidates(hypothesis));
    let by_sequences = table.weighed_by(Prior::Sequences);
    if let Some(best) = Posterior::new(&by_sequences).best() {
        writeln!(
            text,
            "Most likely hypothesis (the paper's outcome): slope {} deg, intercept {} m, \
             probability {:.2}; {}",
            arcs(&best.slope_arc.intervals_deg()),
            range(best.intercept),
            best.probability,
            truth(holds(best.hypothesis)),
        )?;
    }
    let posterior = Posterior::new(table);
    let set = posterior.credible(LEVEL);
    writeln!(
        text,
        "Credible set: slope {} deg, intercept {} m, probability {:.2} in {} of {} hypotheses; {}\n",
        arcs(&set.slope_arc.intervals_deg()),
        range(set.intercept),
        set.probability,
        set.cells,
        table.iter().len(),
        truth(posterior.members(&set).any(holds)),
    )
}

fn write_steps(text: &mut String, recording: &Recording) -> std::fmt::Result {
    let mission = &recording.mission;
    writeln!(
        text,
        "{:>4}  {:<7} {:>8} {:>5}  {:<16} {:>5}  {:<26} {:<19} {:>5}",
        "step",
        "problem",
        "turn deg",
        "go m",
        "now at m",
        "label",
        "slopes left, deg",
        "intercepts left, m",
        "bits"
    )?;
    let mut past = mission.space.first_label();
    for (recorded, number) in recording.steps.iter().zip(1..) {
        let step = &recorded.step;
        let mut flipped = false;
        if let Some(Reading::Side(label)) = step.reading {
            flipped = label != past;
            past = label;
        }
        writeln!(
            text,
            "{} {:>5}  {:<26} {:<19} {:>5.2}  {}",
            motion(number, step),
            step.reading.map_or("-".into(), |r| format!("{:+}", r.sign())),
            arcs(&recorded.slope_arcs),
            range(recorded.intercept),
            recorded.bits,
            if mission.algorithm == Algorithm::Random { "" } else { note(recorded, flipped) },
        )?;
    }
    Ok(())
}

fn write_mission(text: &mut String, title: &str, recording: &Recording) -> std::fmt::Result {
    let mission = &recording.mission;
    writeln!(text, "{title}")?;
    writeln!(text, "True line, unknown to the agent: {}", line(&mission.truth))?;
    let oracle: Vec<_> = mission
        .space
        .samples()
        .iter()
        .map(|s| {
            let at = Point2::<f64>::from(s.site);
            format!("({}, {}) is {:+}", at.x, at.y, s.label.sign())
        })
        .collect();
    writeln!(text, "The oracle's points: {}", oracle.join(", "))?;
    let (at, heading) = (Point2::<f64>::from(mission.start.site), mission.start.heading);
    writeln!(
        text,
        "It starts at ({}, {}), heading {:.1} deg; slopes {} deg are possible.\n",
        at.x,
        at.y,
        heading.radians().to_degrees(),
        arcs(&mission.space.slope_arc().intervals_deg()),
    )?;
    if let Some(noise) = mission.noise {
        let each = limit(noise.p);
        writeln!(
            text,
            "A label is true with probability {}, so it tells {each:.3} bits at most on average, \
             {} of them {:.2}.\n",
            noise.p,
            mission.steps,
            f64::from(mission.steps) * each,
        )?;
    }
    match &recording.outcome {
        Outcome::Lines(_) => write_steps(text, recording)?,
        Outcome::Hypotheses(_) => write_noisy_steps(text, recording)?,
    }
    let why = match recording.end {
        End::Steps => "all steps are taken",
        End::Stopped(StopReason::Resolution) => {
            "what is uncertain is thinner than the action grid can hit"
        }
        End::Stopped(_) => recording.end.name(),
    };
    writeln!(
        text,
        "\nEnded: {why}. {} samples in {} steps, {:.1} m travelled, control cost {:.1}.\n",
        recording.samples(),
        recording.steps.len(),
        recording.travelled(),
        recording.cost(),
    )?;
    if let Outcome::Hypotheses(table) = &recording.outcome {
        write_outcome(text, recording, table)?;
    }
    writeln!(text, "{:<28} {:<36} {:>9} {:>13}", "", "line", "error deg", "misclassified")?;
    writeln!(text, "{:<28} {:<36}", "truth", line(&mission.truth))?;
    for (name, estimate) in estimates(recording) {
        match estimate {
            Some(estimate) => writeln!(
                text,
                "{name:<28} {:<36} {:>9.3} {:>12.3}%",
                line(&estimate),
                estimate.angle_to_deg(&mission.truth),
                100.0 * misclassified(mission.config.area, &mission.truth, &estimate),
            )?,
            None => writeln!(text, "{name:<28} none")?,
        }
    }
    Ok(())
}
