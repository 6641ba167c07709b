//! Recorded samples: a file of rows, or a trace of our own.

use std::fs;
use std::path::Path;

use anyhow::{Result, anyhow};
use csv::ByteRecord;
use planner_core::belief::sample::{Label, Sample};

use crate::output::plain;
use crate::replay::columns::{Columns, Places};
use crate::replay::delimiter::Delimiter;
use crate::replay::frame::Frame;
use crate::replay::label_words::LabelWords;
use crate::replay::rows::{Layout, Rows};
use crate::replay::trace_file;

/// Samples in the order in which they were recorded.
pub(crate) struct SampleFile {
    /// What the file is called.
    pub(crate) name: String,
    /// The samples.
    pub(crate) samples: Vec<Sample>,
    /// What their positions are in the file.
    pub(crate) frame: Frame,
    /// The samples whose labels are certain, whatever `p` is.
    pub(crate) certain: Vec<usize>,
    /// How often the others are true, where the file tells it.
    pub(crate) p: Option<f64>,
    /// The line of the file on which each begins.
    lines: Vec<usize>,
}

impl SampleFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the file and the line, what was found and what was expected.
    pub(crate) fn read(path: &Path, layout: &Layout) -> Result<Self> {
        let name = plain::name(&path.display().to_string());
        let text = fs::read(path)
            .map_err(|error| anyhow!("{name}: expected a readable CSV file: {error}"))?;
        Self::parse(&name, &text, layout)
    }

    /// As [`read`](Self::read), from the text of the file called `name`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Self> {
        let rows = if trace_file::is_one(text) {
            trace_file::parse(name, text, layout)?
        } else {
            parse_rows(name, text, layout)?
        };
        let at = |index: usize| format!("{name}:{}", rows.lines[index]);
        let frame = Frame::of(&rows.positions, rows.is_geographic, layout.origin)
            .map_err(|error| anyhow!("{name}: {error}"))?;
        let sample = |(index, (position, label)): (usize, (&[f64; 2], &Label))| {
            let site = frame.site(*position).map_err(|error| anyhow!("{}: {error}", at(index)))?;
            Ok(Sample { site, label: *label })
        };
        let both = rows.positions.iter().zip(&rows.labels);
        let samples = both.enumerate().map(sample).collect::<Result<_>>()?;
        let Rows { certain, p, lines, .. } = rows;
        Ok(Self { name: name.to_owned(), samples, frame, certain, p, lines })
    }

    /// The line on which a sample begins.
    pub(crate) fn line(&self, index: usize) -> usize {
        self.lines[index]
    }

    /// The file and the line of a sample.
    pub(crate) fn place(&self, index: usize) -> String {
        format!("{}:{}", self.name, self.line(index))
    }
}

fn reader(text: &[u8], delimiter: Delimiter) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(COMMENT))
        .delimiter(delimiter.byte())
        .from_reader(text)
}

/// The fields of a row: of several spaces between two, each but the last ends an empty one.
fn fields(row: &ByteRecord, delimiter: Delimiter) -> impl Iterator<Item = &[u8]> {
    row.iter().filter(move |field| delimiter != Delimiter::Space || !field.is_empty())
}

/// What the first row says, read with a delimiter.
fn places(first: &ByteRecord, columns: &Columns, delimiter: Delimiter) -> Result<Places> {
    let titles: Vec<_> = fields(first, delimiter).map(String::from_utf8_lossy).collect();
    let titles: Vec<_> = titles.iter().map(AsRef::as_ref).collect();
    columns.places(&titles, |field| delimiter.number(field).is_some())
}

/// The first delimiter with which the first row can be understood; if there is none, the comma.
fn guess(text: &[u8], columns: &Columns) -> Delimiter {
    let is_clear = |delimiter: &Delimiter| {
        let mut first = ByteRecord::new();
        let read = reader(text, *delimiter).read_byte_record(&mut first);
        read.is_ok_and(|there| there) && places(&first, columns, *delimiter).is_ok()
    };
    Delimiter::ALL.into_iter().find(is_clear).unwrap_or(Delimiter::Comma)
}

fn parse_rows(name: &str, text: &[u8], layout: &Layout) -> Result<Rows> {
    let columns = layout.columns.clone().unwrap_or_default();
    let delimiter = layout.delimiter.unwrap_or_else(|| guess(text, &columns));
    let mut reader = reader(text, delimiter);
    let mut lines = Lines::of(text);
    let mut row = ByteRecord::new();
    let mut next = |row: &mut ByteRecord| -> Result<Option<usize>> {
        let there = reader.read_byte_record(row).map_err(|error| anyhow!("{name}: {error}"))?;
        Ok(there.then(|| lines.row(row)))
    };
    let mut line = next(&mut row)?;
    let at = |line: usize, error: anyhow::Error| anyhow!("{name}:{line}: {error}");
    let places = places(&row, &columns, delimiter).map_err(|error| at(line.unwrap_or(1), error))?;
    if places.has_header {
        line = next(&mut row)?;
    }
    let mut words = LabelWords::default();
    let mut rows = Rows { is_geographic: places.is_geographic, ..Rows::default() };
    while let Some(number) = line {
        let (position, label) = parse_row(&row, places, delimiter, &mut words, number)
            .map_err(|error| at(number, error))?;
        rows.push(position, label, number);
        line = next(&mut row)?;
    }
    words.end().map_err(|(line, error)| at(line, error))?;
    Ok(rows)
}

fn parse_row(
    row: &ByteRecord,
    places: Places,
    delimiter: Delimiter,
    words: &mut LabelWords,
    line: usize,
) -> Result<([f64; 2], Label)> {
    let field = |column: usize| {
        let field = match delimiter {
            Delimiter::Space => fields(row, delimiter).nth(column),
            _ => row.get(column),
        };
        String::from_utf8_lossy(field.unwrap_or_default())
    };
    let [first, second] = places.names();
    let number = |name: &str, column: usize| {
        let field = field(column);
        // Of the first field of a file without titles, too.
        let text = field.trim_start_matches('\u{feff}').trim();
        let value = delimiter.number(text);
        value.ok_or_else(|| anyhow!("{name}: found {field:?}, expected a finite number"))
    };
    let position = [number(first, places.position[0])?, number(second, places.position[1])?];
    Ok((position, words.read(field(places.label).trim(), line)?))
}

const COMMENT: u8 = b'#';

/// Counts the lines of a text as far as it has been read.
struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Lines<'a> {
    fn of(text: &'a [u8]) -> Self {
        Self { text, at: 0, line: 1 }
    }

    /// The line on which a row begins. What its position counts as its beginning may be the end of the row
    /// before, and blank lines and comments between the two.
    fn row(&mut self, row: &ByteRecord) -> usize {
        let begins = row.position().map_or(0, |position| position.byte() as usize);
        while self.at < begins {
            self.advance();
        }
        loop {
            match self.text.get(self.at) {
                Some(b'\r' | b'\n') => self.advance(),
                Some(&COMMENT) => {
                    while self.text.get(self.at).is_some_and(|byte| *byte != b'\n') {
                        self.advance();
                    }
                }
                _ => return self.line,
            }
        }
    }

    fn advance(&mut self) {
        match self.text[self.at..] {
            [b'\r', b'\n', ..] => {} // the second ends the line
            [b'\r' | b'\n', ..] => self.line += 1,
            _ => {}
        }
        self.at += 1;
    }
}
