//! A standard field as a row, for whoever measures another planner on the same fields.

use nalgebra::Point2;
use planner_core::Sample;
use serde::Serialize;

use crate::mission::definition::Mission;

/// The columns: the oracle's points, the robot's start, and the line to find. Lengths in metres, the heading in radians;
/// the robot starts at the first of the oracle's points. The true line is `a x + b z + c = 0`, positive where labels
/// are 1.
pub const COLUMNS: &str =
    "field,heading,x1,z1,label1,x2,z2,label2,x3,z3,label3,x4,z4,label4,a,b,c\n";

/// The field with this number, of a mission in it; `None` if that is no standard field.
pub fn row(field: u64, mission: &Mission) -> Option<impl Serialize + use<>> {
    let line = mission.world.line()?.coefficients();
    let given: [Sample; 4] = mission.given.samples().try_into().ok()?;
    let point = |sample: Sample| {
        let at = Point2::<f64>::from(sample.site);
        (at.x, at.y, sample.label.sign())
    };
    Some((field, mission.start.heading.radians(), given.map(point), line))
}
