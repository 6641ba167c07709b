//! The rows of a file as they are read, whatever its kind: numbers, labels, and rows that lack a value.

use anyhow::{Context as _, Error, Result, anyhow, bail};
use serde_json::Value;

use crate::replay::columns::Columns;
use crate::replay::degrees::degrees;
use crate::replay::label_words::LabelWords;
use crate::replay::numbers::Numbers;
use crate::replay::rows::{Layout, Recorded, Rows, Told};

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

/// What a row lacks, if that is a value.
pub(crate) type Gap = Option<String>;

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
        read: impl FnOnce(&mut Self) -> Result<Gap>,
    ) -> Result<()> {
        self.told.clear();
        let taken = read(self).and_then(|gap| match gap {
            Some(lacks) => self.rows.skip(self.layout, number, &lacks),
            None => Ok(()),
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

    /// The number in a field of this name, or its degrees if it is of an axis of the globe.
    fn coordinate(&mut self, name: &str, field: &str, row: usize) -> Result<f64> {
        let degrees = degrees(name, field).filter(|_| self.rows.is_geographic);
        let found = degrees.or_else(|| self.numbers.read(field, row));
        let or = match name {
            "lat" => "degrees: a finite number, or as 54 12.06 N",
            "lon" => "degrees: a finite number, or as 10 48 7.2 E",
            _ => "a finite number",
        };
        found.with_context(|| format!("{name}: found {field:?}, expected {or}"))
    }

    /// The sample of a row whose fields have these names: two of its position, and its label.
    pub(crate) fn sample(
        &mut self,
        names: [&str; 3],
        fields: [&str; 3],
        row: usize,
    ) -> Result<Gap> {
        if let Some((name, field)) = names.iter().zip(fields).find(|it| is_missing(it.1)) {
            return Ok(Some(format!("{name}: found {field:?}")));
        }
        let [a, b] = [0, 1].map(|k| self.coordinate(names[k], fields[k], row));
        self.samples(&[[a?, b?]], fields[2], row)
    }

    /// Samples at positions, with the label in a field, which may leave it open.
    pub(crate) fn samples(
        &mut self,
        positions: &[[f64; 2]],
        field: &str,
        line: usize,
    ) -> Result<Gap> {
        let Some((label, value)) = self.words.read(field, &mut self.numbers, line)? else {
            return Ok(Some(format!("label: found {field:?}, which may be on both sides")));
        };
        for &position in positions {
            let told = self.told.clone();
            self.rows.samples.push(Recorded { position, label, value, line, told });
        }
        Ok(None)
    }
}
