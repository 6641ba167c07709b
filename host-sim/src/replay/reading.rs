//! The rows of a file as they are read, whatever its kind: numbers, labels, and rows that lack a value.

use anyhow::{Context as _, Result, anyhow};
use planner_core::Label;

use crate::replay::delimiter::Delimiter;
use crate::replay::label_words::LabelWords;
use crate::replay::numbers::Numbers;
use crate::replay::rows::{Layout, Rows};

/// A row.
pub(crate) enum Row {
    /// A sample: its position and its label.
    Sample([f64; 2], Label),
    /// What it lacks, if that is a value.
    Gap(String),
}

/// A file that is being read.
pub(crate) struct Reading<'a> {
    pub(crate) name: &'a str,
    pub(crate) layout: &'a Layout,
    pub(crate) rows: Rows,
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
        delimiter: Option<Delimiter>,
        pass: impl Fn(&mut Self) -> Result<()>,
    ) -> Result<Rows> {
        let mut settled = None;
        loop {
            let numbers = Numbers::of(delimiter, settled);
            let words = LabelWords::of(layout.threshold);
            let mut reading = Self { name, layout, rows: Rows::default(), numbers, words };
            pass(&mut reading)?;
            let Self { rows, numbers, words, .. } = reading;
            let at = |(row, error): (usize, anyhow::Error)| {
                anyhow!("{}: {error}", rows.unit.place(name, row))
            };
            words.end().map_err(at)?;
            settled = numbers.end().map_err(at)?;
            if settled.is_none() {
                return Ok(rows);
            }
        }
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
        let taken = read(self).and_then(|row| match row {
            Row::Sample(position, label) => {
                self.rows.push(position, label, number);
                Ok(())
            }
            Row::Gap(lacks) => self.rows.skip(self.layout, number, lacks),
        });
        taken.map_err(|error| anyhow!("{}: {error}", self.rows.unit.place(self.name, number)))
    }

    /// The number in a field of this name.
    pub(crate) fn number(&mut self, name: &str, field: &str, row: usize) -> Result<f64> {
        let number = self.numbers.read(field, row);
        number.with_context(|| format!("{name}: found {field:?}, expected a finite number"))
    }

    /// The label in a field.
    pub(crate) fn label(&mut self, field: &str, row: usize) -> Result<Label> {
        self.words.read(field, &mut self.numbers, row)
    }
}
