//! Campaigns over kinds of boundaries: so many missions of each kind and reliability, flown on all cores.

use anyhow::Result;
use rayon::prelude::*;

use crate::output::notes::progress;

/// A row for each kind and each probability, with a progress bar on a terminal.
pub(super) fn rows<K: Sync, F: Send, R>(
    (kinds, p, missions): (&[K], &[f64], u64),
    title: &'static str,
    fly: impl Fn(&K, f64, u64) -> Result<F> + Sync,
    row: impl Fn(&K, f64, &[F]) -> R,
) -> Result<Vec<R>> {
    let all: Vec<_> = kinds.iter().flat_map(|kind| p.iter().map(move |p| (kind, *p))).collect();
    let bar = progress(missions * all.len() as u64, "missions")?.with_message(title);
    let rows = all.into_iter().map(|(kind, p)| {
        let flown = (0..missions).into_par_iter().map(|number| {
            let flown = fly(kind, p, number);
            bar.inc(1);
            flown
        });
        Ok(row(kind, p, &flown.collect::<Result<Vec<_>>>()?))
    });
    let rows = rows.collect();
    bar.finish_and_clear();
    rows
}
