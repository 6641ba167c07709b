//! The samples of a `GeoJSON` file: points with a property that is their label.

use anyhow::{Result, anyhow, bail};
use geojson::{Feature, GeometryValue};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Deserializer, Value};

use crate::replay::label_name::{label_name, no_label};
use crate::replay::label_words::LabelWords;
use crate::replay::missing::is_missing;
use crate::replay::numbers::{self, Decimal, Numbers};
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
    numbers::settled(|decimal| pass(name, text, layout, decimal))
}

fn pass(
    name: &str,
    text: &[u8],
    layout: &Layout,
    settled: Option<Decimal>,
) -> Result<(Rows, Option<Decimal>)> {
    let wanted = label_name(name, "GeoJSON", layout)?;
    let mut file: Value = serde_json::from_slice(text)
        .map_err(|error| anyhow!("{name}:{}: expected GeoJSON: {error}", error.line()))?;
    let kind = &file["type"];
    if kind != "FeatureCollection" {
        bail!("{name}: found GeoJSON of the type {kind}, expected a FeatureCollection of points");
    }
    check_system(name, &file, layout)?;
    let Value::Array(features) = file["features"].take() else {
        bail!("{name}: found GeoJSON without features, expected a FeatureCollection of points");
    };
    let mut numbers = Numbers::of(None, settled);
    let mut words = LabelWords::of(layout.threshold);
    let is_geographic = layout.crs.is_none();
    let mut rows = Rows { is_geographic, unit: Unit::Feature, ..Rows::default() };
    // The properties of the first point, and whether any point has the wanted one.
    let (mut others, mut has_label) = (None::<(usize, Vec<String>)>, false);
    for (number, feature) in (1..).zip(features) {
        let at = |error: anyhow::Error| anyhow!("{}: {error}", Unit::Feature.place(name, number));
        let feature: Feature = serde_json::from_value(feature)
            .map_err(|error| at(anyhow!("expected a feature of GeoJSON: {error}")))?;
        let position = match feature.geometry.as_ref().map(|geometry| &geometry.value) {
            Some(GeometryValue::Point { coordinates }) if coordinates.len() >= 2 => {
                [coordinates[0], coordinates[1]]
            }
            Some(other) => {
                let lacks = format!("found a {}, which is no point", other.type_name());
                rows.skip(layout, number, lacks).map_err(at)?;
                continue;
            }
            None => {
                rows.skip(layout, number, "found no geometry".to_owned()).map_err(at)?;
                continue;
            }
        };
        let value = feature.property(wanted);
        has_label |= value.is_some();
        let has =
            || feature.properties.iter().flat_map(|it| it.keys().cloned()).collect::<Vec<_>>();
        others.get_or_insert_with(|| (number, has()));
        let text = match value {
            None | Some(Value::Null) => String::new(),
            Some(Value::String(text)) => text.trim().to_owned(),
            Some(value @ (Value::Bool(_) | Value::Number(_))) => value.to_string(),
            Some(value) => bail!(at(anyhow!("label: found {value}, expected a word or a number"))),
        };
        if is_missing(&text) {
            let lacks = format!("label: found {text:?} in {wanted}");
            rows.skip(layout, number, lacks).map_err(at)?;
            continue;
        }
        let label = words.read(&text, &mut numbers, number).map_err(at)?;
        let [x, z] = position;
        rows.push(if is_geographic { [z, x] } else { [x, z] }, label, number);
    }
    if let (false, Some((number, others))) = (has_label, others) {
        let place = Unit::Feature.place(name, number);
        return Err(no_label(&place, wanted, layout, &others));
    }
    let at = |(number, error)| anyhow!("{}: {error}", Unit::Feature.place(name, number));
    words.end().map_err(at)?;
    let settled = numbers.end().map_err(at)?;
    Ok((rows, settled))
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
