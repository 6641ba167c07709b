//! Latitudes that look like longitudes.

use crate::replay::rows::{Layout, Rows, Unit};

/// The first row that shows swapped degrees, with the message; `None` if the latitudes may be latitudes.
pub(crate) fn first(rows: &Rows, layout: &Layout) -> Option<(usize, String)> {
    let is_beyond = |at: &[f64; 2]| at[0].abs() > 90.0;
    let beyond = rows.positions.iter().filter(|at| is_beyond(at)).count();
    // A few are mistakes in rows, which are reported one by one.
    let all_would_do =
        rows.positions.iter().all(|[lat, lon]| lat.abs() <= 360.0 && lon.abs() <= 90.0);
    if 2 * beyond <= rows.positions.len() || !all_would_do {
        return None;
    }
    let index = rows.positions.iter().position(is_beyond)?;
    let lat = rows.positions[index][0];
    let remedy = match (&rows.titles, rows.unit) {
        (Some([lat, lon]), _) => {
            let label = layout.columns.as_ref().and_then(|columns| columns.label());
            let label = label.map(|label| format!(",label={label}")).unwrap_or_default();
            format!("name them by --columns lat={lon},lon={lat}{label}")
        }
        (None, Unit::Feature) => "positions of GeoJSON have their longitude first".to_owned(),
        (None, Unit::Line) => "write them the other way round".to_owned(),
    };
    Some((
        index,
        format!("found the latitude {lat}: latitude and longitude look swapped; {remedy}"),
    ))
}
