//! Simulated robots.

use std::convert::Infallible;

use planner_core::robot::Body;
use planner_core::{Motion, Pose, Reading};

use crate::world::World;

/// A robot that cannot fail.
pub trait Robot: Body<Error = Infallible> {
    /// Its true pose; `None` if the pose that it reports is the true one.
    fn true_pose(&self) -> Option<Pose>;
}

/// A robot that reaches the target of every motion and reads the true label there.
pub struct Ideal {
    /// What it moves in.
    pub world: World,
}

impl Body for Ideal {
    type Error = Infallible;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, Infallible> {
        *pose = motion.target;
        self.world.advance();
        Ok(motion.wants_label.then(|| self.world.reading(pose.site)))
    }
}

impl Robot for Ideal {
    fn true_pose(&self) -> Option<Pose> {
        None
    }
}
