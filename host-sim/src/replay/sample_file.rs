//! Recorded samples: a table, `GeoJSON`, GPX, or a trace of our own.

use std::fs;
use std::path::Path;

use anyhow::{Result, anyhow, bail};
use planner_core::Sample;
use serde_json::Value;

use crate::output::{kind, plain};
use crate::replay::columns::Columns;
use crate::replay::rows::{Layout, Recorded, Rows, Skipped, Told, Unit};
use crate::replay::{encoding, geojson_file, gpx_file, table_file, trace_file};
use crate::world::frame::{Frame, check_degrees};

/// Samples in the order in which they were recorded.
pub(crate) struct SampleFile {
    /// What the file is called.
    pub(crate) name: String,
    /// The samples.
    pub(crate) samples: Vec<Sample>,
    /// How the file's positions became sites.
    pub(crate) frame: Frame,
    /// What its rows are called.
    pub(crate) unit: Unit,
    /// What else is known of its rows.
    pub(crate) rows: Rows,
}

/// Why a file is no table. A scenario may have been meant for another command.
fn no_table(name: &str, text: &[u8], why: anyhow::Error) -> anyhow::Error {
    let is_scenario =
        str::from_utf8(text).is_ok_and(|it| toml::from_str::<toml::Table>(it).is_ok());
    if is_scenario && kind::of(text) == kind::TOML {
        let found = kind::TOML;
        return anyhow!("{name}: found {found}, expected samples; `host-sim run` takes a scenario");
    }
    why
}

impl SampleFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the file and the line, what was found and what was expected.
    pub(crate) fn read(path: &Path, layout: &Layout) -> Result<Self> {
        let name = plain::name(&path.display().to_string());
        let text = fs::read(path)
            .map_err(|error| anyhow!("{name}: found {}, expected samples", kind::unread(&error)))?;
        Self::parse(&name, &text, layout)
    }

    /// As [`read`](Self::read), from the text of the file called `name`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Self> {
        let text = &*encoding::utf8(text).map_err(|error| anyhow!("{name}: {error}"))?;
        let rows = match text.trim_ascii_start().first() {
            Some(b'{') if geojson_file::is_one(text) => geojson_file::parse(name, text, layout),
            Some(b'{') => trace_file::parse(name, text, layout),
            Some(b'<') => gpx_file::parse(name, text, layout),
            _ => table_file::parse(name, text, layout).map_err(|why| no_table(name, text, why)),
        }?;
        Self::of(name, rows, layout)
    }

    fn of(name: &str, rows: Rows, layout: &Layout) -> Result<Self> {
        let unit = rows.unit;
        let at = |index: usize| unit.place(name, rows.samples[index].line);
        if let (true, Skipped { count, first: Some(line), lacks }) =
            (rows.samples.is_empty(), &rows.skipped)
        {
            let row = unit.row();
            bail!(
                "{name}: all {count} {row}s lack a position or a label, expected samples; on {} {line}: {lacks}",
                unit.name()
            );
        }
        if rows.samples.is_empty() {
            bail!("{name}: found no {}s with a sample, expected some of both labels", unit.row());
        }
        if rows.is_geographic {
            if let Some(crs) = &layout.crs {
                bail!(
                    "--crs {crs}: found latitude and longitude in {name}, expected metres (--columns x=TITLE,z=TITLE)"
                );
            }
            if let Some((index, why)) = swapped(&rows, layout) {
                bail!("{}: {why}", at(index));
            }
            for (index, Recorded { position, .. }) in rows.samples.iter().enumerate() {
                check_degrees(*position).map_err(|error| anyhow!("{}: {error}", at(index)))?;
            }
        }
        if let (Some(threshold), [first, others @ ..]) = (layout.threshold, &rows.samples[..])
            && others.iter().all(|it| it.label == first.label)
        {
            let (count, side) =
                (rows.samples.len(), if first.label.sign() > 0 { "above" } else { "not above" });
            bail!(
                "--threshold {threshold}: all {count} values of {name} are {side} it, expected values on both sides"
            );
        }
        let positions: Vec<_> = rows.samples.iter().map(|it| it.position).collect();
        let frame = Frame::of(&positions, rows.is_geographic, layout.origin, layout.crs.as_ref())
            .map_err(|error| anyhow!("{name}: {error}"))?;
        let sample = |(index, it): (usize, &Recorded)| {
            let site =
                frame.site(it.position).map_err(|error| anyhow!("{}: {error}", at(index)))?;
            Ok(Sample { site, label: it.label })
        };
        let samples = rows.samples.iter().enumerate().map(sample).collect::<Result<_>>()?;
        Ok(Self { name: name.to_owned(), samples, frame, unit, rows })
    }

    /// The line on which a sample begins, or the number of its feature.
    pub(crate) fn line(&self, index: usize) -> usize {
        self.rows.samples[index].line
    }

    /// What a report begins with: the headline, what is odd about the rows, and the origin of positions, a line each.
    pub(crate) fn beginning(&self, headline: &str) -> String {
        let (Skipped { count, first, lacks }, unit) = (&self.rows.skipped, self.unit);
        let (row, name) = (unit.row(), unit.name());
        let s = if *count == 1 { "" } else { "s" };
        let skipped = first.map(|line| {
            format!(
                "Skipped {count} {row}{s} without a value, the first on {name} {line} ({lacks}).\n"
            )
        });
        let odd = self.rows.odd.map(|(line, value, [least, most])| {
            format!(
                "On {name} {line} stands {value}, all other values are from {least} to {most}: leave such rows out if that is no value.\n"
            )
        });
        let backwards = self.rows.backwards.map(|(count, line)| {
            let rows = if count == 1 { "row is" } else { "rows are" };
            format!(
                "{count} {rows} of an earlier time than the row before, the first on {name} {line}: rows count in the order of \
                 the file. Sort them by time if it matters.\n"
            )
        });
        let [skipped, odd, backwards] = [skipped, odd, backwards].map(Option::unwrap_or_default);
        let about = self.frame.about();
        format!("{}: {headline}.\n{skipped}{odd}{backwards}{about}", self.name)
    }

    /// What else its row says.
    pub(crate) fn told(&self, index: usize) -> Told {
        self.rows.samples[index].told.clone()
    }

    /// The time of the row on a line, or of the feature with that number.
    pub(crate) fn time(&self, line: usize) -> Option<Value> {
        let index = self.rows.samples.binary_search_by_key(&line, |it| it.line).ok()?;
        let is_time = |name: &str| table_file::TIMES.iter().any(|it| it.eq_ignore_ascii_case(name));
        self.rows.samples[index].told.iter().find(|(name, _)| is_time(name)).map(|it| it.1.clone())
    }

    /// The file and the line of a sample.
    pub(crate) fn place(&self, index: usize) -> String {
        self.unit.place(&self.name, self.line(index))
    }
}

/// The first row whose latitude looks like a longitude, with the message; `None` if the latitudes may be latitudes.
fn swapped(rows: &Rows, layout: &Layout) -> Option<(usize, String)> {
    let is_beyond = |it: &Recorded| it.position[0].abs() > 90.0;
    let beyond = rows.samples.iter().filter(|it| is_beyond(it)).count();
    // A few are mistakes in rows, which are reported one by one.
    let would_do = |it: &Recorded| matches!(it.position, [lat, lon] if lat.abs() <= 360.0 && lon.abs() <= 90.0);
    if 2 * beyond <= rows.samples.len() || !rows.samples.iter().all(would_do) {
        return None;
    }
    let index = rows.samples.iter().position(is_beyond)?;
    let remedy = match (&rows.titles, rows.unit) {
        (Some([lat, lon]), _) => {
            let label = layout.columns.as_ref().and_then(Columns::label);
            let label = label.map(|label| format!(",label={label}")).unwrap_or_default();
            format!("name them by --columns lat={lon},lon={lat}{label}")
        }
        (None, Unit::Feature) => "positions of GeoJSON have their longitude first".to_owned(),
        (None, Unit::Line) => "write them the other way round".to_owned(),
    };
    let lat = rows.samples[index].position[0];
    Some((
        index,
        format!("found the latitude {lat}: latitude and longitude look swapped; {remedy}"),
    ))
}
