//! The rows of a campaign as CSV: the state of knowledge at a stage of a mission, then its course so far. Floats are
//! written with enough digits to restore the same bits.

use std::io::{Read, Write};

use anyhow::{Context as _, Result, bail};
use csv::{ReaderBuilder, StringRecord, WriterBuilder};
use serde::Serialize;

use crate::campaign::course::Course;
use crate::campaign::ensemble::{Checkpoint, Measured};
use crate::campaign::order::Order;

/// The planners in order, and whether the first column names them, as it does where planners are compared.
#[derive(Clone, Debug)]
pub struct Planners {
    /// Their names in the rows.
    pub names: Vec<String>,
    /// Whether the first column of a row names its planner.
    pub are_named: bool,
}

impl Planners {
    /// The line that the rows come under.
    ///
    /// # Errors
    /// Never: checkpoints are plain structures.
    pub fn header<C: Checkpoint>(&self) -> Result<String> {
        let who = if self.are_named { "algorithm," } else { "" };
        let (known, course) = (titles(&C::default())?, titles(&Course::default())?);
        Ok(format!("{who}{known},{course}\n"))
    }
}

/// The names of a structure's fields.
fn titles(record: &impl Serialize) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.serialize(record)?;
    let text = String::from_utf8(writer.into_inner()?)?;
    Ok(text.lines().next().unwrap_or_default().to_owned())
}

/// Writes rows.
pub struct RowWriter<W: Write> {
    csv: csv::Writer<W>,
    planners: Planners,
}

impl<W: Write> RowWriter<W> {
    /// Writes rows to `to`, which has their header already.
    pub fn new(to: W, planners: &Planners) -> Self {
        let csv = WriterBuilder::new().has_headers(false).from_writer(to);
        Self { csv, planners: planners.clone() }
    }

    /// Writes a row of the planner with this number.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write<C: Checkpoint>(&mut self, planner: usize, row: &Measured<C>) -> Result<()> {
        let Measured { checkpoint, course } = row;
        if self.planners.are_named {
            self.csv.serialize((&self.planners.names[planner], checkpoint, course))?;
        } else {
            self.csv.serialize((checkpoint, course))?;
        }
        Ok(())
    }

    /// Ends the writing, and returns what the rows were written to.
    ///
    /// # Errors
    /// When the last of them cannot be written.
    pub fn into_inner(self) -> Result<W> {
        self.csv.into_inner().map_err(|error| error.into_error().into())
    }
}

/// A row that was read.
#[derive(Clone, Debug)]
pub struct RowRead<C> {
    /// The number of its planner.
    pub planner: usize,
    /// The byte of the file at which it begins.
    pub begins: u64,
    /// The row.
    pub row: Measured<C>,
}

/// Reads rows, which come by planner, field and stage.
pub struct RowReader<R, C> {
    name: String,
    csv: csv::Reader<R>,
    record: StringRecord,
    titles: Vec<String>,
    planners: Planners,
    order: Order,
    /// A row that was read and belongs to a later planner.
    ahead: Option<RowRead<C>>,
}

impl<R: Read, C: Checkpoint> RowReader<R, C> {
    /// Reads the rows under the header of a file called `name`. They must come in this order.
    ///
    /// # Errors
    /// Names the file if it has another header.
    pub fn new(name: &str, from: R, planners: &Planners, order: Order) -> Result<Self> {
        let mut csv = ReaderBuilder::new().has_headers(false).quoting(false).from_reader(from);
        let mut record = StringRecord::new();
        csv.read_record(&mut record).with_context(|| name.to_owned())?;
        let found = record.iter().collect::<Vec<_>>().join(",");
        let expected = planners.header::<C>()?;
        if found != expected.trim_end() {
            bail!("{name}:1: found the columns {found:?}, expected {:?}", expected.trim_end());
        }
        let titles = record.iter().map(str::to_owned).collect();
        let (name, planners) = (name.to_owned(), planners.clone());
        Ok(Self { name, csv, record, titles, planners, order, ahead: None })
    }

    /// The next row; `None` at the end.
    ///
    /// # Errors
    /// Names the file and the line if that is no row, has a number that is not finite, or is out of order. If rows are
    /// missing, it names the end of the file.
    pub fn read(&mut self) -> Result<Option<RowRead<C>>> {
        if let Some(row) = self.ahead.take() {
            return Ok(Some(row));
        }
        let at = self.csv.position().clone();
        let place = || format!("{}:{}", self.name, at.line());
        if !self.csv.read_record(&mut self.record).with_context(place)? {
            self.order.end().with_context(place)?;
            return Ok(None);
        }
        for (cell, title) in self.record.iter().zip(&self.titles) {
            if cell.parse().is_ok_and(|number: f64| !number.is_finite()) {
                bail!("{}: found {cell} for {title}, expected a finite number", place());
            }
            if cell.chars().any(char::is_control) {
                bail!("{}: found {cell:?} for {title}, expected no control characters", place());
            }
        }
        let read = if self.planners.are_named {
            self.record.deserialize::<(String, C, Course)>(None)
        } else {
            let alone = self.record.deserialize::<(C, Course)>(None);
            alone.map(|(checkpoint, course)| (self.planners.names[0].clone(), checkpoint, course))
        };
        let (name, checkpoint, course) = read.with_context(place)?;
        let Some(planner) = self.planners.names.iter().position(|it| *it == name) else {
            let expected = self.planners.names.join(", ");
            bail!("{}: found the planner {name:?}, expected one of {expected}", place());
        };
        let row = (planner, checkpoint.field(), checkpoint.stage());
        self.order.take(row).with_context(place)?;
        Ok(Some(RowRead { planner, begins: at.byte(), row: Measured { checkpoint, course } }))
    }

    /// The next row of this planner; `None` if the next row is a later planner's, or there is none.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_of(&mut self, planner: usize) -> Result<Option<Measured<C>>> {
        match self.read()? {
            Some(read) if read.planner == planner => Ok(Some(read.row)),
            read => {
                self.ahead = read;
                Ok(None)
            }
        }
    }
}
