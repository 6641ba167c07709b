//! An answer: the next motion, and what is known.

use nalgebra::Point2;
use planner_core::Motion;
use serde::Serialize;

use crate::mission::lake::Lake;
use crate::mission::next::state::State;
use crate::mission::results::{End, EstimateRecords, StepResult, stage_name};

/// What is to be done, and what is known.
#[derive(Serialize)]
pub(super) struct Answer<'a> {
    /// The motion to make next; null at the end.
    pub(super) next: Option<Next>,
    /// What its label is expected to be: the `chance` of 1, and the `bits` that it tells on average; null if none is wanted.
    pub(super) why: Option<Why>,
    /// The reason why the mission has ended, as in the trace; null before.
    pub(super) stop: Option<&'static str>,
    /// What is known: `bits`; `slope_arcs`, degrees; `intercept`, metres; and the `estimates` of the line.
    pub(super) known: Known,
    /// The step that was just made, as the trace has it; null before the first.
    pub(super) step: Option<&'a StepResult>,
    /// The end, as the trace has it; null before.
    pub(super) end: Option<&'a End>,
    /// For the next request; `host-sim next` always prints it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) state: Option<&'a State>,
    /// Of an area from a map: where the metres of `known`, `step` and `end` begin, in the map's coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) origin: Option<[f64; 2]>,
}

/// A motion: where it ends, and how to come there.
#[derive(Serialize)]
pub(super) struct Next {
    /// Where it ends, `x` and `z` or `lat` and `lon`, as the request has them.
    #[serde(flatten)]
    pub(super) at: At,
    /// The heading there, radians.
    pub(super) heading: f64,
    /// Radians to turn: on the spot before the drive, or along the arc of a car.
    pub(super) turn: f32,
    /// Metres to drive.
    pub(super) drive: f32,
    /// Whether a label is wanted there.
    pub(super) label: bool,
    /// What the motion is for, as in the trace: `seek`, `follow`, `audit`, `P1` and so on; null of an ordinary one.
    pub(super) problem: Option<&'static str>,
    /// Its number among the vehicle's motions. A robot need not know it.
    pub(super) index: u32,
}

/// In the coordinates of the request.
#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum At {
    Metres { x: f64, z: f64 },
    Degrees { lat: f64, lon: f64 },
}

#[derive(Serialize)]
pub(super) struct Why {
    pub(super) chance: f64,
    pub(super) bits: f64,
}

#[derive(Serialize)]
pub(super) struct Known {
    pub(super) bits: f64,
    pub(super) slope_arcs: Vec<[f64; 2]>,
    pub(super) intercept: Option<[f64; 2]>,
    pub(super) estimates: EstimateRecords,
}

impl Next {
    pub(super) fn of(motion: &Motion, lake: Option<&Lake>) -> Self {
        let at = Point2::<f64>::from(motion.target.site);
        let at = match lake {
            None => At::Metres { x: at.x, z: at.y },
            Some(lake) => {
                let [first, second] = lake.frame.exactly(at);
                if lake.frame.is_geographic() {
                    At::Degrees { lat: first, lon: second }
                } else {
                    At::Metres { x: first, z: second }
                }
            }
        };
        Self {
            at,
            heading: motion.target.heading.radians(),
            turn: motion.control.turn_rad,
            drive: motion.control.distance_m,
            label: motion.wants_label,
            problem: motion.stage.map(stage_name),
            index: motion.action.0,
        }
    }
}
