//! The samples of a table: a file of rows with columns, delimiters and numbers of many kinds.

use std::borrow::Cow;

use anyhow::{Context as _, Result, anyhow};
use csv::ByteRecord;
use planner_core::Label;

use crate::replay::columns::{Columns, Places};
use crate::replay::delimiter::Delimiter;
use crate::replay::label_words::LabelWords;
use crate::replay::missing::is_missing;
use crate::replay::numbers::{self, Decimal, Numbers};
use crate::replay::rows::{Layout, Rows};

fn reader(text: &[u8], delimiter: Delimiter) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(COMMENT))
        .delimiter(delimiter.byte())
        .from_reader(text)
}

/// The fields of a row. Several spaces between two fields make empty ones, which are left out.
fn fields(row: &ByteRecord, delimiter: Delimiter) -> impl Iterator<Item = &[u8]> {
    row.iter().filter(move |field| delimiter != Delimiter::Space || !field.is_empty())
}

/// One field of a row.
fn field(row: &ByteRecord, delimiter: Delimiter, column: usize) -> Cow<'_, str> {
    let field = match delimiter {
        Delimiter::Space => fields(row, delimiter).nth(column),
        _ => row.get(column),
    };
    String::from_utf8_lossy(field.unwrap_or_default())
}

/// The columns by the first row, read with a delimiter; `at` is the place of that row, for errors.
fn places(at: &str, first: &ByteRecord, columns: &Columns, delimiter: Delimiter) -> Result<Places> {
    let titles: Vec<_> = fields(first, delimiter).map(String::from_utf8_lossy).collect();
    let titles: Vec<_> = titles.iter().map(AsRef::as_ref).collect();
    // A value that is missing is no title, and no title is empty.
    let is_value = |field: &str| {
        let number = Numbers::of(Some(delimiter), None).read(field, 0);
        number.is_some() || (!field.is_empty() && is_missing(field))
    };
    columns.places(at, &titles, is_value)
}

/// The first delimiter with which the first row can be understood; if there is none, the comma.
fn guess(text: &[u8], columns: &Columns) -> Delimiter {
    let is_clear = |delimiter: &Delimiter| {
        let mut first = ByteRecord::new();
        let read = reader(text, *delimiter).read_byte_record(&mut first);
        read.is_ok_and(|there| there) && places("", &first, columns, *delimiter).is_ok()
    };
    Delimiter::ALL.into_iter().find(is_clear).unwrap_or(Delimiter::Comma)
}

/// The rows of a table.
///
/// # Errors
/// Names the file and the line, what was found and what was expected.
pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Rows> {
    numbers::settled(|decimal| pass(name, text, layout, decimal))
}

/// A pass over the rows, with the decimal separator if it is known. It returns the separator if another pass is needed.
fn pass(
    name: &str,
    text: &[u8],
    layout: &Layout,
    settled: Option<Decimal>,
) -> Result<(Rows, Option<Decimal>)> {
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
    let first = format!("{name}:{}", line.unwrap_or(1));
    let places = places(&first, &row, &columns, delimiter)?;
    let mut titles = None;
    if places.has_header {
        let title = |column: usize| field(&row, delimiter, column).trim().to_owned();
        titles = Some(places.position.map(title));
        line = next(&mut row)?;
    }
    let mut reading = Reading {
        places,
        delimiter,
        numbers: Numbers::of(Some(delimiter), settled),
        words: LabelWords::of(layout.threshold),
    };
    let mut rows = Rows { is_geographic: places.is_geographic, titles, ..Rows::default() };
    while let Some(number) = line {
        match reading.row(&row, number).map_err(|error| at(number, error))? {
            Found::Sample(position, label) => rows.push(position, label, number),
            Found::Gap(lacks) => {
                rows.skip(layout, number, lacks).map_err(|error| at(number, error))?;
            }
        }
        line = next(&mut row)?;
    }
    reading.words.end().map_err(|(line, error)| at(line, error))?;
    let settled = reading.numbers.end().map_err(|(line, error)| at(line, error))?;
    Ok((rows, settled))
}

/// What a row is.
enum Found {
    Sample([f64; 2], Label),
    /// It lacks a value.
    Gap(String),
}

/// What the rows of a file are read with.
struct Reading {
    places: Places,
    delimiter: Delimiter,
    numbers: Numbers,
    words: LabelWords,
}

impl Reading {
    fn row(&mut self, row: &ByteRecord, line: usize) -> Result<Found> {
        let Places { position, label, .. } = self.places;
        let [first, second] = self.places.names();
        let columns = [(first, position[0]), (second, position[1]), ("label", label)];
        let fields = columns.map(|(_, column)| field(row, self.delimiter, column));
        let texts = fields.each_ref().map(|field| field.trim());
        let named = columns.iter().zip(texts);
        if let Some(((name, _), text)) = named.clone().find(|(_, text)| is_missing(text)) {
            return Ok(Found::Gap(format!("{name}: found {text:?}")));
        }
        let mut at = [0.0; 2];
        for (at, ((name, _), text)) in at.iter_mut().zip(named) {
            *at = self
                .numbers
                .read(text, line)
                .with_context(|| format!("{name}: found {text:?}, expected a finite number"))?;
        }
        Ok(Found::Sample(at, self.words.read(texts[2], &mut self.numbers, line)?))
    }
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

    /// The line on which a row begins. The reader counts a row from the end of the row before. Blank lines and comments
    /// between the two are skipped here.
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
