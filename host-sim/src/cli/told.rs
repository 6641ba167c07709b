//! The results of campaigns, from their rows: a table for people, a record for programs, curves to look at.

use std::ops::Range;
use std::path::Path;

use anyhow::{Result, bail};

use crate::campaign::accuracy::{self, Accuracy};
use crate::campaign::calibration::{self, Calibrated};
use crate::campaign::ensemble::{Campaign, Measure, Measured};
use crate::campaign::rows::RowWriter;
use crate::cli::campaign_flags::Campaigns;
use crate::cli::format::Format;
use crate::output::file::{Output, json};
use crate::output::partial::Begin;
use crate::report::curves::Curves;
use crate::report::{campaign as tables, comparison};

/// What campaigns come to.
pub(crate) struct Told {
    /// What to print.
    pub(crate) text: String,
    /// What to draw.
    pub(crate) curves: Curves,
}

/// Rows of a planner at most. Each takes 96 bytes while their figures are sorted, and half of that besides.
const MOST_ROWS: u64 = 10_000_000;

/// Which fields are flown, and where their rows go.
#[derive(Clone)]
pub(crate) struct Flown<'a> {
    pub(crate) fields: Range<u64>,
    pub(crate) csv: Option<&'a Path>,
}

/// Flies them, by what labels that are true or that may err can show, and what came of it.
pub(crate) fn tell(campaigns: &Campaigns, flown: &Flown, format: Format) -> Result<Told> {
    let is_single = !campaigns.are_compared;
    let (table, record, curves) = if campaigns.labels_err {
        let summaries =
            fly(campaigns, &Calibrated, flown, |it, rows| calibration::Summary::of(it, rows))?;
        let curves = Curves::of_calibration(&summaries);
        match &summaries[..] {
            [single] if is_single => (tables::calibration(single), json(single), curves),
            all => (comparison::calibration(all), json(&all), curves),
        }
    } else {
        let by_label = campaigns.of_each.iter().any(|it| it.asking.labels.is_some());
        let measure = Accuracy { by_label };
        let summaries =
            fly(campaigns, &measure, flown, |it, rows| accuracy::Summary::of(it, rows))?;
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

/// Flies the fields by each planner, and sums up its rows, which are written as they pass.
fn fly<M: Measure, S>(
    campaigns: &Campaigns,
    measure: &M,
    Flown { fields, csv }: &Flown,
    sum: impl Fn(&Campaign, &mut dyn Iterator<Item = Result<Measured<M::Checkpoint>>>) -> Result<S>,
) -> Result<Vec<S>> {
    for campaign in &campaigns.of_each {
        let (missions, stages) = (fields.end - fields.start, campaign.stages(measure).len());
        if missions * stages as u64 > MOST_ROWS {
            bail!(
                "--fields: found {missions}, with {stages} rows each, expected {MOST_ROWS} rows at most, as they are sorted in \
                 memory"
            );
        }
    }
    let planners = campaigns.planners();
    let header = planners.header::<M::Checkpoint>()?;
    let goes_on = "--from goes on with the fields that are missing";
    let begin = Begin { holds: "rows", goes_on, resume: false };
    let file = csv.map(|path| Output::growing(path, &header, begin)).transpose()?;
    let mut writer = file.map(|file| RowWriter::new(file, &planners));
    let mut summaries = Vec::new();
    for (number, campaign) in campaigns.of_each.iter().enumerate() {
        let mut rows = campaign.fly(measure, fields.clone())?.map(|row| {
            let row = row?;
            writer.as_mut().map_or(Ok(()), |it| it.write(number, &row))?;
            Ok(row)
        });
        summaries.push(sum(campaign, &mut rows)?);
    }
    writer.map_or(Ok(()), |writer| writer.into_inner()?.complete())?;
    Ok(summaries)
}
