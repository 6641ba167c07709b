//! What a boundary is that is no straight line: the side of a place, the distance from it, and how it is drawn.

use std::fmt::Debug;
use std::panic::RefUnwindSafe;

use nalgebra::Point2;
use planner_core::{Label, Reading};
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

use crate::world::way::Way;

/// A boundary that is no straight line. It keeps its shape.
pub trait Curve: Debug + Send + Sync + RefUnwindSafe {
    /// The side that a place is on.
    fn side(&self, at: Point2<f64>) -> Reading;

    /// The distance of a place from the boundary, metres.
    fn distance(&self, at: Point2<f64>) -> f64;

    /// The boundary as far as it lies in a rectangle. It may be drawn beyond.
    fn ways(&self, within: [Point2<f64>; 2]) -> Vec<Way>;

    /// What it is, for the trace.
    fn record(&self) -> BoundaryRecord;
}

/// A boundary that is no fixed line, by the keys that it has in a scenario file.
#[skip_serializing_none]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BoundaryRecord {
    /// `a x + b z + c = 0` with `a^2 + b^2 = 1`, for a sine and for a line that moves.
    pub line: Option<[f64; 3]>,
    /// By so much the boundary moves in each motion: a line by metres and degrees, any other by metres along x and z.
    pub drift: Option<[f64; 2]>,
    /// The middle and the radius.
    pub circle: Option<[f64; 3]>,
    /// Height, length and phase.
    pub sine: Option<[f64; 3]>,
    /// The points.
    pub polyline: Option<Vec<[f64; 2]>>,
    /// The corners.
    pub polygon: Option<Vec<[f64; 2]>>,
    /// A random coast: the deviation of its heights, its length scale, its seed.
    pub coast: Option<CoastRecord>,
    /// The file.
    pub raster: Option<String>,
    /// From this value up the label is +1.
    pub threshold: Option<f64>,
    /// The file of polygons.
    pub geojson: Option<String>,
}

/// A coast that is drawn at random, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoastRecord {
    /// The standard deviation of its heights, metres.
    pub height: f64,
    /// The distance over which they are alike, metres.
    pub length: f64,
    /// The seed [default: 0].
    #[serde(default)]
    pub seed: u64,
}

/// The side of a place by a number that is positive on the +1 side.
pub fn side(height: f64) -> Reading {
    if height > 0.0 {
        Label::Positive.into()
    } else if height < 0.0 {
        Label::Negative.into()
    } else {
        Reading::Boundary
    }
}
