//! A straight boundary that moves.

use nalgebra::{Point2, Vector2};
use planner_core::Line;

use crate::world::boundary::BoundaryRecord;

/// A line that moves along its normal and turns about a place with every motion of the robot.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    /// Where it is at the start.
    pub start: Line,
    /// Metres a motion, to its +1 side.
    pub offset: f64,
    /// Degrees a motion, counter-clockwise.
    pub turn: f64,
    /// What it turns about.
    pub about: Point2<f64>,
}

impl Moving {
    /// The line after so many motions. A turn about the place keeps its distance from the line, so that neither the
    /// order of turns and offsets counts, nor rounding adds up.
    ///
    /// # Panics
    /// Never: a turned normal has a length.
    pub fn after(&self, motions: u32) -> Line {
        if motions == 0 {
            return self.start;
        }
        let [a, b, _] = self.start.coefficients();
        let motions = f64::from(motions);
        let (sin, cos) = libm::sincos((self.turn * motions).to_radians());
        let normal = Vector2::new(cos * a - sin * b, sin * a + cos * b);
        let distance = self.start.distance(self.about) - self.offset * motions;
        Line::through(self.about - normal * distance, normal).expect("a unit normal")
    }

    /// What it is, for the trace.
    pub fn record(&self) -> BoundaryRecord {
        BoundaryRecord {
            line: Some(self.start.coefficients()),
            drift: Some([self.offset, self.turn]),
            ..BoundaryRecord::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Step by step as the contract has it: first along the normal, then about the middle.
    #[test]
    fn a_line_moves_as_it_does_step_by_step() {
        let about = Point2::new(10.0, 8.0);
        for (start, offset, turn) in [
            (Line::from_slope(0.41, 3.5).unwrap(), 0.05, 0.0),
            (Line::from_slope(0.41, 3.5).unwrap(), -0.2, 1.5),
            (Line::from_coefficients(-2.0, 0.0, 14.0).unwrap(), 0.0, -7.0),
        ] {
            let moving = Moving { start, offset, turn, about };
            let [mut a, mut b, mut c] = start.coefficients();
            for motions in 0..60 {
                let line = moving.after(motions);
                for at in [[0.0, 0.0], [20.0, 3.0], [7.0, 19.0]].map(Point2::from) {
                    let slow = a * at.x + b * at.y + c;
                    assert!((line.distance(at) - slow).abs() < 1e-9, "{motions} at {at}");
                }
                c -= offset;
                let (sin, cos) = turn.to_radians().sin_cos();
                let through = a * about.x + b * about.y + c;
                (a, b) = (cos * a - sin * b, sin * a + cos * b);
                c = through - a * about.x - b * about.y;
            }
        }
        let up =
            Moving { start: Line::from_slope(0.0, 3.0).unwrap(), offset: 0.5, turn: 0.0, about };
        assert!((up.after(4).intercept().unwrap() - 5.0).abs() < 1e-12, "to the +1 side");
        let left = Moving { turn: 10.0, offset: 0.0, ..up };
        assert!((left.after(2).angle_deg() - 20.0).abs() < 1e-9, "counter-clockwise");
    }
}
