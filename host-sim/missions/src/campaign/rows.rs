//! The rows of a campaign as CSV: the state of knowledge at a stage of a mission, then its course so far. Floats are
//! written with enough digits to restore the same bits.

use std::io::Write;

use anyhow::Result;
use csv::WriterBuilder;
use serde::Serialize;

use crate::campaign::course::Course;
use crate::campaign::ensemble::Measured;

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
    pub fn header<C: Default + Serialize>(&self) -> Result<String> {
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
    pub fn write<C: Serialize>(&mut self, planner: usize, row: &Measured<C>) -> Result<()> {
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
