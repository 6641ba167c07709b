//! The samples of a `GeoJSON` file: points with a property that is their label.

use std::slice;

use anyhow::{Result, anyhow, bail};
use geojson::{Feature, GeometryValue, Position};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Deserializer, Error, Value};

use crate::replay::reading::{Gap, Reading, is_missing};
use crate::replay::rows::{Layout, Rows, Unit};

/// The keys that tell `GeoJSON` from a trace.
#[derive(Deserialize)]
struct Kind {
    #[serde(rename = "type")]
    kind: Option<IgnoredAny>,
    record: Option<IgnoredAny>,
}

/// Whether a text that begins with `{` is `GeoJSON`, as far as it can be read.
pub(crate) fn is_one(text: &[u8]) -> bool {
    const WORD: &[u8] = b"\"FeatureCollection\"";
    match Deserializer::from_slice(text).into_iter::<Kind>().next() {
        Some(Ok(Kind { kind, record })) => kind.is_some() && record.is_none(),
        _ => text.windows(WORD.len()).take(10_000).any(|part| part == WORD),
    }
}

/// The points of a file.
///
/// # Errors
/// Names the file and the feature, what was found and what was expected.
pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Rows> {
    Reading::of(name, layout, None, |reading| pass(reading, text))
}

fn pass(reading: &mut Reading, text: &[u8]) -> Result<()> {
    let (name, layout) = (reading.name, reading.layout);
    let wanted = reading.label("GeoJSON")?;
    let parsed = serde_json::from_slice(text).or_else(|_| serde_json::from_str(&with_nulls(text)));
    let mut file: Value = parsed
        .map_err(|error: Error| anyhow!("{name}:{}: expected GeoJSON: {error}", error.line()))?;
    let kind = &file["type"];
    if kind != "FeatureCollection" {
        bail!("{name}: found GeoJSON of the type {kind}, expected a FeatureCollection of points");
    }
    check_system(name, &file, layout)?;
    let Value::Array(features) = file["features"].take() else {
        bail!("{name}: found GeoJSON without features, expected a FeatureCollection of points");
    };
    reading.rows =
        Rows { is_geographic: layout.crs.is_none(), unit: Unit::Feature, ..Rows::default() };
    if let Some(first) = features.first()
        && features.iter().all(|it| it["properties"].get(wanted).is_none())
    {
        let others = first["properties"].as_object();
        let others: Vec<_> = others.into_iter().flat_map(|it| it.keys().cloned()).collect();
        return Err(reading.no_label(wanted, 1, &others));
    }
    for (number, feature) in (1..).zip(features) {
        reading.row(number, |reading| read(reading, wanted, feature, number))?;
    }
    Ok(())
}

fn read(reading: &mut Reading, wanted: &str, feature: Value, number: usize) -> Result<Gap> {
    let feature: Feature = serde_json::from_value(feature)
        .map_err(|error| anyhow!("expected a feature of GeoJSON: {error}"))?;
    let points = match feature.geometry.as_ref().map(|geometry| &geometry.value) {
        Some(GeometryValue::Point { coordinates }) => slice::from_ref(coordinates),
        Some(GeometryValue::MultiPoint { coordinates }) => &coordinates[..],
        Some(other) => {
            return Ok(Some(format!("found a {}, which is no point", other.type_name())));
        }
        None => return Ok(Some("found no geometry".to_owned())),
    };
    let text = match feature.property(wanted) {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.trim().to_owned(),
        Some(value @ (Value::Bool(_) | Value::Number(_))) => value.to_string(),
        Some(value) => bail!("label: found {value}, expected a word or a number"),
    };
    if is_missing(&text) {
        return Ok(Some(format!("label: found {text:?}")));
    }
    let is_geographic = reading.rows.is_geographic;
    let position = |at: &Position| match at.as_slice() {
        [x, z, ..] => Some(if is_geographic { [*z, *x] } else { [*x, *z] }),
        _ => None,
    };
    let Some(positions) = points.iter().map(position).collect::<Option<Vec<_>>>() else {
        return Ok(Some("found a point with less than two coordinates".to_owned()));
    };
    if reading.layout.keeps {
        reading.told = feature.properties.unwrap_or_default();
    }
    reading.samples(&positions, &text, number)
}

/// A text that some programs write for `GeoJSON`: with NaN and Infinity, which JSON lacks, as null.
fn with_nulls(text: &[u8]) -> String {
    let (mut out, mut is_quoted) = (String::new(), false);
    let text = String::from_utf8_lossy(text);
    for part in text.split_inclusive('"') {
        let words = ["NaN", "-Infinity", "Infinity", "-inf", "inf", "nan"];
        let bare =
            |part: &str| words.iter().fold(part.to_owned(), |it, word| it.replace(word, "null"));
        out += &if is_quoted { part.to_owned() } else { bare(part) };
        // A quote after an odd number of backslashes is one of the string.
        let before = part.trim_end_matches('"');
        let escapes = before.len() - before.trim_end_matches('\\').len();
        is_quoted ^= !is_quoted || escapes.is_multiple_of(2);
    }
    out
}

/// Coordinates are degrees, unless the file says otherwise. `GeoJSON` from before RFC 7946 may do so.
fn check_system(name: &str, file: &Value, layout: &Layout) -> Result<()> {
    let system = file["crs"]["properties"]["name"].as_str().unwrap_or_default();
    let code = system.rsplit(':').next().filter(|_| system.contains("EPSG"));
    match code {
        Some(code) if code != "4326" && layout.crs.is_none() => {
            bail!(
                "{name}: found coordinates of EPSG:{code}, expected longitude and latitude, or --crs EPSG:{code}"
            )
        }
        _ => Ok(()),
    }
}
