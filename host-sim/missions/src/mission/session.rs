//! A mission whose motions somebody else makes: what is to be done next, after all that was done so far.
//!
//! [`Mission::fly`] makes the motions of a simulated robot itself. Here the caller is told a motion, makes it, and says
//! where it ended and what was read.

use anyhow::{Result, anyhow};
use planner_core::{Motion, Plan, Pose, Reading, Site, Step};

use crate::mission::definition::Mission;
use crate::mission::flight::Flown;
use crate::mission::read_out::{AnyPlanner, ReadOut};
use crate::mission::recording::{Recorder, Recording, refusal};
use crate::mission::results::{Ending, StepResult};

/// What a motion came to, as the robot reports it.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrival {
    /// Where it ended.
    pub pose: Pose,
    /// What was read there.
    pub reading: Option<Reading>,
    /// What was read on the way, in order.
    pub passed: Vec<(Site, Reading)>,
}

/// A mission under way.
pub struct Session {
    mission: Mission,
    planner: AnyPlanner,
    recorder: Recorder,
    pose: Pose,
    labels: u32,
    /// What is to be done, once it is planned: a plan is made once for each motion.
    next: Option<Result<Motion, Ending>>,
}

impl Session {
    /// Nothing has happened yet. `samples` were read by others, beside the scenario's own points: they may be wrong as any
    /// label of the mission may.
    ///
    /// # Errors
    /// Names the sample that contradicts what is known.
    pub fn new(mission: Mission, samples: &[(Site, Reading)]) -> Result<Self> {
        let mission = mission.having_read(samples);
        let mission = mission.map_err(|(k, why)| anyhow!("samples[{k}]: {}", refusal(&why)))?;
        let (planner, pose) = (mission.planner(), mission.start);
        let recorder = Recorder::new(mission.clone());
        Ok(Self { mission, planner, recorder, pose, labels: 0, next: None })
    }

    /// The next motion, or why there is none. The same until it has been [made](Self::arrive).
    ///
    /// # Errors
    /// Why the mission has ended.
    pub fn plan(&mut self) -> Result<Motion, Ending> {
        if let Some(next) = self.next {
            return next;
        }
        let next = if self.recorder.steps().len() >= self.mission.steps as usize {
            Err(Ending::Steps)
        } else if self.mission.asking.is_enough(self.labels) {
            Err(Ending::Labels)
        } else {
            match self.planner.plan(self.pose) {
                Plan::Move(motion) => Ok(motion),
                Plan::Stop(reason) => Err(Ending::Stopped(reason)),
            }
        };
        *self.next.insert(next)
    }

    /// Takes in what the next motion came to.
    ///
    /// # Errors
    /// When the mission has ended, or what was read contradicts what is known. It is not to be gone on with then.
    pub fn arrive(&mut self, arrival: &Arrival) -> Result<()> {
        let Arrival { pose, reading, ref passed } = *arrival;
        let motion = self.plan().map_err(|why| {
            anyhow!("found a motion after the end, expected none: {}", why.name())
        })?;
        self.next = None;
        for &(site, reading) in passed {
            let heard = self.planner.observe_on_the_way(site, reading);
            heard.map_err(|why| self.recorder.refusal(&why))?;
        }
        let taken = self.planner.observe(pose, reading);
        taken.map_err(|why| self.recorder.refusal(&why))?;
        self.labels += u32::from(reading.is_some());
        self.pose = pose;
        let step = Step { motion, pose, reading, alarm: None };
        self.recorder.pass(passed);
        self.recorder.take(&step, None, self.planner.belief());
        Ok(())
    }

    /// The mission.
    pub const fn mission(&self) -> &Mission {
        &self.mission
    }

    /// What is known.
    pub fn belief(&self) -> &dyn ReadOut {
        self.planner.belief()
    }

    /// What came of the last motion.
    pub fn last(&self) -> Option<&StepResult> {
        self.recorder.last()
    }

    /// All that has happened, as a mission that ends for this reason.
    pub fn recording(&self, ending: Ending) -> Recording {
        let belief = self.planner.belief().boxed();
        self.recorder.clone().end(Flown { ending, belief })
    }
}
