//! `campaign --compare`: several planners on the same fields.

use anyhow::{Result, bail};

use crate::campaign::accuracy::{self, Accuracy};
use crate::campaign::calibration::{self, Calibrated};
use crate::campaign::ensemble::Campaign;
use crate::mission::algorithm::Algorithm;
use crate::output::file::{csv_by, json};
use crate::report::comparison;
use crate::report::curves::Curves;

/// What campaigns come to: a table for people, rows for a file, records for programs, curves to look at.
pub(crate) struct Told {
    pub(crate) table: String,
    pub(crate) rows: String,
    pub(crate) record: String,
    pub(crate) curves: Curves,
}

/// Flies campaigns that differ in who plans, by what labels that are true or that may err can show.
pub(crate) fn fly(campaigns: &[Campaign], labels_err: bool) -> Result<Told> {
    Ok(if labels_err {
        let fly = |it: &Campaign| Ok(calibration::Summary::of(it, it.run(&Calibrated)?));
        let summaries = campaigns.iter().map(fly).collect::<Result<Vec<_>>>()?;
        let rows = summaries.iter().map(|it| (it.algorithm.name(), &it.checkpoints[..]));
        let rows = csv_by("algorithm", rows)?;
        let curves = Curves::of_calibration(&summaries);
        Told { table: comparison::calibration(&summaries), rows, record: json(&summaries), curves }
    } else {
        let fly = |it: &Campaign| Ok(accuracy::Summary::of(it, it.run(&Accuracy)?));
        let summaries = campaigns.iter().map(fly).collect::<Result<Vec<_>>>()?;
        let rows = summaries.iter().map(|it| (it.algorithm.name(), &it.checkpoints[..]));
        let rows = csv_by("algorithm", rows)?;
        let curves = Curves::of_accuracy(&summaries);
        Told { table: comparison::accuracy(&summaries), rows, record: json(&summaries), curves }
    })
}

/// Whether each planner is compared once.
///
/// # Errors
/// Names the one that is there twice.
pub(crate) fn check_once(planners: &[Algorithm]) -> Result<()> {
    for (k, planner) in planners.iter().enumerate() {
        if planners[..k].contains(planner) {
            bail!("--compare: found {} twice, expected once", planner.name());
        }
    }
    Ok(())
}
