//! Recorded samples: a CSV file with the columns `x`, `z` and `label`, others beside them.

use std::fs;
use std::path::Path;

use anyhow::{Result, anyhow, bail};
use csv::ByteRecord;
use nalgebra::Point2;
use planner_core::belief::sample::{Label, Sample};
use planner_core::geometry::lattice::Site;

/// Samples in the order in which they were recorded.
pub(crate) struct SampleFile {
    /// What the file is called.
    pub(crate) name: String,
    /// The samples.
    pub(crate) samples: Vec<Sample>,
    /// The line of the file on which each begins.
    lines: Vec<usize>,
}

impl SampleFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the file and the line, what was found and what was expected.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let text = fs::read(path)
            .map_err(|error| anyhow!("{name}: expected a readable CSV file: {error}"))?;
        Self::parse(&name, &text)
    }

    /// As [`read`](Self::read), from the text of the file called `name`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub(crate) fn parse(name: &str, text: &[u8]) -> Result<Self> {
        let mut rows = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(COMMENT))
            .from_reader(text);
        let mut lines = Lines::of(text);
        let mut row = ByteRecord::new();
        let mut next = |row: &mut ByteRecord| -> Result<Option<usize>> {
            let there = rows.read_byte_record(row).map_err(|error| anyhow!("{name}: {error}"))?;
            Ok(there.then(|| lines.row(row)))
        };
        let line = next(&mut row)?.unwrap_or(1);
        let columns = columns(&row).map_err(|error| anyhow!("{name}:{line}: {error}"))?;
        let mut all = Self { name: name.to_owned(), samples: Vec::new(), lines: Vec::new() };
        while let Some(line) = next(&mut row)? {
            let sample =
                sample(&row, columns).map_err(|error| anyhow!("{name}:{line}: {error}"))?;
            all.samples.push(sample);
            all.lines.push(line);
        }
        Ok(all)
    }

    /// The file and the line of a sample.
    pub(crate) fn place(&self, index: usize) -> String {
        format!("{}:{}", self.name, self.lines[index])
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

/// Where a header has `x`, `z` and `label`.
fn columns(header: &ByteRecord) -> Result<[usize; 3]> {
    const WANTED: [&str; 3] = ["x", "z", "label"];
    let titles: Vec<_> = header.iter().map(String::from_utf8_lossy).collect();
    let titles: Vec<_> = titles.iter().map(|it| it.trim_start_matches('\u{feff}').trim()).collect();
    let places = WANTED.map(|wanted| titles.iter().position(|title| *title == wanted));
    let [Some(x), Some(z), Some(label)] = places else {
        bail!("found the header {:?}, expected x,z,label", titles.join(","));
    };
    for (wanted, place) in WANTED.into_iter().zip([x, z, label]) {
        if titles[place + 1..].contains(&wanted) {
            bail!("found the column {wanted} twice, expected each of x,z,label once");
        }
    }
    Ok([x, z, label])
}

fn sample(row: &ByteRecord, [x, z, label]: [usize; 3]) -> Result<Sample> {
    let number = |name: &str, column: usize| {
        let field = String::from_utf8_lossy(row.get(column).unwrap_or_default());
        let value = field.trim().parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| anyhow!("{name}: found {field:?}, expected a finite number"))
    };
    let (x, z) = (number("x", x)?, number("z", z)?);
    let site = Site::try_from(Point2::new(x, z)).map_err(|error| anyhow!("({x}, {z}): {error}"))?;
    let label = match number("label", label)? {
        1.0 => Label::Positive,
        -1.0 => Label::Negative,
        other => bail!("label: found {other}, expected -1 or 1"),
    };
    Ok(Sample { site, label })
}
