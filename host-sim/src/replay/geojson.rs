//! Answers for a map: `GeoJSON` (RFC 7946), whose coordinates are longitude and latitude in degrees, WGS84.

use std::iter;

use anyhow::{Context as _, Result};
use geojson::{Feature, GeometryValue};
use planner_core::{Area, Sample};
use serde_json::Value;

use crate::replay::sample_file::SampleFile;
use crate::report::on_map::feature;
use crate::report::picture::area_around;
use crate::world::polygon::Polygon;

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
