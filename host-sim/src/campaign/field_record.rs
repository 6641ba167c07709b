//! A standard field as a row, for whoever measures another planner on the same fields.

use nalgebra::Point2;
use serde::Serialize;

use crate::mission::definition::Mission;

/// The oracle's points, the robot's start, and the line to find. Lengths in metres, the heading in radians; the robot
/// starts at the first of the oracle's points. The true line is `a x + b z + c = 0`, positive where labels are 1.
#[derive(Clone, Debug, Serialize)]
pub struct FieldRecord {
    field: u64,
    heading: f64,
    x1: f64,
    z1: f64,
    label1: i8,
    x2: f64,
    z2: f64,
    label2: i8,
    x3: f64,
    z3: f64,
    label3: i8,
    x4: f64,
    z4: f64,
    label4: i8,
    a: f64,
    b: f64,
    c: f64,
}

impl FieldRecord {
    /// The field with this number, of a mission in it; `None` if that is no standard field.
    pub fn of(field: u64, mission: &Mission) -> Option<Self> {
        let [a, b, c] = mission.world.line()?.coefficients();
        let &[one, two, three, four] = mission.given.samples() else { return None };
        let [one, two, three, four] = [one, two, three, four]
            .map(|sample| (Point2::<f64>::from(sample.site), sample.label.sign()));
        Some(Self {
            field,
            heading: mission.start.heading.radians(),
            x1: one.0.x,
            z1: one.0.y,
            label1: one.1,
            x2: two.0.x,
            z2: two.0.y,
            label2: two.1,
            x3: three.0.x,
            z3: three.0.y,
            label3: three.1,
            x4: four.0.x,
            z4: four.0.y,
            label4: four.1,
            a,
            b,
            c,
        })
    }
}
