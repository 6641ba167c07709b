//! The samples of a table: a file of rows with columns, delimiters and numbers of many kinds.

use std::borrow::Cow;

use anyhow::{Context as _, Result, anyhow, bail};
use csv::ByteRecord;

use crate::replay::columns::{Columns, Places};
use crate::replay::degrees::degrees;
use crate::replay::numbers::Numbers;
use crate::replay::reading::{Reading, is_missing};
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

/// Whether a time is earlier than the one before, as far as they can be compared: numbers, or words that begin with a year.
fn is_earlier(now: &str, last: &str) -> bool {
    let begins_with_a_year = now.len() > 8 && now.bytes().take(4).all(|it| it.is_ascii_digit());
    match [last, now].map(|it| it.parse::<f64>().ok()) {
        [Some(last), Some(now)] => now < last,
        _ => now.len() == last.len() && begins_with_a_year && now < last,
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
    let (mut reader, mut lines) = (reader(text, delimiter), Lines { text, at: 0, line: 1 });
    let rows = reader.byte_records().map(|row| {
        let row = row.map_err(|error| anyhow!("{name}: {error}"))?;
        anyhow::Ok((lines.row(&row), row))
    });
    let mut rows = rows.skip(above).peekable();
    let (line, first) = rows.next().transpose()?.unwrap_or((1, ByteRecord::new()));
    let places = places(&format!("{name}:{line}"), &first, columns, delimiter)?;
    reading.rows.is_geographic = places.is_geographic();
    let text_in = |row: &ByteRecord, column| field(row, delimiter, column).trim().to_owned();
    let (titles, data) =
        if places.has_header { (Some(first), None) } else { (None, Some(Ok((line, first)))) };
    let mut titled = Vec::new();
    if let Some(titles) = &titles {
        reading.rows.titles = Some(places.position().map(|column| text_in(titles, column)));
        titled = (0..fields(titles, delimiter).count()).map(|it| text_in(titles, it)).collect();
        let is_unit =
            |field: String| !is_missing(&field) && !field.contains(|it: char| it.is_ascii_digit());
        let is_of_units = |row: &Result<(usize, ByteRecord)>| {
            let is = |row| places.position().into_iter().all(|it| is_unit(text_in(row, it)));
            row.as_ref().is_ok_and(|(_, row)| is(row))
        };
        for _ in 0..UNITS {
            let Some(Ok((line, _))) = rows.next_if(is_of_units) else { break };
            reading.rows.heading(line, "a row of units");
        }
    }
    let is_time = |title: &String| TIMES.iter().any(|it| it.eq_ignore_ascii_case(title));
    let (time, mut last) = (titled.iter().position(is_time), String::new());
    for row in data.into_iter().chain(rows) {
        let (line, row) = row?;
        // Of files that were written one after the other.
        if titles.as_ref() == Some(&row) {
            reading.rows.heading(line, "the titles again");
            continue;
        }
        if let Some(time) = time {
            let now = text_in(&row, time);
            if is_earlier(&now, &last) {
                let (count, first) = reading.rows.backwards.unwrap_or((0, line));
                reading.rows.backwards = Some((count + 1, first));
            }
            last = now;
        }
        reading.row(line, |reading| {
            let beside = titled.iter().enumerate().filter(|it| !places.position().contains(&it.0));
            reading.keep(beside.map(|(column, title)| (title.clone(), text_in(&row, column))));
            let fields = places.columns.map(|column| field(&row, delimiter, column));
            reading.sample(places.names, fields.each_ref().map(|it| it.trim()), line)
        })?;
    }
    Ok(())
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
        for (k, byte) in passed.iter().enumerate() {
            let is_end = *byte == b'\n' || *byte == b'\r' && passed.get(k + 1) != Some(&b'\n');
            self.line += usize::from(is_end);
        }
        self.at = begins;
        self.line
    }
}
