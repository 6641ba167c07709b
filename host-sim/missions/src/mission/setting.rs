//! A key of a scenario that the command line gives, as `noise.p=0.9`, or a request, in place of what the file says.

use std::borrow::Cow;
use std::str::FromStr;

use anyhow::{Result, anyhow};
use toml::{Table, Value};

/// A key of a scenario with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Who gives it: `--set`, or a request.
    by: &'static str,
    /// The tables that the key is in, the outermost first, and its own name.
    path: Vec<String>,
    value: Value,
}

impl FromStr for Setting {
    type Err = String;

    /// A value is TOML. A word may stand without quotation marks.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected KEY=VALUE, as noise.p=0.9";
        let (key, value) = text.split_once('=').ok_or(expected)?;
        let path: Vec<_> = key.split('.').map(|it| it.trim().to_owned()).collect();
        let is_name =
            |it: &String| !it.is_empty() && it.chars().all(|c| c.is_alphanumeric() || c == '_');
        if !path.iter().all(is_name) {
            return Err(format!("found the key {key}, {expected}"));
        }
        let told = value.trim();
        let is_word = told.starts_with(|it: char| it.is_alphabetic())
            && told.chars().all(|it| it.is_alphanumeric() || "-_.".contains(it));
        let parsed = toml::from_str::<Table>(&format!("value = {told}"));
        let parsed = parsed.ok().and_then(|mut it| it.remove("value"));
        let value = parsed.or_else(|| is_word.then(|| told.into()));
        let value = value.ok_or_else(|| format!("found the value {told}, {expected}"))?;
        Ok(Self { by: "--set ", path, value })
    }
}

impl Setting {
    /// A key of the scenario's outermost table, by who gives it.
    pub(crate) fn new(by: &'static str, key: String, value: Value) -> Self {
        Self { by, path: vec![key], value }
    }

    /// Who gives it, as messages begin.
    pub(crate) const fn by(&self) -> &'static str {
        self.by
    }

    /// Whether it gives a key, `oracle[0].label`, or a part of it, or what the key is in.
    pub(crate) fn gives(&self, key: &str) -> bool {
        let own = self.path.join(".");
        let is_in = |inner: &str, outer: &str| {
            inner.strip_prefix(outer).is_some_and(|it| it.is_empty() || it.starts_with(['.', '[']))
        };
        is_in(key, &own) || is_in(&own, key)
    }

    fn put(&self, into: &mut Table) -> Result<()> {
        let [tables @ .., name] = &self.path[..] else { return Ok(()) };
        let mut table = into;
        for outer in tables {
            let inner = table.entry(outer).or_insert_with(|| Table::new().into());
            table = inner.as_table_mut().ok_or_else(|| {
                let (by, key) = (self.by, self.path.join("."));
                anyhow!("{by}{key}: found a value as {outer}, expected a table")
            })?;
        }
        table.insert(name.clone(), self.value.clone());
        Ok(())
    }
}

/// The text of a scenario with these in place of its own values.
///
/// # Errors
/// Says which key cannot be set.
pub(crate) fn put<'a>(settings: &[Setting], text: &'a str) -> Result<Cow<'a, str>> {
    if settings.is_empty() {
        return Ok(text.into());
    }
    let mut table = toml::from_str(text)?;
    settings.iter().try_for_each(|it| it.put(&mut table))?;
    Ok(toml::to_string(&table)?.into())
}

#[cfg(test)]
mod tests {
    use super::{Setting, put};

    #[test]
    fn a_setting_takes_the_place_of_a_value_and_of_that_alone() {
        let all = ["steps=7", "noise.p = 0.9", "vehicle={ kind = \"car\" }", "algorithm=lookahead"];
        let all = all.map(|it| it.parse::<Setting>().expect("a setting"));
        let put = put(&all, "steps = 3\nseed = 5\nnoise = { p = 0.7, band = 1 }\n");
        let table: toml::Table = toml::from_str(&put.expect("a table")).expect("TOML");
        let told = "algorithm = \"lookahead\"\nsteps = 7\nseed = 5\nnoise = { p = 0.9, band = 1 }\n\
                    vehicle = { kind = \"car\" }";
        assert_eq!(table, toml::from_str(told).expect("TOML"));
    }

    #[test]
    fn what_is_no_setting_is_refused() {
        for text in ["steps", "=3", "a..b=3", "noise.p=", "noise.p=0,9", "oracle[0].label=1"] {
            assert!(text.parse::<Setting>().is_err(), "{text}");
        }
    }
}
