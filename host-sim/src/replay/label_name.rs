//! The name of the property of `GeoJSON`, or of the element of GPX, that contains the label.

use anyhow::{Result, anyhow, bail};

use crate::replay::columns::Columns;
use crate::replay::rows::Layout;

/// The name of what contains the label, in a file that has its positions in a place of their own.
pub(crate) struct LabelName<'a> {
    pub(crate) wanted: &'a str,
    /// Whether it was named by a flag.
    is_named: bool,
    /// The first point, and what that has.
    pub(crate) first: Option<(usize, Vec<String>)>,
    /// Whether any point has it.
    is_there: bool,
}

impl<'a> LabelName<'a> {
    /// The name in a file of some kind.
    ///
    /// # Errors
    /// Names a flag that does not fit such a file.
    pub(crate) fn of(name: &str, kind: &str, layout: &'a Layout) -> Result<Self> {
        if layout.delimiter.is_some() {
            bail!("--delimiter: found {kind} in {name}, expected a table with it");
        }
        let columns = layout.columns.as_ref();
        if columns.is_some_and(Columns::name_positions) {
            bail!(
                "--columns: found {kind} in {name}, whose positions need no name; expected label=NAME alone"
            );
        }
        let wanted = columns.and_then(Columns::label).unwrap_or("label");
        Ok(Self { wanted, is_named: columns.is_some(), first: None, is_there: false })
    }

    /// Takes in a point: its number, whether it has what is wanted, and the names of all it has.
    pub(crate) fn see(&mut self, number: usize, is_there: bool, all: impl FnOnce() -> Vec<String>) {
        self.first.get_or_insert_with(|| (number, all()));
        self.is_there |= is_there;
    }

    /// All points were seen. `place` is the place of one.
    ///
    /// # Errors
    /// Says what the first point has, if no point has what is wanted.
    pub(crate) fn end(&self, place: impl Fn(usize) -> String) -> Result<()> {
        let Some((number, others)) = self.first.as_ref().filter(|_| !self.is_there) else {
            return Ok(());
        };
        let others: Vec<_> = others.iter().map(|other| format!("{other:?}")).collect();
        let others = if others.is_empty() { "nothing".to_owned() } else { others.join(", ") };
        let (place, wanted) = (place(*number), self.wanted);
        Err(if self.is_named {
            anyhow!(
                "--columns label={wanted}: found {others} at {place}, expected {wanted:?} among them"
            )
        } else {
            anyhow!(
                "{place}: found {others}, expected {wanted:?} among them, or --columns label=NAME"
            )
        })
    }
}
