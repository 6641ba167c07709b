//! Whether a straight line fits, as a record.

use serde::Serialize;

use crate::fitting::fit::{Fit, Piece, Run, TESTS};
use crate::replay::fit_words::Words;
use crate::replay::sample_file::SampleFile;

/// How well a line fits.
#[derive(Serialize)]
pub(crate) struct FitRecord {
    labels: usize,
    disagreeing: usize,
    expected: [usize; 2],
    suggested_p: f64,
    longest_run: Option<RunRecord>,
    along: Vec<PieceRecord>,
    tests: Vec<TestRecord>,
    verdict: &'static str,
    says: String,
    advice: String,
}

/// Disagreeing labels in a row.
#[derive(Serialize)]
struct RunRecord {
    count: usize,
    /// The lines of the file.
    first: usize,
    last: usize,
}

/// A piece of the line.
#[derive(Serialize)]
struct PieceRecord {
    from: [f64; 2],
    to: [f64; 2],
    labels: usize,
    /// Labels -1 on the +1 side.
    negative: usize,
    /// Labels +1 on the -1 side.
    positive: usize,
}

#[derive(Serialize)]
struct TestRecord {
    name: &'static str,
    p_value: f64,
}

impl FitRecord {
    /// The fit to the samples of a file. `p` is what was said of the labels.
    pub(crate) fn of(file: &SampleFile, fit: &Fit, p: Option<f64>) -> Self {
        let Words { says, advice } = Words::of(file, fit, p);
        let test = |(name, p_value)| TestRecord { name, p_value };
        Self {
            labels: fit.labels,
            disagreeing: fit.disagreeing,
            expected: fit.expected,
            suggested_p: fit.suggested_p,
            longest_run: fit.longest_run.map(|Run { count, ends }| RunRecord {
                count,
                first: file.line(ends[0]),
                last: file.line(ends[1]),
            }),
            along: fit.along.iter().map(PieceRecord::from).collect(),
            tests: TESTS.into_iter().zip(fit.p_values).map(test).collect(),
            verdict: fit.verdict.name(),
            says,
            advice,
        }
    }
}

impl From<&Piece> for PieceRecord {
    fn from(piece: &Piece) -> Self {
        let [from, to] = piece.ends.map(|end| [end.x, end.y]);
        let [negative, positive] = piece.disagreeing;
        Self { from, to, labels: piece.labels, negative, positive }
    }
}
