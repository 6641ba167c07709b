//! The samples of a table: a file of rows with columns, delimiters and numbers of many kinds.

use std::borrow::Cow;

use anyhow::{Context as _, Result, anyhow, bail};
use csv::ByteRecord;

use crate::replay::columns::{Columns, Places};
use crate::replay::degrees::degrees;
use crate::replay::numbers::Numbers;
use crate::replay::reading::{Reading, Row, is_missing};
use crate::replay::rows::{Layout, Rows};

/// Characters between fields, by their names, in the order in which they are tried. A space may be several.
const DELIMITERS: [(u8, &str); 5] =
    [(b',', "comma"), (b';', "semicolon"), (b'\t', "tab"), (b'|', "pipe"), (SPACE, "space")];
const SPACE: u8 = b' ';

/// A delimiter, by its name or as it is.
///
/// # Errors
/// What was found and what was expected.
pub fn delimiter(text: &str) -> Result<u8> {
    let is_it = |(it, name): &(u8, &str)| text == *name || text.as_bytes() == [*it];
    let found = DELIMITERS.iter().find(|it| is_it(it)).map(|it| it.0);
    found.with_context(|| format!("found {text:?}, expected comma, semicolon, tab, pipe or space"))
}

fn reader(text: &[u8], delimiter: u8) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(COMMENT))
        .delimiter(delimiter)
        .from_reader(text)
}

/// The fields of a row. Several spaces between two fields make empty ones, which are left out.
fn fields(row: &ByteRecord, delimiter: u8) -> impl Iterator<Item = &[u8]> {
    row.iter().filter(move |field| delimiter != SPACE || !field.is_empty())
}

/// One field of a row.
fn field(row: &ByteRecord, delimiter: u8, column: usize) -> Cow<'_, str> {
    let field = match delimiter {
        SPACE => fields(row, delimiter).nth(column),
        _ => row.get(column),
    };
    String::from_utf8_lossy(field.unwrap_or_default())
}

/// The columns by the first row, read with a delimiter; `at` is the place of that row, for errors.
fn places(at: &str, first: &ByteRecord, columns: &Columns, delimiter: u8) -> Result<Places> {
    let titles: Vec<_> = fields(first, delimiter).map(String::from_utf8_lossy).collect();
    let titles: Vec<_> = titles.iter().map(AsRef::as_ref).collect();
    // A value that is missing is no title, and no title is empty.
    let is_value = |field: &str| {
        let number = Numbers::of(Some(delimiter), None).read(field, 0);
        let degrees = ["lat", "lon"].iter().any(|axis| degrees(axis, field).is_some());
        number.is_some() || degrees || (!field.is_empty() && is_missing(field))
    };
    columns.places(at, &titles, is_value)
}

/// Rows that may stand above the heading, as loggers write them.
const PREAMBLE: usize = 200;

/// Rows below the heading that may have units or the like in place of positions.
const UNITS: usize = 3;

/// The delimiter of the heading, and how many rows stand above it. The heading is the first row that can be understood
/// with some delimiter. Without one, the answer is a comma and no row.
fn heading(text: &[u8], columns: &Columns, delimiter: Option<u8>) -> (u8, usize) {
    let all = delimiter.map_or(DELIMITERS.map(|it| it.0).to_vec(), |it| vec![it]);
    let above = |delimiter: &u8| {
        // Words of a sentence are no titles.
        let is_guessed = all.len() > 1 && *delimiter == SPACE;
        let most = if is_guessed { 1 } else { PREAMBLE };
        let rows = reader(text, *delimiter).into_byte_records().take(most);
        let is_clear = |row: &ByteRecord| places("", row, columns, *delimiter).is_ok();
        rows.map_while(Result::ok).position(|row| is_clear(&row))
    };
    let found = all.iter().filter_map(|it| above(it).map(|above| (*it, above)));
    found.min_by_key(|(_, above)| *above).unwrap_or((all[0], 0))
}

/// Titles of a column of times, in small letters.
pub(crate) const TIMES: [&str; 7] =
    ["time", "timestamp", "datetime", "date_time", "utc", "time_utc", "t"];

/// Times that a column has, as far as they can be compared: numbers, or words that begin with a year.
#[derive(Debug, Default)]
struct Times {
    column: Option<usize>,
    last: String,
}

impl Times {
    /// Those below the titles of a row.
    fn below(titles: &ByteRecord, delimiter: u8) -> Self {
        let is_time = |title: &[u8]| {
            TIMES.iter().any(|it| it.as_bytes().eq_ignore_ascii_case(title.trim_ascii()))
        };
        Self { column: fields(titles, delimiter).position(is_time), last: String::new() }
    }

    /// Whether a row has an earlier time than the one before.
    fn is_backwards(&mut self, row: &ByteRecord, delimiter: u8) -> bool {
        let Some(column) = self.column else { return false };
        let now = field(row, delimiter, column).trim().to_owned();
        let numbers = [&self.last, &now].map(|it| it.parse::<f64>().ok());
        let begins_with_a_year =
            |it: &str| it.len() > 8 && it.bytes().take(4).all(|it| it.is_ascii_digit());
        let is_earlier = match numbers {
            [Some(last), Some(now)] => now < last,
            _ => now.len() == self.last.len() && begins_with_a_year(&now) && now < self.last,
        };
        self.last = now;
        is_earlier
    }
}

/// The rows of a table.
///
/// # Errors
/// Names the file and the line, what was found and what was expected.
pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Rows> {
    if text.trim_ascii().is_empty() {
        bail!("{name}: found an empty file, expected samples");
    }
    let columns = layout.columns.clone().unwrap_or_default();
    let (delimiter, above) = heading(text, &columns, layout.delimiter);
    Reading::of(name, layout, Some(delimiter), |reading| {
        pass(reading, text, &columns, (delimiter, above))
    })
}

fn pass(
    reading: &mut Reading,
    text: &[u8],
    columns: &Columns,
    (delimiter, above): (u8, usize),
) -> Result<()> {
    let name = reading.name;
    let mut reader = reader(text, delimiter);
    let mut lines = Lines { text, at: 0, line: 1 };
    let mut row = ByteRecord::new();
    let mut next = |row: &mut ByteRecord| -> Result<Option<usize>> {
        let there = reader.read_byte_record(row).map_err(|error| anyhow!("{name}: {error}"))?;
        Ok(there.then(|| lines.row(row)))
    };
    let mut line = next(&mut row)?;
    for _ in 0..above {
        line = next(&mut row)?;
    }
    let first = format!("{name}:{}", line.unwrap_or(1));
    let places = places(&first, &row, columns, delimiter)?;
    reading.rows.is_geographic = places.is_geographic();
    let (mut times, mut titles) = (Times::default(), None);
    if places.has_header {
        titles = Some(row.clone());
        times = Times::below(&row, delimiter);
        let title = |column: usize| field(&row, delimiter, column).trim().to_owned();
        reading.rows.titles = Some(places.position().map(title));
        line = next(&mut row)?;
        let is_unit = |row: &ByteRecord, column: usize| {
            let field = field(row, delimiter, column);
            !is_missing(field.trim()) && !field.contains(|it: char| it.is_ascii_digit())
        };
        let mut units = 0;
        while let Some(number) = line
            && units < UNITS
            && places.position().into_iter().all(|column| is_unit(&row, column))
        {
            reading.rows.heading(number, "a row of units");
            units += 1;
            line = next(&mut row)?;
        }
    }
    while let Some(number) = line {
        // Of files that were written one after the other.
        if titles.as_ref() == Some(&row) {
            reading.rows.heading(number, "the titles again");
            line = next(&mut row)?;
            continue;
        }
        if times.is_backwards(&row, delimiter) {
            let (count, first) = reading.rows.backwards.unwrap_or((0, number));
            reading.rows.backwards = Some((count + 1, first));
        }
        reading.row(number, |reading| {
            if let Some(titles) = &titles {
                let all = fields(titles, delimiter).map(String::from_utf8_lossy);
                let beside = all.enumerate().filter(|it| !places.position().contains(&it.0));
                reading.keep(beside.map(|(column, title)| {
                    let text = field(&row, delimiter, column);
                    (title.trim().to_owned(), text.trim().to_owned())
                }));
            }
            read(reading, &row, places, delimiter, number)
        })?;
        line = next(&mut row)?;
    }
    Ok(())
}

fn read(
    reading: &mut Reading,
    row: &ByteRecord,
    places: Places,
    delimiter: u8,
    line: usize,
) -> Result<Row> {
    let fields = places.columns.map(|column| field(row, delimiter, column));
    let texts = fields.each_ref().map(|field| field.trim());
    let names = places.names;
    if let Some((name, text)) = names.iter().zip(texts).find(|(_, text)| is_missing(text)) {
        return Ok(Row::Gap(format!("{name}: found {text:?}")));
    }
    let [a, b] = [0, 1].map(|k| reading.coordinate(names[k], texts[k], line));
    reading.samples(vec![[a?, b?]], texts[2], line)
}

const COMMENT: u8 = b'#';

/// Counts the lines of a text as far as it has been read.
struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
}

impl Lines<'_> {
    /// The line on which a row begins. The reader counts a row from the end of the row before. Blank lines and comments
    /// between the two are skipped here.
    fn row(&mut self, row: &ByteRecord) -> usize {
        let mut rest = &self.text[row.position().map_or(0, |it| it.byte() as usize)..];
        loop {
            let end = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
            rest = match rest.first() {
                Some(b'\r' | b'\n') => &rest[1..],
                Some(&COMMENT) => &rest[end..],
                _ => break,
            };
        }
        let begins = self.text.len() - rest.len();
        let passed = &self.text[self.at..begins];
        let count = |end: u8| passed.iter().filter(|byte| **byte == end).count();
        let both = passed.windows(2).filter(|pair| pair == b"\r\n").count();
        self.line += count(b'\r') + count(b'\n') - both;
        self.at = begins;
        self.line
    }
}
