//! `front` of a scenario file: what a planner is told of a front; and the map that comes of following it.

use anyhow::Result;
use nalgebra::Point2;
use planner_core::dynamics::Dynamics as _;
use planner_core::{AnyVehicle, Area, Front, MapPlace, Waist};
use serde::{Deserialize, Serialize};

use crate::mission::algorithm::Algorithm;
use crate::mission::strict::{Table, beyond, wrong};

/// Of the tightest bend's radius, if the file does not name one: so many of the vehicle's longest motions.
const BENDS: f64 = 20.0;

/// The shortest stretch that may be watched, metres.
const SHORTEST: f64 = 0.1;

/// And the longest.
const LONGEST: f64 = 10_000.0;

/// The level of the widths that are reported.
const LEVEL: f64 = 0.9;

/// How tightly a front bends and how fast it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrontTable {
    /// `inf` if the front is straight, then null in a trace; others have no effect
    pub radius: Option<f64>,
    /// How far it may move in a step, metres [default: 0].
    #[serde(default)]
    pub speed: f64,
    /// Metres of front to watch, 0.1 to the diagonal of the area, instead of going along all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub watch: Option<f64>,
}

/// The front of a mission, as a planner of fronts is told, and the length of the stretch to watch.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub(crate) fn front(
    table: Option<&Table<FrontTable>>,
    algorithm: Algorithm,
    (vehicle, bounds): (&AnyVehicle, Area),
) -> Result<(Front, Option<f64>)> {
    if table.is_some() && algorithm.seeks_line() {
        let found = format!("with algorithm {}", algorithm.name());
        return wrong("front", found, "with algorithm track");
    }
    let FrontTable { radius, speed, watch } = table.map(|table| table.0).unwrap_or_default();
    let radius = radius.unwrap_or_else(|| usual_radius(vehicle));
    let front = if radius == f64::INFINITY { Ok(Front::STRAIGHT) } else { Front::bending(radius) };
    let front = front.or_else(|_| beyond("front.radius", radius))?;
    let front = front.moving(speed).or_else(|_| beyond("front.speed", speed))?;
    let [min, max] = [bounds.min(), bounds.max()].map(Point2::<f64>::from);
    let longest = (max - min).norm().min(LONGEST);
    match watch {
        Some(metres) if !(SHORTEST..=longest).contains(&metres) => {
            let expected = format!(
                "metres of front to watch, from {SHORTEST} to {longest:.1} (across the area)"
            );
            wrong("front.watch", metres, expected)
        }
        _ => Ok((front, watch)),
    }
}

/// The radius of the tightest bend that a planner is told if nobody names one.
fn usual_radius(vehicle: &AnyVehicle) -> f64 {
    let grid = vehicle.grid();
    let longest_mm = grid.reach_mm(grid.speeds().saturating_sub(1));
    BENDS * f64::from(longest_mm) * 1e-3
}

impl FrontTable {
    /// What a planner is told.
    pub fn told(front: Front, watch: Option<f64>) -> Self {
        Self { radius: front.radius(), speed: front.speed(), watch }
    }
}

impl From<Front> for FrontTable {
    fn from(front: Front) -> Self {
        Self::told(front, None)
    }
}

/// A vertex of the map: where the front was known best after a step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct VertexRecord {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub z: f64,
    /// The direction of the front, radians. Its +1 side is to the left.
    pub heading: f64,
    /// 1/m, positive where the front bends to the left.
    pub curvature: f32,
    /// The front lies within this across its direction with probability 0.9, metres.
    pub half_width: f64,
    /// The standard deviation of the direction, radians.
    pub turn_deviation: f32,
}

impl From<Waist> for VertexRecord {
    fn from(waist: Waist) -> Self {
        let Waist { site, heading, curvature, turn_deviation, .. } = waist;
        let at = Point2::<f64>::from(site);
        let half_width = waist.half_width(LEVEL);
        Self { x: at.x, z: at.y, heading: heading.radians(), curvature, half_width, turn_deviation }
    }
}

/// A vertex of the map, with the step after which the robot passed it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct PassedRecord {
    /// The step after which the robot passed it.
    pub passed: usize,
    /// Whether a piece of the map begins with it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub begins: bool,
    /// The vertex.
    pub vertex: VertexRecord,
}

impl PassedRecord {
    /// A place that is on the map after so many steps or rows.
    pub fn of(MapPlace { waist, age, begins }: MapPlace, step: usize) -> Self {
        let passed = step.saturating_sub(age as usize).max(1);
        Self { passed, begins, vertex: waist.into() }
    }
}

impl VertexRecord {
    /// Where it is.
    pub fn at(&self) -> Point2<f64> {
        Point2::new(self.x, self.z)
    }
}
