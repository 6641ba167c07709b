//! The results of campaigns, from their rows: a table for people, a record for programs, curves to look at.

use anyhow::Result;

use crate::campaign::accuracy::{self, Accuracy};
use crate::campaign::calibration::{self, Calibrated};
use crate::campaign::ensemble::Measure;
use crate::cli::campaign_flags::Campaigns;
use crate::cli::format::Format;
use crate::cli::passage::Passage;
use crate::output::file::json;
use crate::report::curves::Curves;
use crate::report::{campaign as tables, comparison};

/// Where rows come from and where they go, whatever is measured.
pub(crate) trait Opening {
    /// Opens the files.
    fn open<M: Measure>(self, measure: &M) -> Result<Passage<'_, M>>;
}

/// What campaigns come to.
pub(crate) struct Told {
    /// What to print.
    pub(crate) text: String,
    /// What to draw.
    pub(crate) curves: Curves,
}

/// Sends the rows on their way, by what labels that are true or that may err can show, and what came of it.
pub(crate) fn tell(campaigns: &Campaigns, opening: impl Opening, format: Format) -> Result<Told> {
    let each = || campaigns.of_each.iter().enumerate();
    let is_single = !campaigns.are_compared;
    let (table, record, curves) = if campaigns.labels_err {
        let mut passage = opening.open(&Calibrated)?;
        let summaries = each()
            .map(|(k, it)| calibration::Summary::of(it, passage.rows(k, it)?))
            .collect::<Result<Vec<_>>>()?;
        passage.complete()?;
        let curves = Curves::of_calibration(&summaries);
        match &summaries[..] {
            [single] if is_single => (tables::calibration(single), json(single), curves),
            all => (comparison::calibration(all), json(&all), curves),
        }
    } else {
        let by_label = campaigns.of_each.iter().any(|it| it.asking.labels.is_some());
        let measure = Accuracy { by_label };
        let mut passage = opening.open(&measure)?;
        let summaries = each()
            .map(|(k, it)| accuracy::Summary::of(it, passage.rows(k, it)?))
            .collect::<Result<Vec<_>>>()?;
        passage.complete()?;
        let curves = Curves::of_accuracy(&summaries);
        match &summaries[..] {
            [single] if is_single => (tables::accuracy(single), json(single), curves),
            all => (comparison::accuracy(all), json(&all), curves),
        }
    };
    let text = match format {
        Format::Text => table,
        Format::Json => record,
    };
    Ok(Told { text, curves })
}
