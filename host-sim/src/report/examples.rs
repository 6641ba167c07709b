//! The flights of the paper's examples side by side: a row for each, and a second row for a printed one.

use planner_core::{PosteriorView, Prior};

use crate::mission::read_out::ReadOut;
use crate::mission::recording::Recording;
use crate::mission::results::LineRecord;
use crate::report::table::{Column, Table};
use crate::report::text;

/// An example as it was flown.
pub struct Flown<'a> {
    /// The example.
    pub example: &'a str,
    /// Who flew it.
    pub planner: &'a str,
    /// Whether it was flown as printed. Then the paper's estimate comes before the recommended one.
    pub is_printed: bool,
    /// How it went.
    pub recording: &'a Recording,
}

/// The results of all flights, grouped by example.
pub fn side_by_side<'a>(flights: impl Iterator<Item = Flown<'a>>) -> String {
    let mut table = Table::new([
        Column::left("Side by side", 26),
        Column::left("estimate", 27),
        Column::right("bits", 5),
        Column::right("slope off deg", 13).apart(),
        Column::right("intercept off m", 15).apart(),
        Column::right("misclassified", 13).apart(),
        Column::right("cost", 5).apart(),
        Column::right("metres", 6).apart(),
    ]);
    let mut last = "";
    for Flown { example, planner, is_printed, recording } in flights {
        let results = &recording.results;
        if example != last {
            table.line(&format!("{example}, {} steps", results.steps.len()));
            last = example;
        }
        let told = if is_printed {
            let [printed, recommended, _] = text::printed_estimates(results);
            vec![printed, recommended]
        } else {
            let [recommended, ..] = text::estimates(results);
            vec![recommended]
        };
        for (name, estimate) in told {
            let of_mission = [
                format!("  {planner}"),
                name.to_owned(),
                format!("{:.2}", bits(&*recording.belief)),
            ];
            let motion = [format!("{:.1}", results.cost()), format!("{:.1}", results.travelled())];
            let errors = errors(results.start.truth.as_ref(), estimate);
            table.row(of_mission.into_iter().chain(errors).chain(motion));
        }
    }
    table.to_string()
}

/// The bits learnt, by the area prior, whichever prior chose the motions.
pub(crate) fn bits(belief: &dyn ReadOut) -> f64 {
    let by_area = belief.hypotheses().map(|table| table.weighed_by(Prior::Area));
    by_area.map_or_else(|| belief.information(), |table| PosteriorView::new(&table).information())
}

/// How far an estimate is off: slope, intercept, area.
fn errors(truth: Option<&LineRecord>, estimate: Option<LineRecord>) -> [String; 3] {
    let none = || "-".to_owned();
    let error = estimate.and_then(|line| line.error);
    let off = truth.zip(estimate).and_then(|(truth, line)| {
        truth.intercept.zip(line.intercept).map(|(truth, found)| (found - truth).abs())
    });
    [
        error.map_or_else(none, |it| format!("{:.2}", it.degrees)),
        off.map_or_else(none, |off| format!("{off:.2}")),
        error.map_or_else(none, |it| format!("{:.2} %", 100.0 * it.misclassified)),
    ]
}
