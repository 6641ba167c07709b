//! Where the rows of a campaign go: a file that grows beside its place, or a stream.

use std::io::{self, Write};
use std::path::Path;

use anyhow::{Context as _, Result};

use crate::output::file::{Output, place_for, prepare};
use crate::output::partial::{Begin, Partial};

#[derive(Debug)]
pub(crate) enum RowsFile {
    Growing(Partial),
    Stream(Output),
}

impl RowsFile {
    /// Begins it with the header of the rows.
    ///
    /// # Errors
    /// Names the file that is there already, or that cannot be written.
    pub(crate) fn open(path: &Path, header: &str) -> Result<Self> {
        let place = place_for(path)?;
        if place.is_stream() {
            let [output] = prepare(&[], [("--csv", Some(path))])?;
            let mut output = output.context("a place that was asked for")?;
            output.write_all(header.as_bytes())?;
            return Ok(Self::Stream(output));
        }
        let goes_on = "--from goes on with the fields that are missing";
        let partial =
            Partial::open(path, &place, header, Begin { holds: "rows", goes_on, resume: false })?;
        partial.announce();
        Ok(Self::Growing(partial))
    }

    /// All is written.
    pub(crate) fn complete(self) -> Result<()> {
        match self {
            Self::Growing(partial) => partial.complete(),
            Self::Stream(output) => output.complete(),
        }
    }
}

impl Write for RowsFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Growing(partial) => partial.write(bytes),
            Self::Stream(output) => output.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Growing(partial) => partial.flush(),
            Self::Stream(output) => output.flush(),
        }
    }
}
