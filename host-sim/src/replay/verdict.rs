//! Whether a straight line fits: the report's last lines, the warning and the record.

use serde::Serialize;

use crate::replay::fit::{Piece, Run, TESTS};
use crate::replay::fit_words::Words;
use crate::replay::record::Replay;

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

impl Replay {
    /// The verdict in words, if the line is not to be relied on.
    pub fn warning(&self) -> Option<String> {
        let Words { says, advice } = Words::of(&self.file, &self.answer.fit, self.told_p());
        self.answer.fit.verdict.is_bad().then(|| format!("{says} {advice}"))
    }

    /// What the file is called.
    pub fn name(&self) -> &str {
        &self.file.name
    }

    fn told_p(&self) -> Option<f64> {
        self.answer.doubt.as_ref().map(|doubt| doubt.p)
    }

    /// The verdict, with what to do, a line each.
    pub(crate) fn verdict_in_words(&self) -> String {
        let Words { says, advice } = Words::of(&self.file, &self.answer.fit, self.told_p());
        let advice = if advice.is_empty() { advice } else { advice + "\n" };
        format!("\n{says}\n{advice}")
    }

    /// How well the line fits, as a record.
    pub(crate) fn fit_record(&self) -> FitRecord {
        let fit = &self.answer.fit;
        let Words { says, advice } = Words::of(&self.file, fit, self.told_p());
        let test = |(name, p_value)| TestRecord { name, p_value };
        FitRecord {
            labels: fit.labels,
            disagreeing: fit.disagreeing,
            expected: fit.expected,
            suggested_p: fit.suggested_p,
            longest_run: fit.longest_run.map(|Run { count, ends }| RunRecord {
                count,
                first: self.file.line(ends[0]),
                last: self.file.line(ends[1]),
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
