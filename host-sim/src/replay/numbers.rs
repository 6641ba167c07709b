//! Numbers as recorders write them: with a decimal point or a decimal comma, and with separators between thousands.
//!
//! 1,234.5 and 1 234,5 are clear by themselves. 1,234 and 1.234 are not: the separator is decimal in some files, and is
//! between thousands in others. They are read as decimal, unless the file has a number that settles it. If the file has
//! a number that speaks for the other reading without settling it, the file is refused.

use anyhow::{Result, anyhow};

use crate::replay::delimiter::Delimiter;

/// The separator of decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Decimal {
    Point,
    Comma,
}

impl Decimal {
    const fn char(self) -> char {
        match self {
            Self::Point => '.',
            Self::Comma => ',',
        }
    }

    const fn other(self) -> Self {
        match self {
            Self::Point => Self::Comma,
            Self::Comma => Self::Point,
        }
    }
}

/// A number as it stands on a line.
type Seen = Option<(usize, String)>;

/// Reads the numbers of a file, and remembers what they say of its separators.
#[derive(Debug, Default)]
pub(crate) struct Numbers {
    /// Whether commas end fields: then a comma alone is not decimal.
    commas_delimit: bool,
    /// The decimal separator of the whole file, where an earlier pass has settled it.
    settled: Option<Decimal>,
    /// The first number that its thousands make clear only with a decimal point; then the first only with a decimal
    /// comma.
    settles: [Seen; 2],
    /// The first number that has a decimal point, or a decimal comma, and no thousands.
    speaks: [Seen; 2],
    /// The first number that may have the point, or the comma, between thousands.
    unclear: [Seen; 2],
}

/// Characters between thousands, apart from point and comma: spaces of all widths and apostrophes.
const GROUPING: [char; 6] = [' ', '\u{a0}', '\u{2009}', '\u{202f}', '\'', '\u{2019}'];

impl Numbers {
    /// Reads the numbers of a file with this delimiter, if it has one.
    pub(crate) fn of(delimiter: Option<Delimiter>, settled: Option<Decimal>) -> Self {
        let commas_delimit = delimiter == Some(Delimiter::Comma);
        Self { commas_delimit, settled, ..Self::default() }
    }

    /// The finite number in a field on some line.
    pub(crate) fn read(&mut self, field: &str, line: usize) -> Option<f64> {
        let value =
            if field.contains([',', '\'', '\u{2019}']) || field.contains(char::is_whitespace) {
                self.separated(field, line)
            } else {
                self.plain(field, line)
            };
        value.filter(|value| value.is_finite())
    }

    /// A number that has a point at most.
    fn plain(&mut self, field: &str, line: usize) -> Option<f64> {
        if field.contains('.') {
            return self.one_separator(field, Decimal::Point, line);
        }
        field.parse().ok()
    }

    fn separated(&mut self, field: &str, line: usize) -> Option<f64> {
        let has = |separator: Decimal| field.contains(separator.char());
        if field.contains(GROUPING) {
            // Between thousands stands one character, and decimals follow all of them.
            let group = field.chars().find(|it| GROUPING.contains(it))?;
            let (whole, decimals) = match field.split_once([',', '.']) {
                Some((whole, decimals)) => (whole, Some(decimals)),
                None => (field, None),
            };
            return number(&ungrouped(whole, group)?, decimals);
        }
        match (has(Decimal::Point), has(Decimal::Comma)) {
            (false, true) => self.one_separator(field, Decimal::Comma, line),
            (true, true) => {
                let last = field.rfind([',', '.'])?;
                let decimal =
                    if field[last..].starts_with('.') { Decimal::Point } else { Decimal::Comma };
                let whole = ungrouped(&field[..last], decimal.other().char())?;
                let value = number(&whole, Some(&field[last + 1..]))?;
                self.settles(decimal, field, line).then_some(value)
            }
            // Spaces that are no separators.
            _ => None,
        }
    }

    /// A number that has points, or commas, and nothing else between digits.
    fn one_separator(&mut self, field: &str, separator: Decimal, line: usize) -> Option<f64> {
        let (char, here) = (separator.char(), separator as usize);
        let thousands = ungrouped(field, char).and_then(|whole| number(&whole, None));
        if field.matches(char).count() > 1 {
            // Several: they stand between thousands, so the other one is decimal.
            let value = thousands?;
            return self.settles(separator.other(), field, line).then_some(value);
        }
        match self.settled {
            Some(decimal) if decimal != separator => return thousands,
            Some(_) => {}
            None if thousands.is_some() => note(&mut self.unclear[here], field, line),
            None if separator == Decimal::Comma && self.commas_delimit => return None,
            None => note(&mut self.speaks[here], field, line),
        }
        field.replacen(char, ".", 1).parse().ok()
    }

    /// Notes a number that is clear only with this decimal separator. Returns whether the file may have it.
    fn settles(&mut self, decimal: Decimal, field: &str, line: usize) -> bool {
        note(&mut self.settles[decimal as usize], field, line);
        self.settled.is_none_or(|settled| settled == decimal)
    }

    /// Ends the reading. Returns the decimal separator if the file is to be read once more with it.
    ///
    /// # Errors
    /// The line of a number that may be two, or that does not go with another.
    pub(crate) fn end(&self) -> Result<Option<Decimal>, (usize, anyhow::Error)> {
        if self.settled.is_some() {
            return Ok(None);
        }
        for decimal in [Decimal::Point, Decimal::Comma] {
            let (own, other) = (decimal as usize, decimal.other() as usize);
            if let Some((line, clear)) = &self.settles[own] {
                if let Some((odd, field)) =
                    self.settles[other].as_ref().or(self.speaks[other].as_ref())
                {
                    let (late, field, line, clear) = if odd > line {
                        (odd, field, line, clear)
                    } else {
                        (line, clear, odd, field)
                    };
                    let both = anyhow!(
                        "found the number {field:?} after {clear:?} on line {line}, expected one decimal separator in the file"
                    );
                    return Err((*late, both));
                }
                return Ok(self.unclear[other].is_some().then_some(decimal));
            }
        }
        for separator in [Decimal::Point, Decimal::Comma] {
            let (own, other) = (separator as usize, separator.other() as usize);
            let Some((line, field)) = &self.unclear[own] else { continue };
            let against = self.speaks[other].as_ref().or(self.unclear[other].as_ref());
            let why = match against {
                Some((line, against)) => {
                    let name = if separator == Decimal::Comma { "point" } else { "comma" };
                    format!("{against:?} on line {line} has a decimal {name}")
                }
                None if separator == Decimal::Comma && self.commas_delimit => {
                    "the file has commas between its columns".to_owned()
                }
                None => continue,
            };
            let thousand = field.replace(separator.char(), "");
            let decimal = field.replace(separator.char(), ".");
            return Err((
                *line,
                anyhow!(
                    "found the number {field:?}, which may be {thousand} or {decimal}: {why}; expected numbers without separators between thousands"
                ),
            ));
        }
        Ok(None)
    }
}

fn note(seen: &mut Seen, field: &str, line: usize) {
    if seen.is_none() {
        *seen = Some((line, field.to_owned()));
    }
}

/// The digits of a whole number without the character between its thousands; `None` if its groups are not of three.
fn ungrouped(whole: &str, group: char) -> Option<String> {
    let digits = whole.strip_prefix(['-', '+']).unwrap_or(whole);
    let mut groups = digits.split(group);
    let is_of = |part: &str, sizes: std::ops::RangeInclusive<usize>| {
        sizes.contains(&part.len()) && part.bytes().all(|byte| byte.is_ascii_digit())
    };
    let first = groups.next().filter(|first| is_of(first, 1..=3) && !first.starts_with('0'))?;
    let rest: Vec<_> = groups.collect();
    let sign = &whole[..whole.len() - digits.len()];
    let is_grouped = !rest.is_empty() && rest.iter().all(|part| is_of(part, 3..=3));
    is_grouped.then(|| format!("{sign}{first}{}", rest.concat()))
}

fn number(whole: &str, decimals: Option<&str>) -> Option<f64> {
    let decimals = decimals.unwrap_or("0");
    decimals
        .bytes()
        .all(|byte| byte.is_ascii_digit())
        .then(|| format!("{whole}.{decimals}").parse().ok())?
}
