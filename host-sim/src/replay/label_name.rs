//! The name of the property of `GeoJSON`, or of the element of GPX, that contains the label.

use anyhow::{Result, anyhow, bail};

use crate::replay::columns::Columns;
use crate::replay::rows::Layout;

/// The name of what contains the label, in a file that has its positions in a place of their own.
///
/// # Errors
/// Names a flag that does not fit such a file.
pub(crate) fn label_name<'a>(name: &str, kind: &str, layout: &'a Layout) -> Result<&'a str> {
    if layout.delimiter.is_some() {
        bail!("--delimiter: found {kind} in {name}, expected a table with it");
    }
    let columns = layout.columns.as_ref();
    if columns.is_some_and(Columns::name_positions) {
        bail!(
            "--columns: found {kind} in {name}, whose positions need no name; expected label=NAME alone"
        );
    }
    Ok(columns.and_then(Columns::label).unwrap_or("label"))
}

/// The error for a file in which no point has the wanted label: it has these others instead.
pub(crate) fn no_label(
    place: &str,
    wanted: &str,
    layout: &Layout,
    others: &[String],
) -> anyhow::Error {
    let others: Vec<_> = others.iter().map(|other| format!("{other:?}")).collect();
    let others = if others.is_empty() { "nothing".to_owned() } else { others.join(", ") };
    match layout.columns {
        Some(_) => anyhow!(
            "--columns label={wanted}: found {others} at {place}, expected {wanted:?} among them"
        ),
        None => anyhow!(
            "{place}: found {others}, expected {wanted:?} among them, or --columns label=NAME"
        ),
    }
}
