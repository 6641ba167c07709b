//! The map of a front as a file of vertices, as `--map` writes it.

use std::fs;
use std::path::Path;
use std::str::FromStr;

use anyhow::{Context as _, Result, anyhow, bail};
use csv::StringRecord;

use crate::mission::front::VertexRecord;
use crate::output::{kind, plain};
use crate::report::pieces::ROBOT;

/// The columns of all map files, but for the number.
const COLUMNS: [&str; 7] =
    ["x", "z", "heading", "curvature", "half_width", "turn_deviation", "piece"];

/// Columns of coordinates of the samples' file: of the globe, and of metres.
const OWN: [[&str; 2]; 2] = [["lat", "lon"], ["file_x", "file_z"]];

/// A map as it was read.
pub(crate) struct MapFile {
    /// What the file is called.
    pub(crate) name: String,
    /// `step` or `row`.
    pub(crate) numbers: &'static str,
    /// Whether its positions are latitude and longitude.
    pub(crate) is_geographic: bool,
    /// Whether its positions are those of the samples' file, and not metres about an origin that it does not name.
    pub(crate) is_own: bool,
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

/// Where the columns are.
struct Columns {
    number: usize,
    common: [usize; 7],
    own: Option<[usize; 2]>,
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
        let column = |title: &str| {
            at(title).with_context(|| {
                format!("{name}: found no column {title}, expected the map of a front, as --map writes it")
            })
        };
        let numbers = if at("step").is_some() { "step" } else { "row" };
        let own = OWN.iter().find_map(|it| Some((it[0] == "lat", [at(it[0])?, at(it[1])?])));
        let mut common = [0; 7];
        for (place, title) in common.iter_mut().zip(COLUMNS) {
            *place = column(title)?;
        }
        let columns = Columns { number: column(numbers)?, common, own: own.map(|it| it.1) };
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| {
                let line = error.position().map_or(0, csv::Position::line);
                anyhow!("{name}:{line}: expected a row of a map: {error}")
            })?;
            let line = record.position().map_or(0, csv::Position::line);
            let row = columns.row(&record, line, numbers);
            rows.push(row.map_err(|error| anyhow!("{name}:{line}: {error}"))?);
        }
        if rows.is_empty() {
            bail!("{name}: found a map without vertices, expected one whose robot found the front");
        }
        let (is_geographic, is_own) = (own.is_some_and(|it| it.0), own.is_some());
        let is_joined = at(ROBOT).is_some();
        Ok(Self { name, numbers, is_geographic, is_own, is_joined, rows })
    }

    /// What its positions are.
    pub(crate) const fn kind(&self) -> &'static str {
        match (self.is_geographic, self.is_own) {
            (true, _) => "latitude and longitude",
            (_, true) => "metres of another file (file_x, file_z)",
            _ => "metres (x, z)",
        }
    }
}

impl Columns {
    fn row(&self, record: &StringRecord, line: u64, numbers: &str) -> Result<MapRow> {
        let number = |k: usize| number::<f64>(record, self.common[k], COLUMNS[k], "a number");
        let [x, z] = [number(0)?, number(1)?];
        let (heading, half_width) = (number(2)?, number(4)?);
        if half_width < 0.0 {
            bail!("half_width: found {half_width}, expected metres, 0 or more");
        }
        let [curvature, turn_deviation] = [number(3)? as f32, number(5)? as f32];
        let position = match self.own {
            Some([a, b]) => {
                let own = |at| self::number(record, at, "coordinates", "a number");
                [own(a)?, own(b)?]
            }
            None => [x, z],
        };
        for (what, it) in [("x", x), ("z", z), ("heading", heading), ("half_width", half_width)]
            .into_iter()
            .chain(position.map(|it| ("coordinates", it)))
        {
            if !it.is_finite() {
                bail!("{what}: found {it}, expected a finite number");
            }
        }
        let vertex = VertexRecord { x, z, heading, curvature, half_width, turn_deviation };
        let whole = "a whole number";
        Ok(MapRow {
            number: self::number(record, self.number, numbers, whole)?,
            piece: self::number(record, self.common[6], "piece", whole)?,
            position,
            vertex,
            line,
        })
    }
}

fn number<T: FromStr>(record: &StringRecord, at: usize, what: &str, expected: &str) -> Result<T> {
    let text = record.get(at).unwrap_or_default().trim();
    text.parse().map_err(|_| anyhow!("{what}: found {text:?}, expected {expected}"))
}
