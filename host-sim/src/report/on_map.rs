//! A mission in an area from a map, for the same map.

use anyhow::{Context as _, Result};
use geojson::{Feature, FeatureCollection, Geometry, GeometryValue};
use gpx::{Gpx, GpxVersion, Track, TrackSegment, Waypoint};
use nalgebra::Point2;
use serde_json::{Value, json};

use crate::mission::recording::Recording;
use crate::report::pieces::Pieces;
use crate::world::polygon::Polygon;

/// Longitude and latitude.
type Degrees = [f64; 2];

/// What a mission has to show on a map.
struct OnMap {
    track: Vec<Degrees>,
    /// Each with its step, 0 of those that were given, and its label.
    samples: Vec<(usize, Degrees, i8)>,
    /// The estimate of a line.
    centre: Option<Vec<Degrees>>,
    /// The map of a front, piece by piece.
    front: Vec<Vec<Degrees>>,
}

impl OnMap {
    /// # Errors
    /// For an area in metres, which has no place on a map.
    fn of(recording: &Recording) -> Result<Self> {
        let Recording { mission, results, belief, .. } = recording;
        let lake = mission.lake.as_ref();
        let lake =
            lake.context("found an area in metres, expected one from a map (area.geojson)")?;
        // On both sides of the 180th meridian longitudes go on, so that no line leads round the globe.
        let [middle, _] = lake.frame.degrees(Point2::origin())?;
        let degrees = |at: Point2<f64>| -> Result<Degrees> {
            let [lon, lat] = lake.frame.degrees(at)?;
            Ok([middle + libm::remainder(lon - middle, 360.0), lat])
        };
        let way = |places: Vec<Point2<f64>>| places.into_iter().map(degrees).collect();
        let start = results.start.pose;
        let ends = results.steps.iter().map(|step| Point2::new(step.pose.x, step.pose.z));
        let track = [Point2::new(start.x, start.z)].into_iter().chain(ends);
        let given = results.start.oracle.iter().chain(&results.start.samples);
        let given = given.map(|it| (0, [it.x, it.z], it.label));
        let read = results
            .steps
            .iter()
            .filter_map(|step| Some((step.step, [step.pose.x, step.pose.z], step.label?)));
        let sample = |(step, at, label): (_, [f64; 2], _)| Ok((step, degrees(at.into())?, label));
        let centre = belief.front().is_none().then(|| belief.estimates().centre).flatten();
        let chord = centre.and_then(|it| Polygon::from(mission.config.area).chord(&it.into()));
        Ok(Self {
            track: way(track.collect())?,
            samples: given.chain(read).map(sample).collect::<Result<_>>()?,
            centre: chord.map(|it| way(it.into())).transpose()?,
            front: Pieces::of(results).ways().map(way).collect::<Result<_>>()?,
        })
    }
}

/// The robot's track, its samples, the estimate of a line, and the map of a front piece by piece, as `GeoJSON` (RFC 7946).
///
/// # Errors
/// For an area in metres, which has no place on a map.
pub fn geojson(recording: &Recording) -> Result<String> {
    let OnMap { track, samples, centre, front } = OnMap::of(recording)?;
    let mut features =
        vec![feature(GeometryValue::new_line_string(track), json!({ "kind": "track" }))];
    for (step, at, label) in samples {
        let told = json!({ "kind": "sample", "label": label, "step": step });
        features.push(feature(GeometryValue::new_point(at), told));
    }
    if let Some(ends) = centre {
        features.push(feature(GeometryValue::new_line_string(ends), json!({ "kind": "centre" })));
    }
    for (number, piece) in (1..).zip(front) {
        let told = json!({ "kind": "front", "piece": number });
        features.push(feature(GeometryValue::new_line_string(piece), told));
    }
    Ok(collection(features))
}

/// The same as GPX 1.1, of a mission with this title: tracks, and a waypoint for each sample.
///
/// # Errors
/// As [`geojson`](fn@geojson).
pub fn gpx(title: &str, recording: &Recording) -> Result<String> {
    let OnMap { track, samples, centre, front } = OnMap::of(recording)?;
    let point = |[lon, lat]: Degrees| Waypoint::new((lon, lat).into());
    let named = |name: String, way: Vec<Degrees>| {
        let segment = TrackSegment { points: way.into_iter().map(point).collect() };
        Track { name: Some(name), segments: vec![segment], ..Track::new() }
    };
    let sample = |(step, at, label): (usize, _, i8)| {
        let mut sample = point(at);
        sample.name = Some(format!("{label:+}"));
        sample.comment = Some(if step == 0 { "given".to_owned() } else { format!("step {step}") });
        sample
    };
    let fronts = (1..).zip(front).map(|(number, piece)| named(format!("front {number}"), piece));
    let tracks = [named("track".to_owned(), track)].into_iter();
    let gpx = Gpx {
        version: GpxVersion::Gpx11,
        creator: Some(title.to_owned()),
        waypoints: samples.into_iter().map(sample).collect(),
        tracks: tracks
            .chain(centre.map(|it| named("centre".to_owned(), it)))
            .chain(fronts)
            .collect(),
        ..Gpx::default()
    };
    let mut text = Vec::new();
    gpx::write(&gpx, &mut text)?;
    Ok(String::from_utf8(text)?)
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
