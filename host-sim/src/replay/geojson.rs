//! Answers for a map: `GeoJSON` (RFC 7946), whose coordinates are longitude and latitude in degrees, WGS84.

use anyhow::{Context as _, Result, bail};
use geojson::{Feature, FeatureCollection, Geometry, GeometryValue};
use planner_core::{Area, Sample};
use serde_json::{Value, json};

use crate::replay::sample_file::SampleFile;
use crate::report::picture::area_around;
use crate::world::polygon::Polygon;

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
