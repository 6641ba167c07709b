//! Motions that are known beforehand, flown and recorded as a planner's are.

use anyhow::Result;
use planner_core::dynamics::{Action, Dynamics as _};
use planner_core::{Motion, Step};

use crate::mission::baseline::motion;
use crate::mission::definition::Mission;
use crate::mission::flight::Flown;
use crate::mission::recording::{Recorder, Recording};
use crate::mission::results::Ending;

/// Makes these motions, and takes in a label after each.
///
/// # Errors
/// Names the sample that contradicts what is known.
pub fn fly(mission: &Mission, actions: &[Action]) -> Result<Recording> {
    let mut belief = mission.belief();
    let (mut robot, mut pose) = (mission.robot(), mission.start);
    let mut recorder = Recorder::new(mission.clone());
    for &action in actions {
        let Some(target) = mission.vehicle.target(pose, action) else { break };
        let motion = Motion { examined: 0, ..motion(&mission.vehicle, pose, action, target) };
        let reading = robot.perform(&motion, &mut pose);
        let seen = reading.map_or(Ok(()), |reading| belief.observe(pose.site, reading));
        seen.map_err(|refused| recorder.refusal(&refused))?;
        recorder.take(&Step { motion, pose, reading, alarm: None }, robot.true_pose(), &*belief);
    }
    Ok(recorder.end(Flown { ending: Ending::Steps, belief }))
}
