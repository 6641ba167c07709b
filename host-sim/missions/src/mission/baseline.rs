//! What planners to compare with have in common.

use planner_core::dynamics::{Action, Dynamics};
use planner_core::error::ObservationError;
use planner_core::{Belief, Motion, Pose, Reading, Tolerance};

/// A motion that asks for a label and poses no problem.
pub fn motion(dynamics: &impl Dynamics, pose: Pose, action: Action, target: Pose) -> Motion {
    Motion {
        stage: None,
        recovery: None,
        action,
        control: dynamics.control(pose, action),
        target,
        wants_label: true,
        examined: 1,
        proven: true,
    }
}

/// Takes in a reading, if there is one.
pub(super) fn take_in(
    belief: &mut impl Belief,
    pose: Pose,
    reading: Option<Reading>,
    tolerance: Tolerance,
) -> Result<(), ObservationError> {
    reading.map_or(Ok(()), |reading| belief.observe_within(pose.site, reading, tolerance))
}
