//! The map of a front as a file of vertices, as `--map` writes it.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, anyhow, bail};

use crate::mission::front::VertexRecord;
use crate::output::{kind, plain};
use crate::report::pieces::{OWN, ROBOT, TITLES};

/// A map as it was read.
pub(crate) struct MapFile {
    /// What the file is called.
    pub(crate) name: String,
    /// `step` or `row`.
    pub(crate) numbers: &'static str,
    /// The titles of the coordinates of the samples' file, unless positions are metres about an origin that is not named.
    own: Option<[&'static str; 2]>,
    /// Whether it is joined from others: then its numbers are those of several robots.
    pub(crate) is_joined: bool,
    /// The vertices in their order.
    pub(crate) rows: Vec<MapRow>,
}

/// A vertex.
pub(crate) struct MapRow {
    pub(crate) number: usize,
    pub(crate) piece: usize,
    pub(crate) position: [f64; 2],
    pub(crate) vertex: VertexRecord,
    /// The line of the file.
    pub(crate) line: u64,
}

impl MapFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the file and the line, what was found and what was expected.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let name = plain::name(&path.display().to_string());
        let text = fs::read(path).map_err(|error| {
            anyhow!("{name}: found {}, expected the map of a front", kind::unread(&error))
        })?;
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
        let mut reader = csv::Reader::from_reader(text);
        let titles = reader.headers().with_context(|| format!("{name}:1"))?.clone();
        let at = |title: &str| titles.iter().position(|it| it == title);
        let numbers = if at("step").is_some() { "step" } else { "row" };
        if let Some(title) = TITLES.into_iter().chain([numbers]).find(|it| at(it).is_none()) {
            bail!(
                "{name}: found no column {title}, expected the map of a front, as --map writes it"
            );
        }
        let own = OWN.into_iter().find(|own| own.iter().all(|it| at(it).is_some()));
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| {
                let line = error.position().map_or(0, csv::Position::line);
                anyhow!("{name}:{line}: expected a row of a map: {error}")
            })?;
            let line = record.position().map_or(0, csv::Position::line);
            let field = |title: &str| record.get(at(title)?).map(str::trim);
            let row = row(field, numbers, own.unwrap_or(["x", "z"]), line);
            rows.push(row.map_err(|error| anyhow!("{name}:{line}: {error}"))?);
        }
        if rows.is_empty() {
            bail!("{name}: found a map without vertices, expected one whose robot found the front");
        }
        let is_joined = at(ROBOT).is_some();
        Ok(Self { name, numbers, own, is_joined, rows })
    }

    /// Whether its positions are latitude and longitude.
    pub(crate) fn is_geographic(&self) -> bool {
        self.own == Some(OWN[0])
    }

    /// What its positions are.
    pub(crate) fn kind(&self) -> &'static str {
        match self.own {
            None => "metres (x, z)",
            Some(_) if self.is_geographic() => "latitude and longitude",
            Some(_) => "metres of another file (file_x, file_z)",
        }
    }
}

/// The row of a line, from its fields by their titles.
fn row<'a>(
    field: impl Fn(&str) -> Option<&'a str>,
    numbers: &str,
    position: [&str; 2],
    line: u64,
) -> Result<MapRow> {
    let number = |title: &str| {
        let text = field(title).unwrap_or_default();
        let number = text.parse::<f64>();
        let number = number.map_err(|_| anyhow!("{title}: found {text:?}, expected a number"))?;
        if !number.is_finite() {
            bail!("{title}: found {number}, expected a finite number");
        }
        Ok(number)
    };
    let whole = |title: &str| {
        let text = field(title).unwrap_or_default();
        text.parse().map_err(|_| anyhow!("{title}: found {text:?}, expected a whole number"))
    };
    let [x, z, heading, half_width] = ["x", "z", "heading", "half_width"].map(number);
    let (x, z, heading, half_width) = (x?, z?, heading?, half_width?);
    if half_width < 0.0 {
        bail!("half_width: found {half_width}, expected metres, 0 or more");
    }
    let [curvature, turn_deviation] = ["curvature", "turn_deviation"].map(number);
    let (curvature, turn_deviation) = (curvature? as f32, turn_deviation? as f32);
    let [a, b] = position.map(number);
    let vertex = VertexRecord { x, z, heading, curvature, half_width, turn_deviation };
    Ok(MapRow { number: whole(numbers)?, piece: whole("piece")?, position: [a?, b?], vertex, line })
}
