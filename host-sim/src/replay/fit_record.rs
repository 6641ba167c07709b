//! Whether a straight line fits, as a record.

use serde::Serialize;

use crate::fitting::explanation::Explanation;
use crate::replay::fit_words::Words;
use crate::replay::sample_file::SampleFile;

/// How well a line fits.
#[derive(Serialize)]
pub(crate) struct FitRecord {
    labels: usize,
    disagreeing: usize,
    expected: [usize; 2],
    suggested_p: f64,
    verdict: &'static str,
    says: String,
    advice: String,
}

impl FitRecord {
    /// The fit to the samples of a file. `p` is what was said of the labels.
    pub(crate) fn of(file: &SampleFile, fit: &Explanation, p: Option<f64>) -> Self {
        let Words { says, advice } = Words::of(file, fit, p);
        Self {
            labels: fit.labels,
            disagreeing: fit.disagreeing,
            expected: fit.expected,
            suggested_p: fit.suggested_p(),
            verdict: fit.verdict(),
            says,
            advice,
        }
    }
}
