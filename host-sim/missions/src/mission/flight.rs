//! A mission as it is flown in the simulated world.

use std::convert::Infallible;

use planner_core::error::ObservationError;
use planner_core::robot::{AgentError, Body};
use planner_core::{Agent, Event, Motion, Planner as _, Pose, Reading, Site, Step};

use crate::mission::definition::Mission;
use crate::mission::read_out::ReadOut;
use crate::mission::results::Ending;
use crate::world::on_the_way::Way;
use crate::world::robot::{Glimpse, Robot};

/// What a step's watcher sees beside the step.
#[derive(Clone, Copy, Debug)]
pub struct Sight<'a> {
    /// Where the robot truly is, if it errs.
    pub true_pose: Option<Pose>,
    /// What was read on the way, and where the robot said it was.
    pub passed: &'a [(Site, Reading)],
}

/// A robot that reads on the way, and what it has read on its last motion.
struct Passing<'a> {
    robot: &'a mut dyn Robot,
    way: Way,
    passed: Vec<(Site, Reading)>,
}

impl Body for Passing<'_> {
    type Error = Infallible;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, Infallible> {
        self.perform_reading(motion, pose, &mut |_, _| ())
    }

    fn perform_reading(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        tell: &mut dyn FnMut(Site, Reading),
    ) -> Result<Option<Reading>, Infallible> {
        self.passed.clear();
        Ok(self.robot.travel(
            motion,
            pose,
            self.way,
            &mut |Glimpse { reported, reading, .. }| {
                if let Some(reading) = reading {
                    self.passed.push((reported, reading));
                    tell(reported, reading);
                }
            },
        ))
    }
}

/// A mission that was flown.
pub struct Flown {
    /// Why it ended.
    pub ending: Ending,
    /// What is known in the end.
    pub belief: Box<dyn ReadOut>,
}

impl Mission {
    /// Flies it; `watch` sees every step and what is known after it.
    ///
    /// # Errors
    /// [`ObservationError`] when a sample contradicts what is known.
    pub fn fly(
        &self,
        mut watch: impl FnMut(&Step, &dyn ReadOut),
    ) -> Result<Flown, ObservationError> {
        let (flown, refused) = self.fly_in_sight(|step, _, belief| watch(step, belief));
        refused.map_or(Ok(flown), Err)
    }

    /// Flies it as far as no sample contradicts what is known, and returns the one that does. `watch` also sees what the
    /// belief does not say.
    pub fn fly_in_sight(
        &self,
        mut watch: impl FnMut(&Step, Sight<'_>, &dyn ReadOut),
    ) -> (Flown, Option<ObservationError>) {
        let mut planner = self.planner();
        let mut robot = self.robot();
        let robot = Passing { robot: &mut *robot, way: self.way(), passed: Vec::new() };
        let mut agent = Agent::new(&mut *planner, robot, self.start);
        let (mut ending, mut refused) = (Ending::Steps, None);
        let mut labels = 0;
        for _ in 0..self.steps {
            if self.asking.is_enough(labels) {
                ending = Ending::Labels;
                break;
            }
            match agent.step() {
                Ok(Event::Step(step)) => {
                    labels += u32::from(step.reading.is_some());
                    let Passing { robot, passed, .. } = agent.body();
                    let sight = Sight { true_pose: robot.true_pose(), passed };
                    watch(&step, sight, agent.planner.belief());
                }
                Ok(Event::Stopped(reason)) => {
                    ending = Ending::Stopped(reason);
                    break;
                }
                Err(AgentError::Observation(why)) => {
                    (ending, refused) = (Ending::BrokenOff, Some(why));
                    break;
                }
                Err(AgentError::Body(never)) => match never {},
            }
        }
        (Flown { ending, belief: agent.planner.belief().boxed() }, refused)
    }
}
