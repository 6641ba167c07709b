//! Answers for a map: `GeoJSON` (RFC 7946), whose coordinates are longitude and latitude in degrees, WGS84.

use std::iter;

use anyhow::{Context as _, Result, bail};
use geojson::{Feature, FeatureCollection, Geometry, GeometryValue};
use nalgebra::Point2;
use planner_core::{Area, Sample};
use serde_json::{Value, json};

use crate::replay::frame::Frame;
use crate::replay::sample_file::SampleFile;
use crate::report::picture::area_around;
use crate::world::extent::span;
use crate::world::polygon::Polygon;

impl Frame {
    /// Checks that positions have a place on the globe, all on one side of the 180th meridian. `name` is what they are
    /// of, and `or` another way to have one.
    ///
    /// # Errors
    /// Names what was found and what was expected.
    pub(crate) fn check_globe(
        &self,
        (name, or): (&str, &str),
        places: impl Iterator<Item = Point2<f64>>,
    ) -> Result<()> {
        if !self.is_on_globe() {
            bail!(
                "--geojson: found positions in metres in {name}, expected latitude and longitude{or}, or the system of the \
                 metres (--crs EPSG:...)"
            );
        }
        let lons = places.map(|at| Ok(self.degrees(at)?[0])).collect::<Result<Vec<_>>>()?;
        let [least, most] = span(lons);
        if most - least > 180.0 {
            bail!(
                "--geojson: {name} lies on both sides of the 180th meridian, expected positions on one"
            );
        }
        Ok(())
    }
}

impl SampleFile {
    /// The area around the samples, if it has a place on the globe.
    ///
    /// # Errors
    /// Names the file, what was found and what was expected.
    pub(crate) fn area_on_globe(&self) -> Result<Area> {
        let told = (&*self.name, " (--columns lat=TITLE,lon=TITLE)");
        self.frame.check_globe(told, iter::empty())?;
        let area = area_around(&self.samples)
            .with_context(|| format!("{}: no area around the samples", self.name))?;
        self.frame.check_globe(told, Polygon::from(area).0.into_iter())?;
        Ok(area)
    }

    /// The samples as points, with what else their rows say, and whether they disagree with a line, if there is one.
    pub(crate) fn points(&self, disagreeing: Option<&[usize]>) -> Result<Vec<Feature>> {
        let point = |(index, sample): (usize, &Sample)| {
            let mut told = Value::Object(self.told(index));
            told["kind"] = "sample".into();
            told["label"] = sample.label.sign().into();
            told["line"] = self.line(index).into();
            if let Some(disagreeing) = disagreeing {
                told["disagrees"] = disagreeing.binary_search(&index).is_ok().into();
            }
            let at = self.frame.degrees(sample.site.into())?;
            Ok(feature(GeometryValue::new_point(at), told))
        };
        self.samples.iter().enumerate().map(point).collect()
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
