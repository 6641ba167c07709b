//! Numbers of a scenario file that may be meant otherwise: degrees in place of metres or radians.

use anyhow::Result;
use nalgebra::{Point2, center};
use planner_core::dynamics::Dynamics as _;
use planner_core::link::message::MissionArea;
use planner_core::{AnyVehicle, Line, Workspace as _};

use crate::mission::allowance::tidy;
use crate::mission::strict::wrong;
use crate::mission::wording::in_radians;
use crate::world::polygon::Polygon;

/// An area whose middle is further off than this many of its sides may be a map's, in degrees.
const FAR: f64 = 10.0;

/// Degrees that a mission covers, at most: a lattice is 16 km wide.
const MOST_DEGREES: f64 = 10.0;

/// A line that cuts off less than this share of an area is hardly meant.
const LITTLE: f64 = 0.1;

/// The shortest motion of a vehicle and its longest, metres.
fn motions(vehicle: &AnyVehicle) -> [f64; 2] {
    let grid = vehicle.grid();
    [1, grid.speeds().saturating_sub(1)].map(|speed| f64::from(grid.reach_mm(speed)) / 1e3)
}

/// Whether an area may be in degrees.
///
/// # Errors
/// If it cannot be in metres: no motion fits into it, or the longest does not and it lies as a map does.
pub(crate) fn of_area(area: &MissionArea, vehicle: &AnyVehicle) -> Result<Option<String>> {
    let bounds = area.bounds();
    let [min, max] = [bounds.min(), bounds.max()].map(Point2::<f64>::from);
    let size = max - min;
    let (side, middle) = (size.max(), center(&min, &max));
    let is_far = middle.coords.amax() > FAR * side && middle.coords.amax() <= 180.0;
    let [shortest, longest] = motions(vehicle);
    let found = format!("{} m x {} m", tidy(size.x), tidy(size.y));
    if side < shortest || (is_far && side < longest) {
        let expected = format!(
            "metres, with room for motions of {shortest} to {longest} m (are these degrees?)"
        );
        return wrong("area", found, expected);
    }
    let is_doubtful = side < longest || (is_far && side <= MOST_DEGREES);
    Ok(is_doubtful.then(|| format!("area: {found}; are these degrees? Lengths are in metres")))
}

/// Angles that are larger than radians usually are, by their keys.
pub(crate) fn of_angles<const N: usize>(angles: [(&str, f64, f64); N]) -> Vec<String> {
    let large = angles.into_iter().filter(|(_, radians, most)| radians.abs() > *most);
    large
        .map(|(key, it, _)| format!("{key}: {it} rad; are these degrees? {}", in_radians(it)))
        .collect()
}

/// A slope of a line that cuts off little of an area, where one of so many degrees cuts off much.
pub(crate) fn of_slope(area: &Polygon, [slope, intercept]: [f64; 2]) -> Option<String> {
    let cut = |slope: f64| {
        let above = area.clip(&Line::from_slope(slope, intercept)?, 1.0).area() / area.area();
        Some(above.min(1.0 - above))
    };
    let meant = libm::tan(slope.to_radians());
    let is_doubtful = slope.abs() <= 90.0 && cut(slope)? < LITTLE && cut(meant)? > LITTLE;
    let meant = tidy(meant);
    is_doubtful.then(|| {
        format!("truth.slope: {slope}; are these degrees? {slope} deg are a slope of {meant}")
    })
}

/// Given points that lie together more closely than a motion reaches.
pub(crate) fn of_points(points: &[[f64; 2]], vehicle: &AnyVehicle) -> Option<String> {
    let [shortest, _] = motions(vehicle);
    let extent = |axis: usize| {
        let along = points.iter().map(|at| at[axis]);
        along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
    };
    let [x, z] = [extent(0), extent(1)];
    (points.len() > 1 && x.max(z) < shortest).then(|| {
        let (x, z) = (tidy(x), tidy(z));
        format!("oracle: all points within {x} m x {z} m; are these degrees? Lengths are in metres")
    })
}
