//! Whether a straight line explains recorded labels that may be wrong.
//!
//! Nine tests look for what a straight line and independent errors do not explain. Each has the level [`EACH`], so
//! that a straight line is refused in 1 % of the files at most.
//!
//! - *too many* and *too few*: `counts`. Bounds, as the line is fitted to the same labels.
//! - *longest run*: `counts`. A bound for the true line. Its factor for the fitted one is not a proof.
//! - *stretch* of the file: `stretch`. *Arc*, *drift* and *two lines*: `shapes`. Bounded odds against all lines and
//!   all shares of wrong labels.
//! - *arc by trials* and *drift by trials*: `trials`. They simulate files of the fitted line.
//!
//! Under a tolerance the line is the most likely one to a tenth in the logarithm, and *too many* counts labels beyond
//! the tolerance of the fitted line. These are approximations too.
//!
//! Measured: of 2,000 straight surveys of 32 to 336 labels, of which 1 to 20 % are wrong, half of them with positions
//! that err, 3 were refused (2 *too many*, 1 *drift by trials*). The seed is 7:
//! `LONG=1 cargo test -p host-sim --lib false_alarms -- --nocapture`.

pub(crate) mod counts;
pub(crate) mod labels;
pub(crate) mod shapes;
pub mod stretch;
pub(crate) mod sweep;
mod trials;

use nalgebra::{Point2, Vector2};
use planner_core::Line;

use crate::fitting::fit::labels::Labels;
use crate::fitting::fit::shapes::{Lift, arc, moving, two_lines};
pub use crate::fitting::fit::stretch::Fault;
use crate::fitting::fit::stretch::stretch;
use crate::fitting::fit::sweep::Directed;

/// The names of the tests.
pub const TESTS: [&str; 9] = [
    "too many",
    "too few",
    "longest run",
    "stretch",
    "arc",
    "drift",
    "two lines",
    "arc by trials",
    "drift by trials",
];

/// A test speaks against the line if its p-value is this or less.
pub const EACH: f64 = 0.01 / TESTS.len() as f64;

/// How many pieces of the line are told apart.
const PIECES: usize = 5;

/// What is asked of a fit.
pub struct Question<'a> {
    /// Where labels that may be wrong were read, in the order of the file.
    pub at: &'a [Point2<f64>],
    /// Whether the label is +1.
    pub is_positive: &'a [bool],
    /// The most likely line.
    pub line: &'a Line,
    /// How often labels are said to be true.
    pub p: f64,
    /// Metres; 0 where positions are exact.
    pub tolerance: f64,
}

/// How well a line fits. Labels are numbered as they were given.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Labels that may disagree: further from the line than the tolerance.
    pub labels: usize,
    /// How many of them do.
    pub disagreeing: usize,
    /// The counts that neither *too many* nor *too few* speaks against.
    pub expected: [usize; 2],
    /// How often labels are true, by those that disagree.
    pub suggested_p: f64,
    /// The most disagreeing labels in a row.
    pub longest_run: Option<Run>,
    /// Pieces of the line, from end to end.
    pub along: Vec<Piece>,
    /// The p-values of the [`TESTS`].
    pub p_values: [f64; TESTS.len()],
    /// What follows from the tests.
    pub verdict: Verdict,
}

/// Disagreeing labels in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// How many.
    pub count: usize,
    /// The first and the last.
    pub ends: [usize; 2],
}

/// A piece of the line, with the labels beside it.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Where it begins and ends, metres.
    pub ends: [Point2<f64>; 2],
    /// How many labels are nearer to it than to other pieces.
    pub labels: usize,
    /// Labels -1 on the +1 side, and labels +1 on the -1 side.
    pub disagreeing: [usize; 2],
}

/// What explains the labels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// A straight line, as far as the tests see.
    Fits,
    /// A straight line, with more wrong labels than was said.
    TooHigh,
    /// A straight line, with fewer wrong labels than was said.
    TooLow,
    /// Labels in a row disagree.
    Row(Run),
    /// The labels from one to another say something else than where they are: so many in all, of which so many
    /// disagree with the line. Elsewhere labels are true with probability `p`.
    Stretch {
        /// The first and the last label.
        ends: [usize; 2],
        /// What they say instead.
        fault: Fault,
        /// How many they are, and how many disagree with the line.
        counts: [usize; 2],
        /// How often labels elsewhere are true.
        p: f64,
    },
    /// An arc of this radius, which is so far from its chord. So many labels disagree with it.
    Bend {
        /// Metres.
        radius: f64,
        /// How far the arc is from its chord, metres.
        sagitta: f64,
        /// How many labels disagree with the arc.
        disagreeing: usize,
    },
    /// A line that moved so far while the labels were read.
    Drift {
        /// How far the line moved.
        metres: f64,
        /// How many labels disagree with the moving line.
        disagreeing: usize,
    },
    /// Two lines.
    TwoLines {
        /// How many labels disagree with both.
        disagreeing: usize,
    },
}

impl Verdict {
    /// Its name in records.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Fits => "fits",
            Self::TooHigh => "p too high",
            Self::TooLow => "p too low",
            Self::Row(_) | Self::Stretch { .. } => "run",
            Self::Bend { .. } => "bend",
            Self::Drift { .. } => "drift",
            Self::TwoLines { .. } => "two boundaries",
        }
    }

    /// Whether what is said of the line is not to be trusted. A `p` that is too low only makes sets too wide.
    pub fn is_bad(&self) -> bool {
        !matches!(self, Self::Fits | Self::TooLow)
    }
}

impl Fit {
    /// Of so many labels, all of which agree.
    pub fn exact(labels: usize) -> Self {
        Self {
            labels,
            disagreeing: 0,
            expected: [0; 2],
            suggested_p: suggested(labels, 0),
            longest_run: None,
            along: Vec::new(),
            p_values: [1.0; TESTS.len()],
            verdict: Verdict::Fits,
        }
    }

    /// How well the most likely line fits.
    pub fn of(question: &Question) -> Self {
        let Question { at, is_positive, line, p, tolerance } = *question;
        let heights: Vec<_> = at.iter().map(|at| line.distance(*at)).collect();
        let signed =
            |index: usize| if is_positive[index] { heights[index] } else { -heights[index] };
        let disagrees = |index: usize| signed(index) < -tolerance;
        // Others are within the tolerance of the line.
        let beyond: Vec<_> =
            (0..at.len()).filter(|index| signed(*index).abs() >= tolerance).collect();
        let disagreeing = beyond.iter().filter(|index| disagrees(**index)).count();
        let longest_run = longest_run(&beyond, disagrees);
        let q = 1.0 - p;
        // A position is off by more than three deviations, on one side, with this probability.
        let most = if tolerance > 0.0 { q + (1.0 - 2.0 * q) * 0.001_35 } else { q };
        let is_blurred = tolerance > 0.0;
        let count = beyond.len();
        let run = longest_run.map_or(0, |run| run.count);
        let mut fit = Self {
            labels: count,
            disagreeing,
            expected: counts::expected(count, [q, most], is_blurred, EACH),
            suggested_p: suggested(count, disagreeing),
            longest_run,
            along: pieces(question, &beyond, disagrees),
            p_values: [1.0; TESTS.len()],
            verdict: Verdict::Fits,
        };
        fit.p_values[0] = counts::at_least(count, most, disagreeing);
        fit.p_values[1] = counts::fitted_at_most(count, q, disagreeing, is_blurred);
        fit.p_values[2] = counts::run_at_least(count, disagreeing, run);
        let mut best = longest_run.map(|run| (fit.p_values[2], Verdict::Row(run)));
        // Where no label disagrees, nothing explains them better.
        let shapes = if disagreeing > 0 { shapes_of(question, &fit.along) } else { Vec::new() };
        for (test, p_value, verdict) in shapes {
            fit.p_values[test] = p_value;
            if best.is_none_or(|(least, _)| p_value < least) {
                best = Some((p_value, verdict));
            }
        }
        fit.verdict = match best {
            Some((p_value, verdict)) if p_value <= EACH => verdict,
            _ if fit.p_values[0] <= EACH => Verdict::TooHigh,
            _ if fit.p_values[1] <= EACH => Verdict::TooLow,
            _ => Verdict::Fits,
        };
        fit
    }
}

impl Fit {
    /// The same with the labels numbered as `rows` says.
    #[must_use]
    pub fn numbered(mut self, rows: &[usize]) -> Self {
        let of = |ends: [usize; 2]| ends.map(|end| rows[end]);
        let of_run = |run: Run| Run { ends: of(run.ends), ..run };
        self.longest_run = self.longest_run.map(of_run);
        match &mut self.verdict {
            Verdict::Row(run) => *run = of_run(*run),
            Verdict::Stretch { ends, .. } => *ends = of(*ends),
            _ => {}
        }
        self
    }
}

/// How often labels are true of which so many disagree with a line: Laplace's rule. Its one label more makes up for the
/// one or two that the fit takes.
fn suggested(labels: usize, disagreeing: usize) -> f64 {
    (1.0 - (disagreeing + 1) as f64 / (labels + 2) as f64).max(0.5)
}

/// The most labels in a row that disagree, of some; the first of several.
fn longest_run(some: &[usize], disagrees: impl Fn(usize) -> bool) -> Option<Run> {
    let mut longest: Option<Run> = None;
    let mut run: Option<Run> = None;
    for &index in some {
        run = match run {
            _ if !disagrees(index) => None,
            None => Some(Run { count: 1, ends: [index; 2] }),
            Some(run) => Some(Run { count: run.count + 1, ends: [run.ends[0], index] }),
        };
        if run.is_some_and(|run| longest.is_none_or(|longest| run.count > longest.count)) {
            longest = run;
        }
    }
    longest
}

/// Equal pieces of the line, from left to right as one looks from its +1 side.
fn pieces(question: &Question, some: &[usize], disagrees: impl Fn(usize) -> bool) -> Vec<Piece> {
    let Question { at, is_positive, line, .. } = question;
    let [a, b, _] = line.coefficients();
    let normal = Vector2::new(a, b).normalize();
    let along = Vector2::new(-normal.y, normal.x);
    let place = |at: &Point2<f64>| along.dot(&at.coords);
    let places = at.iter().map(place);
    let low = places.clone().fold(f64::INFINITY, f64::min);
    let high = places.fold(f64::NEG_INFINITY, f64::max);
    if high <= low {
        return Vec::new();
    }
    let foot = |k: usize| {
        let to = low + (high - low) * k as f64 / PIECES as f64;
        let on = Point2::from(along * to);
        on - normal * line.distance(on)
    };
    let piece = |k: usize| Piece { ends: [foot(k), foot(k + 1)], labels: 0, disagreeing: [0; 2] };
    let mut pieces: Vec<_> = (0..PIECES).map(piece).collect();
    for &index in some {
        let part = (place(&at[index]) - low) / (high - low) * PIECES as f64;
        let piece = &mut pieces[(part as usize).min(PIECES - 1)];
        piece.labels += 1;
        if disagrees(index) {
            piece.disagreeing[usize::from(is_positive[index])] += 1;
        }
    }
    pieces
}

/// The tests that need a search: their numbers, their p-values, and what they would say.
fn shapes_of(question: &Question, along: &[Piece]) -> Vec<(usize, f64, Verdict)> {
    let Question { at, is_positive, line, tolerance, .. } = *question;
    let ([Some(first), Some(last)], true) = ([along.first(), along.last()], at.len() >= 3) else {
        return Vec::new();
    };
    let length = (last.ends[1] - first.ends[0]).norm();
    let (low, high) = at.iter().fold((at[0], at[0]), |(low, high), at| (low.inf(at), high.sup(at)));
    let middle = nalgebra::center(&low, &high);
    let labels = Labels {
        at: at.iter().map(|at| Point2::from(at - middle)).collect(),
        is_positive: is_positive.to_vec(),
        sigma: tolerance / 3.0,
        radius: 0.5 * (high - low).norm(),
    };
    let [a, b, _] = line.coefficients();
    let best = Directed { angle: libm::atan2(b, a), offset: -line.distance(middle) };
    let height = best.heights(&labels);
    let (straight, share) = labels.evidence(0..at.len(), &height).greatest();
    // An alternative that explains all labels would not say enough.
    if -straight < 3.0 * libm::log(at.len() as f64) {
        return Vec::new();
    }
    // Under a tolerance the line is found to a tenth.
    let straight = if tolerance > 0.0 { straight + 0.1 } else { straight };
    let (mut found, mut lifted) = (Vec::new(), Vec::new());
    let bound = |log_odds: f64| libm::exp(-log_odds).min(1.0);
    if let Some(it) = stretch(&labels, best, share, straight) {
        let [first, last] = it.ends;
        let against = (first..=last).filter(|index| (height(*index) > 0.0) != is_positive[*index]);
        let counts = [last - first + 1, against.count()];
        let verdict =
            Verdict::Stretch { ends: it.ends, fault: it.fault, counts, p: 1.0 - it.share };
        found.push((3, bound(it.log_odds), verdict));
    }
    if let Some(it) = arc(&labels, best, straight) {
        let half = (0.5 * length).min(it.number);
        let sagitta = it.number - (it.number * it.number - half * half).sqrt();
        let disagreeing = it.disagreeing;
        let verdict = Verdict::Bend { radius: it.number, sagitta, disagreeing };
        found.push((4, bound(it.log_odds), verdict));
        lifted.push((7, Lift::Arc, verdict));
    }
    if let Some(it) = moving(&labels, best, straight) {
        let (metres, disagreeing) = (it.number, it.disagreeing);
        let verdict = Verdict::Drift { metres, disagreeing };
        found.push((5, bound(it.log_odds), verdict));
        lifted.push((8, Lift::Drift, verdict));
    }
    let it = two_lines(&labels, best, straight);
    found.push((6, bound(it.log_odds), Verdict::TwoLines { disagreeing: it.disagreeing }));
    // Trials take long: they are for what the bounds leave open.
    let is_settled = found.iter().any(|(_, p_value, _)| *p_value <= EACH);
    for (test, lift, verdict) in lifted.into_iter().filter(|_| !is_settled) {
        found.push((test, trials::p_value(&labels, best, share, lift), verdict));
    }
    found
}
