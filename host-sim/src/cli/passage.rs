//! The path of a campaign's rows. They come from files that already contain them, then from missions that are flown, in
//! the order of planners and fields. They go into a file and into the summary. No stage holds more than a few rows.

use std::cmp::Ordering;
use std::io::{self, Read, Write};
use std::iter;
use std::ops::Range;

use anyhow::Result;

use crate::campaign::ensemble::{Campaign, Measure, Measured};
use crate::campaign::rows::{RowReader, RowWriter};
use crate::cli::campaign_record::CampaignRecord;
use crate::output::file::{Output, json};
use crate::output::partial::Partial;

/// Where rows go.
#[derive(Debug)]
pub(crate) enum Destination {
    /// A file that grows beside its place, and the record that is to stand beside it for good.
    Partial(Partial, Option<Box<CampaignRecord>>),
    /// A file that nobody goes on with, or a stream.
    Output(Output),
}

impl Destination {
    /// All is written.
    pub(crate) fn complete(self) -> Result<()> {
        match self {
            Self::Partial(partial, record) => partial.complete(|bytes, checksum| {
                record.map(|it| json(&CampaignRecord { bytes: Some(bytes), checksum, ..*it }))
            }),
            Self::Output(output) => output.complete(),
        }
    }
}

impl Write for Destination {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Partial(partial, _) => partial.write(bytes),
            Self::Output(output) => output.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Partial(partial, _) => partial.flush(),
            Self::Output(output) => output.flush(),
        }
    }
}

/// What is to be flown.
#[derive(Clone, Debug)]
pub(crate) struct ToFly {
    /// Of each planner.
    pub(crate) fields: Range<u64>,
    /// The planner and the field with which to begin: what is before is recorded.
    pub(crate) from: (usize, u64),
}

impl ToFly {
    /// With which field a planner begins.
    fn first(&self, planner: usize) -> u64 {
        let (first, field) = self.from;
        match planner.cmp(&first) {
            Ordering::Less => self.fields.end,
            Ordering::Equal => field,
            Ordering::Greater => self.fields.start,
        }
    }
}

/// Rows on their way.
pub(crate) struct Passage<'a, M: Measure> {
    pub(crate) measure: &'a M,
    /// Files with rows, in the order of their fields.
    pub(crate) recorded: Vec<RowReader<Box<dyn Read>, M::Checkpoint>>,
    /// What is flown after that; `None` if all is recorded.
    pub(crate) to_fly: Option<ToFly>,
    /// Where rows are written.
    pub(crate) writer: Option<RowWriter<Destination>>,
    /// Whether it wants the recorded ones too.
    pub(crate) wants_recorded: bool,
}

impl<M: Measure> Passage<'_, M> {
    /// The rows of a planner, which are written as they pass. Planners come in their order, each once.
    pub(crate) fn rows<'a>(
        &'a mut self,
        number: usize,
        campaign: &'a Campaign,
    ) -> Result<impl Iterator<Item = Result<Measured<M::Checkpoint>>> + 'a> {
        let Self { measure, recorded, to_fly, writer, wants_recorded } = self;
        let mut files = recorded.iter_mut().peekable();
        let recorded = iter::from_fn(move || {
            while let Some(file) = files.peek_mut() {
                match file.read_of(number).transpose() {
                    Some(row) => return Some(row),
                    None => files.next(),
                };
            }
            None
        });
        let flight = match to_fly {
            Some(to_fly) => {
                Some(campaign.fly(*measure, to_fly.fields.clone(), to_fly.first(number))?)
            }
            None => None,
        };
        let recorded = recorded.map(|row| (row, *wants_recorded));
        let rows = recorded.chain(flight.into_iter().flatten().map(|row| (row, true)));
        Ok(rows.map(move |(row, is_wanted)| {
            let row = row?;
            if let Some(writer) = writer.as_mut().filter(|_| is_wanted) {
                writer.write(number, &row)?;
            }
            Ok(row)
        }))
    }

    /// All have passed.
    pub(crate) fn complete(self) -> Result<()> {
        self.writer.map_or(Ok(()), |writer| writer.into_inner()?.complete())
    }
}
