//! Simulated robots.

use planner_core::{Motion, Pose, Reading, Site};

use crate::world::World;
use crate::world::on_the_way::Way;

/// A robot that cannot fail.
pub trait Robot {
    /// Its true pose; `None` if the pose that it reports is the true one.
    fn true_pose(&self) -> Option<Pose>;

    /// As [`Body::perform`](planner_core::robot::Body::perform), and passes on what it senses on the way, in order.
    fn travel(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        way: Way,
        pass: &mut dyn FnMut(Glimpse),
    ) -> Option<Reading>;

    /// The same without readings on the way.
    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Option<Reading> {
        self.travel(motion, pose, Way::END, &mut |_| ())
    }
}

/// What a robot senses on the way of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Glimpse {
    /// Where it reports that it is.
    pub reported: Site,
    /// Where it truly is.
    pub site: Site,
    /// What its sensor reads; `None` if nothing.
    pub reading: Option<Reading>,
}

/// A robot that reaches the target of every motion and reads the true label there.
pub struct Ideal {
    /// What it moves in.
    pub world: World,
}

impl Robot for Ideal {
    fn true_pose(&self) -> Option<Pose> {
        None
    }

    fn travel(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        way: Way,
        pass: &mut dyn FnMut(Glimpse),
    ) -> Option<Reading> {
        let from = std::mem::replace(pose, motion.target);
        self.world.advance();
        for site in way.sites(from, *pose) {
            pass(Glimpse { reported: site, site, reading: Some(self.world.reading(site)) });
        }
        motion.wants_label.then(|| self.world.reading(pose.site))
    }
}
