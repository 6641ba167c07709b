//! A mission in an area from a map, as `GeoJSON` (RFC 7946) for the same map.

use anyhow::{Context as _, Result};
use geojson::{Feature, FeatureCollection, Geometry, GeometryValue};
use nalgebra::Point2;
use serde_json::{Value, json};

use crate::mission::recording::Recording;
use crate::report::pieces::Pieces;
use crate::world::polygon::Polygon;

/// The robot's track, its samples, the estimate of a line, and the map of a front piece by piece.
///
/// # Errors
/// For an area in metres, which has no place on a map.
pub fn geojson(recording: &Recording) -> Result<String> {
    let Recording { mission, results, belief, .. } = recording;
    let lake = mission
        .lake
        .as_ref()
        .context("--geojson: found an area in metres, expected one from a map (area.geojson)")?;
    // On both sides of the 180th meridian longitudes go on, so that no line leads round the globe.
    let [middle, _] = lake.frame.degrees(Point2::origin())?;
    let degrees = |at: [f64; 2]| -> Result<[f64; 2]> {
        let [lon, lat] = lake.frame.degrees(Point2::from(at))?;
        Ok([middle + libm::remainder(lon - middle, 360.0), lat])
    };
    let way = |places: &mut dyn Iterator<Item = [f64; 2]>| -> Result<GeometryValue> {
        Ok(GeometryValue::new_line_string(places.map(degrees).collect::<Result<Vec<_>>>()?))
    };
    let start = results.start.pose;
    let ends = results.steps.iter().map(|step| [step.pose.x, step.pose.z]);
    let mut track = [[start.x, start.z]].into_iter().chain(ends);
    let mut features = vec![feature(way(&mut track)?, json!({ "kind": "track" }))];
    let given = results.start.oracle.iter().map(|it| (0, [it.x, it.z], it.label));
    let read = results
        .steps
        .iter()
        .filter_map(|step| Some((step.step, [step.pose.x, step.pose.z], step.label?)));
    for (step, at, label) in given.chain(read) {
        let told = json!({ "kind": "sample", "label": label, "step": step });
        features.push(feature(GeometryValue::new_point(degrees(at)?), told));
    }
    let centre = belief.front().is_none().then(|| belief.estimates().centre).flatten();
    let chord = centre.and_then(|it| Polygon::from(mission.config.area).chord(&it.into()));
    if let Some(chord) = chord {
        let mut ends = chord.into_iter().map(Into::into);
        features.push(feature(way(&mut ends)?, json!({ "kind": "centre" })));
    }
    for (number, piece) in (1..).zip(Pieces::of(results).ways()) {
        let mut places = piece.into_iter().map(Into::into);
        features.push(feature(way(&mut places)?, json!({ "kind": "front", "piece": number })));
    }
    Ok(collection(features))
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
