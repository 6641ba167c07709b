//! The columns of a file that contain positions and labels: found by usual titles, or named by the user.

use std::str::FromStr;

use anyhow::{Result, anyhow, bail};

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    X,
    Z,
    Latitude,
    Longitude,
    Label,
}

impl Role {
    const ALL: [Self; 5] = [Self::X, Self::Z, Self::Latitude, Self::Longitude, Self::Label];

    /// What it is called in `--columns` and in errors.
    const fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Z => "z",
            Self::Latitude => "lat",
            Self::Longitude => "lon",
            Self::Label => "label",
        }
    }

    /// Whether a title says this by itself, with a unit behind it or without.
    fn is_usual(self, title: &str) -> bool {
        let title = match title.split_once(['(', '[']) {
            Some((title, unit)) if unit.ends_with([')', ']']) => title.trim_end(),
            _ => title,
        };
        let is_one_of = |names: &[&str]| names.iter().any(|name| title.eq_ignore_ascii_case(name));
        match self {
            Self::Latitude => is_one_of(&["lat", "latitude"]),
            Self::Longitude => is_one_of(&["lon", "lng", "long", "longitude"]),
            Self::X | Self::Z | Self::Label => title == self.name(),
        }
    }
}

/// The columns that were named, `x=easting,z=northing,label=wet`, by title or by number from 1.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    named: Vec<(Role, String)>,
}

impl FromStr for Columns {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        const EXPECTED: &str = "expected x=TITLE,z=TITLE,label=TITLE or lat=TITLE,lon=TITLE,label=TITLE, \
                                 a title or a number from 1 each";
        let mut named: Vec<(Role, String)> = Vec::new();
        for part in text.split(',') {
            let Some((role, title)) = part.split_once('=') else {
                bail!("found {part:?}, {EXPECTED}");
            };
            let (role, title) = (role.trim(), title.trim());
            let Some(role) = Role::ALL.into_iter().find(|known| known.name() == role) else {
                bail!("found the name {role:?}, {EXPECTED}");
            };
            if title.is_empty() {
                bail!("found no title for {}, {EXPECTED}", role.name());
            }
            if named.iter().any(|(other, _)| *other == role) {
                bail!("found {} twice, {EXPECTED}", role.name());
            }
            named.push((role, title.to_owned()));
        }
        let has = |roles: [Role; 2]| named.iter().any(|(role, _)| roles.contains(role));
        if has([Role::X, Role::Z]) && has([Role::Latitude, Role::Longitude]) {
            bail!("found both kinds of positions, {EXPECTED}");
        }
        Ok(Self { named })
    }
}

/// Where a file has positions and labels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    /// Of `x` and `z`, or of latitude and longitude.
    pub(crate) position: [usize; 2],
    pub(crate) label: usize,
    /// Whether positions are latitudes and longitudes, degrees.
    pub(crate) is_geographic: bool,
    /// Whether the first row has titles.
    pub(crate) has_header: bool,
}

impl Places {
    /// What positions are called.
    pub(crate) fn names(self) -> [&'static str; 2] {
        roles(self.is_geographic).map(Role::name)
    }
}

const fn roles(is_geographic: bool) -> [Role; 2] {
    if is_geographic { [Role::Latitude, Role::Longitude] } else { [Role::X, Role::Z] }
}

impl Columns {
    /// The name of the label's column, if it is given.
    pub(crate) fn label(&self) -> Option<&str> {
        self.title(Role::Label)
    }

    /// Whether columns of positions are named.
    pub(crate) fn name_positions(&self) -> bool {
        self.named.iter().any(|(role, _)| *role != Role::Label)
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
        let is_geographic = self.is_geographic(&titles);
        let [first, second] = roles(is_geographic);
        let wanted = [first, second, Role::Label];
        let expected = wanted.map(Role::name).join(",");
        let mut places = [0; 3];
        let mut all_by_number = true;
        for (role, place) in wanted.into_iter().zip(&mut places) {
            let (found, by_number) = self.place(at, role, &titles, &expected)?;
            if !by_number && titles[found + 1..].contains(&titles[found]) {
                let title = titles[found];
                bail!("{at}: found the column {title} twice, expected each of {expected} once");
            }
            *place = found;
            all_by_number &= by_number;
        }
        let [a, b, label] = places;
        if a == b || a == label || b == label {
            bail!(
                "--columns: found one column for two of {expected} at {at}, expected a column for each"
            );
        }
        // Without a header, what stands in the columns is not a title.
        let has_header = !(all_by_number && [a, b].iter().any(|place| is_value(titles[*place])));
        if !has_header && let Some(bad) = [a, b].into_iter().find(|place| !is_value(titles[*place]))
        {
            bail!("{at}: found {:?}, expected a finite number in column {}", titles[bad], bad + 1);
        }
        Ok(Places { position: [a, b], label, is_geographic, has_header })
    }

    fn is_geographic(&self, titles: &[&str]) -> bool {
        let has = |role: Role| titles.iter().any(|title| role.is_usual(title));
        let kinds = self.named.iter().filter(|(role, _)| *role != Role::Label);
        match kinds.map(|(role, _)| matches!(role, Role::Latitude | Role::Longitude)).next() {
            Some(named) => named,
            None => !(has(Role::X) && has(Role::Z)) && has(Role::Latitude) && has(Role::Longitude),
        }
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
            let place = titles.iter().position(|title| role.is_usual(title));
            let place = place.ok_or_else(|| {
                let found = match titles {
                    [one] if !one.is_empty() => format!("the one column {one:?}"),
                    _ => format!("the header {:?}", header()),
                };
                // Positions may as well be of the other kind, unless one of this kind is named.
                let either = if self.name_positions() || role == Role::Label {
                    expected.to_owned()
                } else {
                    format!("{expected}, or lat,lon,label")
                };
                anyhow!(
                    "{at}: found {found}, expected {either}; other columns are named by {}",
                    self.example(role)
                )
            })?;
            if let Some(again) = titles[place + 1..].iter().find(|title| role.is_usual(title)) {
                bail!("{at}: found the column {again} twice, expected each of {expected} once");
            }
            return Ok((place, false));
        };
        if let Some(place) = titles.iter().position(|other| *other == title) {
            // A number may be what stands there, in a file without titles.
            if title.parse::<f64>().is_err() {
                return Ok((place, false));
            }
        }
        let number = title.parse::<usize>().ok().filter(|n| (1..=titles.len()).contains(n));
        let place = number.ok_or_else(|| {
            let (count, role) = (titles.len(), role.name());
            anyhow!(
                "--columns {role}={title}: found the columns {:?} at {at}, expected {title:?} among them for {role}, or a number up to {count}",
                header()
            )
        })?;
        Ok((place - 1, true))
    }

    /// How one names the columns of a file that has other titles.
    fn example(&self, role: Role) -> String {
        let named = self.named.iter().map(|(role, title)| format!("{}={title}", role.name()));
        let named: Vec<_> = named.collect();
        match role {
            Role::Label => "--columns label=TITLE".to_owned(),
            _ if named.is_empty() => {
                "--columns lat=TITLE,lon=TITLE,label=TITLE, or x=...,z=...,label=...".to_owned()
            }
            _ if self.name_positions() => {
                format!("--columns {},{}=TITLE", named.join(","), role.name())
            }
            _ => {
                let named = named.join(",");
                format!("--columns lat=TITLE,lon=TITLE,{named} or x=TITLE,z=TITLE,{named}")
            }
        }
    }
}
