//! A mission as it is flown in the simulated world.

use planner_core::error::ObservationError;
use planner_core::robot::AgentError;
use planner_core::{Agent, Event, Planner as _, Pose, Step};

use crate::mission::definition::Mission;
use crate::mission::read_out::ReadOut;
use crate::mission::results::Ending;

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

    /// Flies it as far as no sample contradicts what is known, and returns the one that does. `watch` also sees where
    /// the robot truly is, if it errs.
    pub fn fly_in_sight(
        &self,
        mut watch: impl FnMut(&Step, Option<Pose>, &dyn ReadOut),
    ) -> (Flown, Option<ObservationError>) {
        let mut planner = self.planner();
        let mut robot = self.robot();
        let mut agent = Agent::new(&mut *planner, &mut *robot, self.start);
        let (mut ending, mut refused) = (Ending::Steps, None);
        let mut labels = 0;
        for _ in 0..self.steps {
            if self.asking.labels.is_some_and(|most| labels >= most) {
                ending = Ending::Labels;
                break;
            }
            match agent.step() {
                Ok(Event::Step(step)) => {
                    labels += u32::from(step.reading.is_some());
                    watch(&step, agent.body().true_pose(), agent.planner.belief());
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
