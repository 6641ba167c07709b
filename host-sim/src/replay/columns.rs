//! The columns of a file that contain positions and labels: found by usual titles, or named by the user.

use std::str::FromStr;

use anyhow::{Context as _, Error, Result, anyhow, bail};

/// What a column holds, as `--columns` and errors name it. Positions are of one kind or the other.
type Role = &'static str;
const METRES: [Role; 2] = ["x", "z"];
const DEGREES: [Role; 2] = ["lat", "lon"];
const LABEL: Role = "label";

/// Whether a title says by itself what its column holds, with a unit behind it or without.
fn is_usual(role: Role, title: &str) -> bool {
    let title = match title.split_once(['(', '[']) {
        Some((title, unit)) if unit.ends_with([')', ']']) => title.trim_end(),
        _ => title,
    };
    let is_one_of = |names: &[&str]| names.iter().any(|name| title.eq_ignore_ascii_case(name));
    match role {
        "lat" => is_one_of(&["lat", "latitude"]),
        "lon" => is_one_of(&["lon", "lng", "long", "longitude"]),
        _ => title == role,
    }
}

/// The columns that were named, `x=easting,z=northing,label=wet`, by title or by number from 1.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    named: Vec<(Role, String)>,
}

impl FromStr for Columns {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        const EXPECTED: &str = "expected x=TITLE,z=TITLE,label=TITLE or lat=TITLE,lon=TITLE,label=TITLE, \
                                 a title or a number from 1 each";
        let mut named: Vec<(Role, String)> = Vec::new();
        for part in text.split(',') {
            let parted = part.split_once('=');
            let (name, title) = parted.with_context(|| format!("found {part:?}, {EXPECTED}"))?;
            let (name, title) = (name.trim(), title.trim());
            let role = METRES.into_iter().chain(DEGREES).chain([LABEL]).find(|it| *it == name);
            let role = role.with_context(|| format!("found the name {name:?}, {EXPECTED}"))?;
            if title.is_empty() {
                bail!("found no title for {role}, {EXPECTED}");
            }
            if named.iter().any(|(other, _)| *other == role) {
                bail!("found {role} twice, {EXPECTED}");
            }
            named.push((role, title.to_owned()));
        }
        let has = |roles: [Role; 2]| named.iter().any(|(role, _)| roles.contains(role));
        if has(METRES) && has(DEGREES) {
            bail!("found both kinds of positions, {EXPECTED}");
        }
        Ok(Self { named })
    }
}

/// Where a file has positions and labels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    /// Of `x` and `z`, or of latitude and longitude; then of the label.
    pub(crate) columns: [usize; 3],
    /// What these are called.
    pub(crate) names: [Role; 3],
    /// Whether the first row has titles.
    pub(crate) has_header: bool,
}

impl Places {
    /// The columns of positions.
    pub(crate) fn position(self) -> [usize; 2] {
        [self.columns[0], self.columns[1]]
    }

    /// Whether positions are latitudes and longitudes, degrees.
    pub(crate) fn is_geographic(self) -> bool {
        DEGREES.contains(&self.names[0])
    }
}

impl Columns {
    /// The name of the label's column, if it is given.
    pub(crate) fn label(&self) -> Option<&str> {
        self.title(LABEL)
    }

    /// Whether columns of positions are named.
    pub(crate) fn name_positions(&self) -> bool {
        self.named.iter().any(|(role, _)| *role != LABEL)
    }

    fn title(&self, role: Role) -> Option<&str> {
        self.named.iter().find(|(named, _)| *named == role).map(|(_, title)| title.as_str())
    }

    /// The columns by the first row of a file. `at` is the place of that row, for errors. `is_value` says whether a
    /// field is a value, and so no title.
    ///
    /// # Errors
    /// Names the place, or the flag, what was found and what was expected.
    pub(crate) fn places(
        &self,
        at: &str,
        first: &[&str],
        is_value: impl Fn(&str) -> bool,
    ) -> Result<Places> {
        let titles: Vec<_> = first.iter().map(|it| it.trim()).collect();
        let [one, other] = self.kind(&titles);
        let names = [one, other, LABEL];
        let expected = names.join(",");
        let mut columns = [0; 3];
        let mut all_by_number = true;
        for (role, column) in names.into_iter().zip(&mut columns) {
            let (found, by_number) = self.place(at, role, &titles, &expected)?;
            if !by_number && titles[found + 1..].contains(&titles[found]) {
                let title = titles[found];
                bail!("{at}: found the column {title} twice, expected each of {expected} once");
            }
            *column = found;
            all_by_number &= by_number;
        }
        let [a, b, label] = columns;
        if a == b || a == label || b == label {
            bail!(
                "--columns: found one column for two of {expected} at {at}, expected a column for each"
            );
        }
        // Without a header, what stands in the columns is not a title.
        let no_value = [a, b].into_iter().find(|place| !is_value(titles[*place]));
        let has_header = !all_by_number || [a, b].iter().all(|place| !is_value(titles[*place]));
        if let (false, Some(bad)) = (has_header, no_value) {
            bail!("{at}: found {:?}, expected a finite number in column {}", titles[bad], bad + 1);
        }
        Ok(Places { columns, names, has_header })
    }

    /// The kind of positions: the one that is named, or else the one that the titles have.
    fn kind(&self, titles: &[&str]) -> [Role; 2] {
        let has = |role: Role| titles.iter().any(|title| is_usual(role, title));
        let named = self.named.iter().find(|(role, _)| *role != LABEL);
        let is_geographic = match named {
            Some((role, _)) => DEGREES.contains(role),
            None => !METRES.into_iter().all(has) && DEGREES.into_iter().all(has),
        };
        if is_geographic { DEGREES } else { METRES }
    }

    /// The column of a role, and whether it is known by its number alone.
    fn place(
        &self,
        at: &str,
        role: Role,
        titles: &[&str],
        expected: &str,
    ) -> Result<(usize, bool)> {
        let header = || titles.join(",");
        let Some(title) = self.title(role) else {
            let mut usual = (0..titles.len()).filter(|it| is_usual(role, titles[*it]));
            let Some(place) = usual.next() else {
                return Err(self.missing(at, role, titles, expected));
            };
            if let Some(again) = usual.next() {
                let again = titles[again];
                bail!("{at}: found the column {again} twice, expected each of {expected} once");
            }
            return Ok((place, false));
        };
        // A number may be what stands there, in a file without titles.
        let place = titles.iter().position(|other| *other == title);
        if let (Some(place), Err(_)) = (place, title.parse::<f64>()) {
            return Ok((place, false));
        }
        let number = title.parse::<usize>().ok().filter(|n| (1..=titles.len()).contains(n));
        let number = number.with_context(|| {
            let count = titles.len();
            format!(
                "--columns {role}={title}: found the columns {:?} at {at}, expected {title:?} among them for {role}, or a number up to {count}",
                header()
            )
        })?;
        Ok((number - 1, true))
    }

    /// No column has the title of a role; and how one names the columns of such a file.
    fn missing(&self, at: &str, role: Role, titles: &[&str], expected: &str) -> Error {
        let found = match titles {
            [one] if !one.is_empty() => format!("the one column {one:?}"),
            _ => format!("the header {:?}", titles.join(",")),
        };
        let named = self.named.iter().map(|(role, title)| format!("{role}={title}"));
        let named = named.collect::<Vec<_>>().join(",");
        // Positions may as well be of the other kind, unless one of this kind is named.
        let is_open = role != LABEL && !self.name_positions();
        let either = if is_open { ", or lat,lon,label" } else { "" };
        let example = match role {
            LABEL => "label=TITLE".to_owned(),
            _ if named.is_empty() => {
                "lat=TITLE,lon=TITLE,label=TITLE, or x=...,z=...,label=...".to_owned()
            }
            _ if is_open => format!("lat=TITLE,lon=TITLE,{named} or x=TITLE,z=TITLE,{named}"),
            _ => format!("{named},{role}=TITLE"),
        };
        anyhow!(
            "{at}: found {found}, expected {expected}{either}; other columns are named by --columns {example}"
        )
    }
}
