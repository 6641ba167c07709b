//! A line in a trace, and how far it is from the truth.

use planner_core::Line;
use serde::{Deserialize, Serialize};

/// A line; slope and intercept are `None` for a vertical one.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct LineRecord {
    /// `z = slope x + intercept`: the paper's `rho`; `None` of a vertical line.
    pub slope: Option<f64>,
    /// The paper's `c`, metres; `None` of a vertical line.
    pub intercept: Option<f64>,
    /// Degrees within [-90, 90].
    pub angle: f64,
    /// `a x + b z + c = 0` with `a^2 + b^2 = 1`.
    #[serde(skip)]
    pub coefficients: [f64; 3],
    /// Beside the truth, if there is one.
    #[serde(skip)]
    pub error: Option<LineError>,
}

/// How far an estimate is from the true line.
#[derive(Clone, Copy, Debug)]
pub struct LineError {
    /// Between the two, degrees.
    pub degrees: f64,
    /// The share of the area that gets the wrong label.
    pub misclassified: f64,
}

impl From<Line> for LineRecord {
    fn from(line: Line) -> Self {
        Self {
            slope: line.slope(),
            intercept: line.intercept(),
            angle: line.angle_deg(),
            coefficients: line.coefficients(),
            error: None,
        }
    }
}
