//! The answer for a map: `GeoJSON` (RFC 7946), whose coordinates are longitude and latitude in degrees, WGS84.

use anyhow::{Context as _, Result, bail};
use geojson::{Feature, FeatureCollection, Geometry, GeometryValue};
use planner_core::{Area, Sample};
use serde_json::{Value, json};

use crate::replay::record::Replay;
use crate::replay::sample_file::SampleFile;
use crate::report::picture::area_around;
use crate::world::polygon::Polygon;

impl Replay {
    /// Samples, lines, and the ground to which all lines left give one label. Where labels may be wrong, these are the
    /// lines of the credible set.
    ///
    /// # Errors
    /// For a file whose positions are in metres, as these have no place on a map by themselves. Also for positions on
    /// both sides of the 180th meridian.
    pub fn geojson(&self) -> Result<String> {
        let area = self.file.area_on_globe()?;
        let mut features = Vec::new();
        for (polygon, label) in self.answer.ground(area).into_iter().zip([1, -1]) {
            if polygon.0.len() >= 3 {
                let ring = polygon
                    .0
                    .iter()
                    .chain(polygon.0.first())
                    .map(|at| self.file.frame.degrees(*at));
                let ring = ring.collect::<Result<Vec<_>>>()?;
                let level = self.answer.doubt.as_ref().map(|doubt| doubt.probability);
                features.push(feature(
                    GeometryValue::new_polygon([ring]),
                    json!({ "kind": "ground", "label": label, "probability": level.unwrap_or(1.0) }),
                ));
            }
        }
        let most_likely = self.answer.doubt.as_ref().map(|doubt| doubt.most_likely);
        for (kind, line) in [
            ("centre", self.answer.centre),
            ("maximum_margin", self.answer.maximum_margin),
            ("most_likely", most_likely),
        ] {
            if let Some([from, to]) = line.and_then(|line| self.ends(&line)) {
                let ends = [self.file.frame.degrees(from)?, self.file.frame.degrees(to)?];
                features
                    .push(feature(GeometryValue::new_line_string(ends), json!({ "kind": kind })));
            }
        }
        let disagreeing = self.answer.doubt.as_ref().map(|doubt| &doubt.disagreeing);
        for (index, sample) in self.file.samples.iter().enumerate() {
            let disagrees = disagreeing.map(|them| them.binary_search(&index).is_ok());
            features.push(self.file.point(index, sample, disagrees)?);
        }
        Ok(collection(features))
    }
}

impl SampleFile {
    /// The area around the samples, if it has a place on the globe.
    ///
    /// # Errors
    /// Names the file, what was found and what was expected.
    pub(crate) fn area_on_globe(&self) -> Result<Area> {
        let name = &self.name;
        if !self.frame.is_on_globe() {
            bail!(
                "--geojson: found positions in metres in {name}, expected latitude and longitude \
                 (--columns lat=TITLE,lon=TITLE), or the system of the metres (--crs EPSG:...)"
            );
        }
        let area = area_around(&self.samples)
            .with_context(|| format!("{name}: no area around the samples"))?;
        if self.frame.crosses_meridian(Polygon::from(area).0.into_iter())? {
            bail!(
                "--geojson: {name} lies on both sides of the 180th meridian, expected positions on one"
            );
        }
        Ok(area)
    }

    /// A sample as a point, with what else its row says.
    pub(crate) fn point(
        &self,
        index: usize,
        sample: &Sample,
        disagrees: Option<bool>,
    ) -> Result<Feature> {
        let mut told = Value::Object(self.told(index));
        told["kind"] = "sample".into();
        told["label"] = sample.label.sign().into();
        told["line"] = self.line(index).into();
        if let Some(disagrees) = disagrees {
            told["disagrees"] = disagrees.into();
        }
        Ok(feature(GeometryValue::new_point(self.frame.degrees(sample.site.into())?), told))
    }
}

pub(crate) fn feature(geometry: GeometryValue, properties: Value) -> Feature {
    let properties = if let Value::Object(map) = properties { Some(map) } else { None };
    Feature { geometry: Some(Geometry::new(geometry)), properties, ..Feature::default() }
}

/// The text of a file of features.
pub(crate) fn collection(features: Vec<Feature>) -> String {
    let all = FeatureCollection { features, ..FeatureCollection::default() };
    json!(all).to_string() + "\n"
}
