//! The rows of a file as they are read, whatever its kind: numbers, labels, and rows that lack a value.

use anyhow::{Context as _, Error, Result, anyhow, bail};
use planner_core::Label;
use serde_json::Value;

use crate::replay::columns::Columns;
use crate::replay::degrees::degrees;
use crate::replay::label_words::LabelWords;
use crate::replay::numbers::Numbers;
use crate::replay::rows::{Layout, Rows, Told};

/// Words that stand where nothing was measured, in upper or lower case.
const MISSING: [&str; 20] = [
    "", "nan", "na", "n/a", "#n/a", "null", "none", "nil", "nodata", "no data", "missing", "nd",
    "n.d.", "bdl", "-", "--", "---", "?", "*", "***",
];

/// Numbers that do, and that no position has. `fills` has those of measured values.
const MISSING_NUMBERS: [f64; 2] = [-9999.0, -99999.0];

/// Whether a field says that there is no value.
pub(crate) fn is_missing(field: &str) -> bool {
    let is_number = || field.parse().is_ok_and(|it| MISSING_NUMBERS.contains(&it));
    MISSING.iter().any(|word| field.eq_ignore_ascii_case(word))
        || field.starts_with("-9999") && is_number()
}

/// A row.
pub(crate) enum Row {
    /// Samples: their positions, their label, and the value that it was measured as.
    Samples(Vec<[f64; 2]>, Label, Option<f64>),
    /// What it lacks, if that is a value.
    Gap(String),
}

/// A file that is being read.
pub(crate) struct Reading<'a> {
    pub(crate) name: &'a str,
    pub(crate) layout: &'a Layout,
    pub(crate) rows: Rows,
    /// What else the present row says.
    pub(crate) told: Told,
    numbers: Numbers,
    words: LabelWords,
}

impl<'a> Reading<'a> {
    /// The rows of a file, which a pass over it takes down. Only the end of a file may show its decimal separator. Then
    /// a second pass reads with it.
    ///
    /// # Errors
    /// Those of a pass. Else names the file and the row whose number or label does not go with the others.
    pub(crate) fn of(
        name: &'a str,
        layout: &'a Layout,
        delimiter: Option<u8>,
        pass: impl Fn(&mut Self) -> Result<()>,
    ) -> Result<Rows> {
        let mut settled = None;
        loop {
            let numbers = Numbers::of(delimiter, settled);
            let words = LabelWords::of(layout.threshold);
            let mut reading =
                Self { name, layout, rows: Rows::default(), told: Told::new(), numbers, words };
            pass(&mut reading)?;
            let Self { mut rows, numbers, words, .. } = reading;
            let unit = rows.unit;
            let at = |(row, error): (usize, Error)| anyhow!("{}: {error}", unit.place(name, row));
            words.end().map_err(at)?;
            settled = numbers.end().map_err(at)?;
            if settled.is_none() {
                rows.leave_out_fills(layout).map_err(at)?;
                rows.leave_out_unfixed(layout).map_err(at)?;
                return Ok(rows);
            }
        }
    }

    /// The name of what contains the label, in a file of some kind that has its positions in a place of their own.
    ///
    /// # Errors
    /// Names a flag that does not fit such a file.
    pub(crate) fn label(&self, kind: &str) -> Result<&'a str> {
        let (name, Layout { columns, delimiter, .. }) = (self.name, self.layout);
        if delimiter.is_some() {
            bail!("--delimiter: found {kind} in {name}, expected a table with it");
        }
        if columns.as_ref().is_some_and(Columns::name_positions) {
            bail!(
                "--columns: found {kind} in {name}, whose positions need no name; expected label=NAME alone"
            );
        }
        Ok(columns.as_ref().and_then(Columns::label).unwrap_or("label"))
    }

    /// The error for a file in which no point has its label under this name. The first one has others.
    pub(crate) fn no_label(&self, wanted: &str, number: usize, others: &[String]) -> Error {
        let others: Vec<_> = others.iter().map(|other| format!("{other:?}")).collect();
        let others = if others.is_empty() { "nothing".to_owned() } else { others.join(", ") };
        let place = self.rows.unit.place(self.name, number);
        if self.layout.columns.is_some() {
            return anyhow!(
                "--columns label={wanted}: found {others} at {place}, expected {wanted:?} among them"
            );
        }
        anyhow!("{place}: found {others}, expected {wanted:?} among them, or --columns label=NAME")
    }

    /// Takes down a row.
    ///
    /// # Errors
    /// Names the file and the row.
    pub(crate) fn row(
        &mut self,
        number: usize,
        read: impl FnOnce(&mut Self) -> Result<Row>,
    ) -> Result<()> {
        self.told.clear();
        let taken = read(self).and_then(|row| match row {
            Row::Samples(positions, label, value) => {
                for position in positions {
                    self.rows.push(position, label, number);
                    self.rows.values.extend(value);
                    self.rows.told.extend(self.layout.keeps.then(|| self.told.clone()));
                }
                Ok(())
            }
            Row::Gap(lacks) => self.rows.skip(self.layout, number, lacks),
        });
        taken.map_err(|error| anyhow!("{}: {error}", self.rows.unit.place(self.name, number)))
    }

    /// Keeps what else the row says, if that is wanted: names and texts, which may be numbers.
    pub(crate) fn keep(&mut self, told: impl Iterator<Item = (String, String)>) {
        if self.layout.keeps {
            let value = |text: String| {
                serde_json::from_str(&text).map_or_else(|_| text.into(), Value::Number)
            };
            self.told.extend(told.map(|(name, text)| (name, value(text))));
        }
    }

    /// The number in a field of this name.
    pub(crate) fn number(&mut self, name: &str, field: &str, row: usize) -> Result<f64> {
        let number = self.numbers.read(field, row);
        number.with_context(|| format!("{name}: found {field:?}, expected a finite number"))
    }

    /// The number in a field of this name, or its degrees if it is of an axis of the globe.
    pub(crate) fn coordinate(&mut self, name: &str, field: &str, row: usize) -> Result<f64> {
        if !self.rows.is_geographic {
            return self.number(name, field, row);
        }
        let found = degrees(name, field).or_else(|| self.numbers.read(field, row));
        found.with_context(|| {
            let example = if name == "lat" { "54 12.06 N" } else { "10 48 7.2 E" };
            format!("{name}: found {field:?}, expected degrees: a finite number, or as {example}")
        })
    }

    /// Samples at positions, with the label in a field. A gap, if the field leaves the label open.
    pub(crate) fn samples(
        &mut self,
        positions: Vec<[f64; 2]>,
        field: &str,
        row: usize,
    ) -> Result<Row> {
        let told = self.words.read(field, &mut self.numbers, row)?;
        let open = || Row::Gap(format!("label: found {field:?}, which may be on both sides"));
        Ok(told.map_or_else(open, |(label, value)| Row::Samples(positions, label, value)))
    }
}
