//! Numbers as recorders write them: with a decimal point or a decimal comma, and with separators between thousands.
//!
//! 1,234.5 and 1 234,5 are clear by themselves. 1,234 and 1.234 are not: the separator is decimal in some files, and is
//! between thousands in others. They are read as decimal, unless the file has a number that settles it. If the file has
//! a number that speaks for the other reading without settling it, the file is refused.

use anyhow::{Result, anyhow};

/// The separators of decimals: whatever is known of each has its index.
const SEPARATORS: [char; 2] = ['.', ','];

/// Characters between thousands, apart from point and comma: spaces of all widths and apostrophes.
const GROUPING: [char; 6] = [' ', '\u{a0}', '\u{2009}', '\u{202f}', '\'', '\u{2019}'];

/// A number as it stands on a line.
type Seen = Option<(usize, String)>;

/// Reads the numbers of a file, and remembers what they say of its separators.
#[derive(Debug, Default)]
pub(crate) struct Numbers {
    /// Whether commas end fields: then a comma alone is not decimal.
    commas_delimit: bool,
    /// The decimal separator of the whole file, where an earlier pass has settled it.
    settled: Option<usize>,
    /// The first number that its thousands make clear only with this separator before decimals.
    settles: [Seen; 2],
    /// The first number that has it before decimals, and no thousands.
    speaks: [Seen; 2],
    /// The first number that may have it between thousands.
    unclear: [Seen; 2],
}

impl Numbers {
    /// Reads the numbers of a file with this delimiter, if it has one.
    pub(crate) fn of(delimiter: Option<u8>, settled: Option<usize>) -> Self {
        Self { commas_delimit: delimiter == Some(b','), settled, ..Self::default() }
    }

    /// The finite number in a field on some line.
    pub(crate) fn read(&mut self, field: &str, line: usize) -> Option<f64> {
        let group = field.chars().find(|it| GROUPING.contains(it));
        let value = match (group, SEPARATORS.map(|it| field.contains(it))) {
            // Between thousands stands one character, and decimals follow all of them.
            (Some(group), _) => {
                let (whole, decimals) = field.split_once(SEPARATORS).unwrap_or((field, "0"));
                number(&ungrouped(whole, group)?, decimals)
            }
            (None, [true, true]) => {
                let last = field.rfind(SEPARATORS)?;
                let decimal = usize::from(field[last..].starts_with(','));
                let whole = ungrouped(&field[..last], SEPARATORS[1 - decimal])?;
                let value = number(&whole, &field[last + 1..])?;
                self.settles(decimal, field, line).then_some(value)
            }
            (None, [false, false]) => field.parse().ok(),
            (None, [has_point, _]) => self.one_separator(field, usize::from(!has_point), line),
        };
        value.filter(|value| value.is_finite())
    }

    /// A number that has points, or commas, and nothing else between digits.
    fn one_separator(&mut self, field: &str, own: usize, line: usize) -> Option<f64> {
        let separator = SEPARATORS[own];
        let thousands = ungrouped(field, separator).and_then(|whole| number(&whole, "0"));
        if field.matches(separator).count() > 1 {
            // Several: they stand between thousands, so the other one is decimal.
            let value = thousands?;
            return self.settles(1 - own, field, line).then_some(value);
        }
        match self.settled {
            Some(decimal) if decimal != own => return thousands,
            Some(_) => {}
            None if thousands.is_some() => note(&mut self.unclear[own], field, line),
            None if own == 1 && self.commas_delimit => return None,
            None => note(&mut self.speaks[own], field, line),
        }
        field.replacen(separator, ".", 1).parse().ok()
    }

    /// Notes a number that is clear only with this decimal separator. Returns whether the file may have it.
    fn settles(&mut self, decimal: usize, field: &str, line: usize) -> bool {
        note(&mut self.settles[decimal], field, line);
        self.settled.is_none_or(|settled| settled == decimal)
    }

    /// Ends the reading. Returns the decimal separator if the file is to be read once more with it.
    ///
    /// # Errors
    /// The line of a number that may be two, or that does not go with another.
    pub(crate) fn end(&self) -> Result<Option<usize>, (usize, anyhow::Error)> {
        if self.settled.is_some() {
            return Ok(None);
        }
        for (own, other) in [(0, 1), (1, 0)] {
            let Some(clear) = &self.settles[own] else { continue };
            let Some(odd) = self.settles[other].as_ref().or(self.speaks[other].as_ref()) else {
                return Ok(self.unclear[other].is_some().then_some(own));
            };
            let [(line, clear), (late, field)] =
                if odd.0 > clear.0 { [clear, odd] } else { [odd, clear] };
            let both = anyhow!(
                "found the number {field:?} after {clear:?} on line {line}, expected one decimal separator in the file"
            );
            return Err((*late, both));
        }
        for (own, other) in [(0, 1), (1, 0)] {
            let Some((line, field)) = &self.unclear[own] else { continue };
            let why = match self.speaks[other].as_ref().or(self.unclear[other].as_ref()) {
                Some((line, against)) => {
                    let name = ["point", "comma"][other];
                    format!("{against:?} on line {line} has a decimal {name}")
                }
                None if own == 1 && self.commas_delimit => {
                    "the file has commas between its columns".to_owned()
                }
                None => continue,
            };
            let [thousand, decimal] = ["", "."].map(|it| field.replace(SEPARATORS[own], it));
            let either = anyhow!(
                "found the number {field:?}, which may be {thousand} or {decimal}: {why}; expected numbers without separators between thousands"
            );
            return Err((*line, either));
        }
        Ok(None)
    }
}

fn note(seen: &mut Seen, field: &str, line: usize) {
    seen.get_or_insert_with(|| (line, field.to_owned()));
}

/// The digits of a whole number without the character between its thousands; `None` if its groups are not of three.
fn ungrouped(whole: &str, group: char) -> Option<String> {
    let digits = whole.strip_prefix(['-', '+']).unwrap_or(whole);
    let (first, rest) = digits.split_once(group)?;
    let is_whole = |it: &str| it.bytes().all(|byte| byte.is_ascii_digit());
    let is_first = (1..=3).contains(&first.len()) && is_whole(first) && !first.starts_with('0');
    let is_grouped = is_first && rest.split(group).all(|it| it.len() == 3 && is_whole(it));
    is_grouped.then(|| whole.replace(group, ""))
}

fn number(whole: &str, decimals: &str) -> Option<f64> {
    let is_whole = decimals.bytes().all(|byte| byte.is_ascii_digit());
    is_whole.then(|| format!("{whole}.{decimals}").parse().ok())?
}
