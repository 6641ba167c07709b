//! The answer that samples give: one type, however far they are trusted.

use anyhow::{Context as _, Result, anyhow};
use nalgebra::{Point2, Vector2};
use planner_core::{Area, Belief as _, Label, Line, Sample, VersionSpace, estimate};

use crate::fitting::doubt::{Doubt, Votes};
use crate::fitting::explanation::{Explanation, Question};
use crate::fitting::fewest::Fewest;
use crate::fitting::hull::{Row, in_order};
use crate::fitting::line_posterior::{Cell, LinePosterior, TooOpen};
use crate::fitting::line_set::{self, ByNormal, intercepts, slope_arcs};
use crate::fitting::outlier::{Repeats, outliers};
use crate::fitting::patch::{Mass, Patch};
use crate::fitting::separation::{NoSeparation, Separation, are_separable};
use crate::mission::read_out::LEVEL;
use crate::replay::fit_words::Words;
use crate::replay::sample_file::SampleFile;
use crate::report::picture::area_around;
use crate::world::polygon::Polygon;

/// How far samples are to be trusted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Trust {
    /// The probability that a label is true, above 1/2, if it is given; 1 is certain.
    pub p: Option<f64>,
    /// How far a position may be off at most, metres.
    pub tolerance: f64,
}

/// The reliability by which the likeliest line of labels is found that no line separates, if none is given.
const SUPPOSED: f64 = 0.9;

/// Of more samples the paper's estimate is not looked for: it compares each two.
const MOST_PAIRED: usize = 5_000;

/// As many samples as a planner holds.
const MOST_HELD: usize = 128;

/// Files with more samples are refused without an explanation.
const MOST_EXPLAINED: usize = 20_000;

/// What samples determine.
pub(crate) struct Answer {
    /// The samples that bound the lines left, of labels that are true.
    pub(crate) bounding: Vec<Sample>,
    /// The slopes of the lines left, or of the credible set, as intervals of degrees.
    pub(crate) slope_arcs: Vec<[f64; 2]>,
    /// Their intercepts, metres; `None` when unbounded.
    pub(crate) intercept: Option<[f64; 2]>,
    /// The mean of the lines.
    pub(crate) centre: Option<Line>,
    pub(crate) maximum_margin: Option<Line>,
    /// The paper's estimate, of labels and positions that are true, if they are few.
    pub(crate) bisector: Option<Line>,
    /// Metres, where positions may be off.
    pub(crate) tolerance: Option<f64>,
    /// Where labels may be wrong.
    pub(crate) doubt: Option<Doubted>,
    /// Whether a straight line explains the labels.
    pub(crate) fit: Explanation,
    /// Lines that bound the set.
    bounds: Vec<ByNormal>,
}

/// What labels that may be wrong determine.
pub(crate) struct Doubted {
    pub(crate) p: f64,
    /// The share of all lines that was left out, at most.
    pub(crate) pruned_mass: f64,
    /// The probability of the credible set.
    pub(crate) probability: f64,
    pub(crate) most_likely: Line,
    /// The samples that disagree with it, wherever within the tolerance they are.
    pub(crate) disagreeing: Vec<usize>,
}

impl Answer {
    /// The answer that the samples of a file give.
    ///
    /// # Errors
    /// Names the file, and the line where a row is the reason.
    pub(crate) fn of(file: &SampleFile, trust: Trust) -> Result<Self> {
        let p = trust.p.or(file.rows.p).unwrap_or(1.0);
        let tolerance = (trust.tolerance > 0.0).then_some(trust.tolerance);
        if p < 1.0 { doubted(file, p, tolerance) } else { certain(file, tolerance) }
    }

    /// The parts of some ground to which all lines left, or all of the credible set, give +1 and -1.
    pub(crate) fn ground(&self, area: Area) -> [Polygon; 2] {
        line_set::agreed(&area.into(), &self.bounds)
    }
}

/// The lines that labels leave which are true.
fn certain(file: &SampleFile, tolerance: Option<f64>) -> Result<Answer> {
    let SampleFile { name, samples, .. } = file;
    let (rows, off) = (in_order(samples), tolerance.unwrap_or(0.0));
    let lines = Separation::of(samples, &rows, off).map_err(|why| match why {
        NoSeparation::Contradiction(index) => {
            let outliers = outliers(samples, &rows, |rows: &[Row]| are_separable(rows, off));
            contradiction(file, index, &outliers, tolerance)
        }
        NoSeparation::OneLabel => one_label(file),
        NoSeparation::Collinear => anyhow!(
            "{name}: the samples are collinear; expected samples of both labels, not all on one line"
        ),
        NoSeparation::AnyDirection => anyhow!(
            "{name}: positions that may be off by {off} m leave lines of every direction, expected samples further apart or \
             a smaller --tolerance"
        ),
    })?;
    let is_short = tolerance.is_none() && samples.len() <= MOST_PAIRED;
    let mut answer = Answer {
        bounding: lines.support(),
        slope_arcs: lines.slope_arcs(),
        intercept: lines.intercepts(),
        centre: line_set::line(lines.centre()),
        maximum_margin: lines.maximum_margin().and_then(line_set::line),
        bisector: if is_short { estimate::bisector(samples).map(Line::from) } else { None },
        tolerance,
        doubt: None,
        fit: Explanation::agreeing(samples.len()),
        bounds: lines.bounds(),
    };
    // To the last bit as in a mission, as long as a planner could hold them.
    let some = if samples.len() > MOST_HELD { &answer.bounding } else { samples };
    if tolerance.is_none()
        && let Ok(space) = VersionSpace::<MOST_HELD>::new(some)
    {
        answer.slope_arcs = space.slope_arc().intervals_deg().to_vec();
        answer.intercept = space.intercepts();
        let estimates = space.estimates();
        answer.centre = estimates.centre.map(Line::from);
        answer.maximum_margin = estimates.maximum_margin.map(Line::from);
    }
    Ok(answer)
}

/// The error for samples of which the one at `index` is the first to leave no line. Without any one of `outliers` a
/// line separates the rest.
fn contradiction(
    file: &SampleFile,
    index: usize,
    outliers: &[Repeats],
    tolerance: Option<f64>,
) -> anyhow::Error {
    const DOUBT: &str = "say by --p how often labels are right";
    let within = tolerance.map(|it| format!(", wherever within {it} m they are"));
    let within = within.unwrap_or_default();
    let unit = file.unit.name();
    let named = |rows: &Repeats| {
        let lines: Vec<_> = rows.iter().map(|row| file.line(*row).to_string()).collect();
        match &lines[..] {
            [one] => format!("{unit} {one}"),
            several => {
                format!("{unit}s {} (of the same position and label)", several.join(" and "))
            }
        }
    };
    let none = format!("no line separates this sample from those above it by their labels{within}");
    let others = |rows: &Repeats| file.samples.len() - rows.len();
    match outliers {
        [] => {
            let explanation = explanation(file, tolerance).unwrap_or_default();
            anyhow!(
                "{}: {none}, and no single row is to blame; {DOUBT}{explanation}",
                file.place(index)
            )
        }
        [rows] if rows.len() == 1 => anyhow!(
            "{}: no line separates this sample from the others by their labels{within}, but without this row one separates \
             the other {}; correct or remove it, or {DOUBT}",
            file.place(rows[0]),
            others(rows)
        ),
        [rows] => anyhow!(
            "{}: no line separates this sample from the others by their labels{within}, but without {} one separates the \
             other {}; correct or remove them, or {DOUBT}",
            file.place(rows[0]),
            named(rows),
            others(rows)
        ),
        several => {
            let named: Vec<_> = several.iter().map(named).collect();
            anyhow!(
                "{}: {none}; one does without {}; or {DOUBT}",
                file.place(index),
                named.join(", or without ")
            )
        }
    }
}

/// What explains labels that no line separates, for a message; `None` for files that take long.
fn explanation(file: &SampleFile, tolerance: Option<f64>) -> Option<String> {
    if file.samples.len() > MOST_EXPLAINED {
        return None;
    }
    let Answer { fit, .. } = doubted(file, SUPPOSED, tolerance).ok()?;
    Some(format!(". {}", Words::explanation(file, &fit)))
}

/// The lines of a record are weighed by its labels. The answer is their mean, the smallest set that has the level, and
/// the most likely line, with the samples that disagree with it.
fn doubted(file: &SampleFile, p: f64, tolerance: Option<f64>) -> Result<Answer> {
    let SampleFile { name, samples, .. } = file;
    let (middle, reach) = ground(file)?;
    let posterior = posterior(file, p, tolerance, (middle, reach))?;
    let (all, LinePosterior { cells, pruned_mass }) = (posterior.mass(), posterior);
    let home = |(normal, distance): ByNormal| (normal, distance + normal.dot(&middle.coords));
    let mean = |mass: &Mass| line_set::line(home(mass.line()));
    let (set, probability) = credible(&cells);
    let slope_arcs = slope_arcs(set.iter().map(|cell| cell.patch.directions()));
    let of_patch = |patch: &Patch| {
        let of_corner = |corner: &Point2<f64>| home(patch.quarter.normal(*corner));
        patch.lines.0.iter().map(of_corner).collect::<Vec<_>>()
    };
    let bounds: Vec<_> = set.iter().flat_map(|cell| of_patch(&cell.patch)).collect();
    let most_likely = most_likely(&cells, &all).and_then(|cell| mean(&cell.mass));
    let most_likely =
        most_likely.with_context(|| format!("{name}: expected labels that prefer some line"))?;
    let alike = if tolerance.is_none() { alike(&most_likely, samples) } else { None };
    let centre = alike.as_ref().and_then(|it| line_set::line(it.centre()));
    let most_likely = centre.unwrap_or(most_likely);
    let off = tolerance.unwrap_or(0.0);
    let disagrees = |sample: &Sample| {
        f64::from(sample.label.sign()) * most_likely.distance(sample.site.into()) < -off
    };
    let disagreeing = (0..samples.len()).filter(|index| disagrees(&samples[*index])).collect();
    let fit = fit(file, &most_likely, p, off);
    Ok(Answer {
        bounding: Vec::new(),
        intercept: intercepts(&slope_arcs, bounds.iter().copied()),
        slope_arcs,
        centre: mean(&all),
        maximum_margin: alike.and_then(|it| it.maximum_margin()).and_then(line_set::line),
        bisector: None,
        tolerance,
        doubt: Some(Doubted { p, pruned_mass, probability, most_likely, disagreeing }),
        fit,
        bounds,
    })
}

/// What explains the labels that may be wrong, beside the most likely line.
fn fit(file: &SampleFile, line: &Line, p: f64, tolerance: f64) -> Explanation {
    let mut is_certain = vec![false; file.samples.len()];
    for &index in &file.rows.certain {
        is_certain[index] = true;
    }
    let read = (0..).zip(&file.samples).filter(|(row, _)| !is_certain[*row as usize]);
    let read: Vec<_> = read.map(|(row, sample)| (*sample, row)).collect();
    Explanation::of(&Question { given: &[], read: &read, p: Some(p), tolerance, line })
}

/// Samples that have one label.
fn one_label(file: &SampleFile) -> anyhow::Error {
    let label = file.samples.first().map_or(0, |sample| sample.label.sign());
    let (name, count) = (&file.name, file.samples.len());
    anyhow!(
        "{name}: found the label {label:+} alone, in {count} samples, expected samples of both labels"
    )
}

/// The middle of the ground around the samples of a file, which has both labels, and half of its size.
fn ground(file: &SampleFile) -> Result<(Point2<f64>, Vector2<f64>)> {
    let SampleFile { name, samples, .. } = file;
    let has = |label: Label| samples.iter().any(|sample| sample.label == label);
    if !(has(Label::Positive) && has(Label::Negative)) {
        return Err(one_label(file));
    }
    let area = area_around(samples)
        .with_context(|| format!("{name}: expected samples that are apart from each other"))?;
    let [min, max] = [area.min(), area.max()].map(Point2::<f64>::from);
    Ok((nalgebra::center(&min, &max), (max - min) / 2.0))
}

/// The distribution over all lines through some ground.
fn posterior(
    file: &SampleFile,
    p: f64,
    tolerance: Option<f64>,
    (middle, reach): (Point2<f64>, Vector2<f64>),
) -> Result<LinePosterior> {
    let name = &file.name;
    let votes = Votes::of(&file.samples, &file.rows.certain, middle).map_err(|index| {
        anyhow!("{}: found a certain label, and another at the same place", file.place(index))
    })?;
    LinePosterior::of(&votes, &Doubt::new(p, tolerance), reach).map_err(|why| match why {
        TooOpen::Cells(_) | TooOpen::Work(_) => {
            let open =
                format!("labels that are true with probability {p} leave too much open: {why}");
            // Often that is because no straight line explains them at all.
            let fewest = Fewest::of(&file.samples);
            let fit = fewest.map(|it| fit(file, &it.line, p, tolerance.unwrap_or(0.0)));
            let Some(fit) = fit.filter(Explanation::is_bad) else {
                return anyhow!("{name}: {open}");
            };
            let Words { says, advice } = Words::of(file, &fit, Some(p));
            anyhow!("{name}: {says} {advice}")
        }
        TooOpen::NoLine => anyhow!("{name}: no line agrees with the labels that are certain"),
    })
}

/// The smallest set of cells that has the level, and its probability. Of cells that are equally likely it has all.
fn credible(cells: &[Cell]) -> (&[Cell], f64) {
    let (mut held, mut count, mut least) = (0.0, 0, f64::INFINITY);
    for Cell { log, mass, .. } in cells {
        if held >= LEVEL && *log < least - 1e-9 {
            break;
        }
        (held, count, least) = (held + mass.measure, count + 1, *log);
    }
    (&cells[..count], held)
}

/// The lines that give samples the labels that one line gives them.
fn alike(line: &Line, samples: &[Sample]) -> Option<Separation> {
    let relabelled = samples.iter().map(|sample| Sample { label: side(line, sample), ..*sample });
    let relabelled: Vec<_> = relabelled.collect();
    Separation::of(&relabelled, &in_order(&relabelled), 0.0).ok()
}

fn side(line: &Line, sample: &Sample) -> Label {
    if line.distance(sample.site.into()) < 0.0 { Label::Negative } else { Label::Positive }
}

/// Of the most likely cells the one nearest to the mean.
fn most_likely<'a>(cells: &'a [Cell], all: &Mass) -> Option<&'a Cell> {
    let most = cells.first()?.log;
    let mean = |mass: &Mass| (mass.normal / mass.measure, mass.distance / mass.measure);
    let (normal, distance) = mean(all);
    let off = |cell: &Cell| {
        let (own, at) = mean(&cell.mass);
        (own - normal).norm_squared() + (at - distance) * (at - distance)
    };
    let best = cells.iter().take_while(|cell| cell.log >= most - 1e-9);
    best.min_by(|a, b| off(a).total_cmp(&off(b)))
}
