//! The paper's figures, drawn again from what is computed here. Its own pictures are lost, but their captions and the
//! text about them are not.

use anyhow::{Context as _, Result, bail};
use nalgebra::{Point2, Vector2};
use planner_core::{Label, Line, Sample};

use crate::mission::definition::Mission;
use crate::mission::given::Lines;
use crate::mission::recording::Recording;
use crate::mission::scenario::{self, Overrides, PAPER_NOISELESS, PAPER_NOISY};
use crate::report::ground::Ground;
use crate::report::look;
use crate::report::picture::{Dot, Drawn, Picture};
use crate::report::style::{BOUND, Stroke, TRUTH, dashed};
use crate::world::polygon::Polygon;

/// How many figures the paper has.
pub const FIGURES: u32 = 8;

/// Half the breadth of the band in which labels are wrong at times, metres: the paper's `c_bar`.
const BAND: f64 = 4.0;

/// A walk of 27 labels of which four of +1 and three of -1 are flipped, as in the paper's Figure 2.
const WALK_SEED: u64 = 292;

const RAY: Stroke = dashed("ray", "#5b2a86", 1.4, "7 3");
const ANGLE: Stroke = dashed("angle", "#5b2a86", 1.1, "");

/// One of the figures as an SVG document.
///
/// # Errors
/// When there is no figure of this number.
pub fn figure(number: u32) -> Result<String> {
    match number {
        1 => task(),
        2 => noisy_task(),
        3 => given_points(),
        4 => new_points(),
        5 => candidates(),
        6 => polar(),
        7 => noiseless(),
        8 => noisy(),
        _ => bail!("found figure {number}, expected 1 to {FIGURES}"),
    }
}

fn title(number: u32, what: &str) -> String {
    format!("After Figure {number} of Raghavan and Johansson: {what}")
}

fn fly(text: &str, change: fn(Mission) -> Mission) -> Result<Recording> {
    Recording::of(&change(scenario::parse("", text, Overrides::default())?))
}

/// A mission with the ground of either label, as the true line divides it.
fn divided(title: &str, note: &str, recording: &Recording) -> Result<(Picture, Line)> {
    let truth = *recording.mission.world.line().context("a mission without a line")?;
    let mut picture = Picture::of(title, recording).noting(note);
    let side = |side| Polygon::from(picture.area).clip(&truth, side);
    picture.ground = Ground::Labelled([side(1.0), side(-1.0)]);
    picture.says = ["ground whose label is", ""];
    picture.lines.clear();
    let sought = "true line, which the robot is to find";
    picture.truth = vec![Drawn::across(&picture.area, truth, TRUTH, sought)];
    Ok((picture, truth))
}

/// Figure 1, "Schematic for the motion planning problem": six labels on the way, three of each.
fn task() -> Result<String> {
    let six = PAPER_NOISELESS.replace("steps = 10", "steps = 6");
    let note = "Four labels are given. A robot starts at p1 and reads more, to find the line that divides them";
    let recording = fly(&six, Mission::by_lookahead)?;
    Ok(divided(&title(1, "the task"), note, &recording)?.0.svg())
}

/// A walk that ignores its labels, which are sometimes wrong near the line.
fn walk() -> Result<Recording> {
    let seed = format!("seed = {WALK_SEED}");
    let band = format!("noise = {{ p = 0.7, band = {BAND:?} }}");
    let text = PAPER_NOISY.replace("\"scc\"", "\"random\"").replace("steps = 10", "steps = 27");
    let text = text.replace("seed = 1", &seed).replace("varrho = 0.1\n", "");
    fly(&text.replace("noise = { p = 0.7, trusted_radius = 0.5 }", &band), |mission| mission)
}

/// Figure 2, "Schematic for the motion planning problem with noisy data": 27 labels, seven of them flipped.
fn noisy_task() -> Result<String> {
    let note = "Near the line labels are wrong 3 times in 10. The robot walks without heeding them";
    let (mut picture, truth) = divided(&title(2, "wrong labels"), note, &walk()?)?;
    let [a, b, c] = truth.coefficients();
    let shifted = |by: f64| Line::from_coefficients(a, b, c + by).context("a line");
    let area = Polygon::from(picture.area);
    picture.doubtful = area.clip(&shifted(BAND)?, 1.0).clip(&shifted(-BAND)?, -1.0);
    Ok(picture.svg())
}

/// The points of Figure 3, by what the text says of their slopes: `p4` lies a little lower than `p1`.
fn canonical() -> String {
    PAPER_NOISELESS.replace("z = 5.0, label = -1", "z = 0.5, label = -1")
}

/// Certain ground with the four samples that bound it and the lines `l_ij` through them.
fn bounded(title: &str, note: &str, recording: &Recording, four: &[Sample]) -> Result<String> {
    let area = recording.mission.config.area;
    let truth = recording.mission.world.line().context("a line")?;
    let of = |label| {
        let mut own: Vec<_> =
            four.iter().filter(|s| s.label == label).map(|s| Point2::<f64>::from(s.site)).collect();
        own.sort_by(|p, q| p.x.total_cmp(&q.x));
        own
    };
    let (negative, positive) = (of(Label::Negative), of(Label::Positive));
    let ([p1, p4], [p2, p3]) = (&negative[..], &positive[..]) else {
        bail!(
            "found {} and {} points of -1 and +1 that bound the line, expected two each",
            negative.len(),
            positive.len()
        )
    };
    let support: Vec<_> =
        recording.belief.version_space().into_iter().flat_map(Lines::support).collect();
    let mut lines = Vec::new();
    for (name, from, to) in [("l13", p1, p3), ("l14", p1, p4), ("l23", p2, p3), ("l24", p2, p4)] {
        let way = to - from;
        let line = Line::through(*from, Vector2::new(-way.y, way.x)).context("two points")?;
        let meaning = "l13 to l24, bounds of the line: through the points named";
        lines.push(Drawn::across(&area, line, BOUND, meaning).beside(name));
    }
    lines.push(Drawn::across(&area, *truth, TRUTH, "true line"));
    let one = |at: &Point2<f64>, label, meaning| Dot::new(*at, look::given(label).meaning(meaning));
    let negative = |at| one(at, Label::Negative, "one of the four points, label -1");
    let positive = |at| one(at, Label::Positive, "one of the four points, label +1");
    let picture = Picture {
        ground: Ground::certain(area, &support),
        samples: vec![negative(p1), positive(p2), positive(p3), negative(p4)],
        given: 4,
        lines,
        ..Picture::bare(title, note, area)
    };
    Ok(picture.svg())
}

/// Figure 3, "Region of certainty from the four given points".
fn given_points() -> Result<String> {
    let recording = fly(&canonical(), |mission| Mission { steps: 0, ..mission })?;
    let given = recording.mission.given.samples().to_vec();
    let note = "Every line that separates the four points labels the hatched ground alike";
    bounded(&title(3, "what four labels tell"), note, &recording, &given)
}

/// Figure 4, "Region of certainty from new four points obtained by Agent".
fn new_points() -> Result<String> {
    let recording = fly(&canonical(), |mission| Mission { steps: 7, ..mission })?;
    let support: Vec<_> =
        recording.belief.version_space().into_iter().flat_map(Lines::support).collect();
    let note =
        "After 7 steps of Algorithm 1, four labels that it read tell all; p1 to p4 are named anew";
    bounded(&title(4, "more labels"), note, &recording, &support)
}

/// Figure 5, "Possible classifiers with noisy data set".
fn candidates() -> Result<String> {
    let recording = walk()?;
    let picture =
        Picture::of_candidates(&title(5, "which line?"), &recording).context("hypotheses")?;
    let note = "The labels of Figure 2: several lines violate about as few, and one is true";
    let mut picture = picture.noting(note);
    // The paper's l3 is the one that its support vector machine finds.
    for (line, name) in picture.lines.iter_mut().zip(["l3", "l1", "l2"]) {
        line.name = format!("{name}: {}", line.name);
        line.beside = Some(name.to_owned());
    }
    Ok(picture.svg())
}

/// Figure 6, "Analysis of the problem using analytical geometry": the closest two opposite labels in polar coordinates.
fn polar() -> Result<String> {
    let recording = fly(PAPER_NOISELESS, Mission::as_printed)?;
    let note = "Opposite labels come closer: then the angles and distances of two meet on the line";
    let (mut picture, truth) = divided(&title(6, "why it converges"), note, &recording)?;
    let taken = &recording.belief.samples()[picture.given..];
    let of =
        |label| taken.iter().filter(move |s| s.label == label).map(|s| Point2::<f64>::from(s.site));
    let pairs = of(Label::Negative).flat_map(|p| of(Label::Positive).map(move |q| (p, q)));
    let apart = |(p, q): &(Point2<f64>, Point2<f64>)| (q - p).norm();
    let (p, q) = pairs.min_by(|a, b| apart(a).total_cmp(&apart(b))).context("both labels")?;
    let (origin, reach) = (Point2::origin(), 6.0);
    for (k, at) in [(1, p), (2, q)] {
        let way = at - origin;
        let meaning = "distances r1 and r2 of the closest two from the origin";
        picture.lines.push(Drawn::new(meaning, RAY, vec![vec![origin, at]]));
        let angle = libm::atan2(way.y, way.x);
        let radius = reach - 2.2 * f64::from(k - 1);
        let on = |part: u32| {
            let (sin, cos) = libm::sincos(angle * f64::from(part) / 24.0);
            origin + Vector2::new(cos, sin) * radius
        };
        let arc: Vec<_> = (0..=24).map(on).collect();
        let names = [("θ", "", arc[8]), ("r", "", origin + way * 0.75), ("p", ",ε", at)];
        picture.words.extend(names.map(|(name, of, at)| (format!("{name}{k}{of}"), at)));
        picture.lines.push(Drawn::new("their angles θ1 and θ2", ANGLE, vec![arc]));
    }
    picture.lines.push(Drawn::across(&picture.area, truth, TRUTH, "true line"));
    picture.samples.drain(..picture.given);
    Ok(Picture { truth: Vec::new(), start: None, stops: Vec::new(), given: 0, ..picture }.svg())
}

/// Figure 7, "Path of the Agent with unicycle model and noiseless observations".
fn noiseless() -> Result<String> {
    let recording = fly(PAPER_NOISELESS, Mission::as_printed)?;
    let picture = Picture::of(&title(7, "true labels"), &recording);
    let note =
        "The path of the unicycle with noiseless observations: Algorithm 1 as printed, 10 steps";
    Ok(picture.with_printed_estimate(&recording).noting(note).svg())
}

/// Figure 8, "Path of the Agent with unicycle model and noisy observations".
fn noisy() -> Result<String> {
    let recording = fly(PAPER_NOISY, Mission::as_printed)?;
    let picture = Picture::of(&title(8, "labels true 7 times in 10"), &recording);
    let note = "The path of the unicycle with noisy observations: Algorithm 2 as printed, 10 steps";
    Ok(picture.noting(note).svg())
}
