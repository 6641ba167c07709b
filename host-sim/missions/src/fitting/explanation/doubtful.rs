//! Whether a straight line explains labels that may be wrong.
//!
//! Four kinds of boundaries and sensors are fitted beside the line: an arc, a line that moves, two lines (`shapes`), and
//! a stretch in which the sensor is at fault (`stretch`). Each has its own share of wrong labels. The gain of one is the
//! logarithm of how much more likely it makes the labels than the line does. It is the cause if its gain is above its
//! bar, which is measured on straight surveys: [`BARS`]. Else the labels that disagree are counted (`counts`).
//!
//! Measured: of 1,053 straight surveys of 32 to 336 labels, of which 0.4 to 30 % are wrong, half of them with positions
//! that err, one had a gain above its bar. `LONG=1 cargo test -p host-sim --lib false_alarms` tries 2,000 others.

use planner_core::Sample;

use crate::fitting::explanation::counts::expected;
use crate::fitting::explanation::labels::{Directed, Labels};
use crate::fitting::explanation::shapes::{arc, moving, two_lines};
use crate::fitting::explanation::stretch::stretch;
use crate::fitting::explanation::{Cause, Explanation, Found, Question};

/// The bar of each gain: this and the logarithm of the number of labels. Of straight surveys 1 in 1,000 has a gain above.
const BARS: [f64; 4] = [4.0, 4.0, 8.0, 7.0];

impl Question<'_> {
    /// What explains labels that may be wrong.
    pub(super) fn doubtful(&self, p: f64) -> Explanation {
        let Self { read, tolerance, line, .. } = *self;
        let signed = |(sample, _): &(Sample, u32)| {
            f64::from(sample.label.sign()) * line.distance(sample.site.into())
        };
        // Others are within the tolerance of the line.
        let beyond = read.iter().map(signed).filter(|height| height.abs() >= tolerance);
        let labels = beyond.clone().count();
        let disagreeing = beyond.filter(|height| *height < 0.0).count();
        let q = (1.0 - p).max(1e-9);
        // A position is off by more than three deviations, on one side, with this probability.
        let most = if tolerance > 0.0 { q + (1.0 - 2.0 * q) * 0.001_35 } else { q };
        let expected = expected(labels, [q, most]);
        // Where no label disagrees, nothing explains them better.
        let found = if disagreeing > 0 { self.found() } else { None };
        let cause = match found {
            Some(found) => found.cause(),
            None if disagreeing > expected[1] => Cause::Random,
            None => Cause::Line,
        };
        let tolerance = found.and_then(Found::tolerance);
        Explanation {
            disagreeing,
            expected,
            cause,
            tolerance,
            found,
            ..Explanation::agreeing(labels)
        }
    }

    /// What explains the labels much better than a straight line does: that which is furthest above its bar.
    fn found(&self) -> Option<Found> {
        let labels = Labels::of(self)?;
        let [a, b, _] = self.line.coefficients();
        let angle = libm::atan2(b, a);
        let best = Directed { angle, offset: -self.line.distance(labels.middle) };
        let (straight, share) = labels.evidence(best.heights(&labels)).greatest();
        let all = [
            arc(&labels, best),
            moving(&labels, best),
            Some(two_lines(&labels, best)),
            stretch(&labels, best, share),
        ];
        let bars = BARS.map(|bar| bar + libm::log(labels.count() as f64));
        let above = all.into_iter().zip(bars).filter_map(|(it, bar)| {
            let (log, found) = it?;
            Some((log - straight - bar, found))
        });
        let best = above.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(above, _)| *above > 0.0);
        best.map(|(_, found)| found)
    }
}
