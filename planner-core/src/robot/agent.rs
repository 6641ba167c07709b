//! The loop that joins planner, sensor and drive.

use crate::belief::sample::Reading;
use crate::belief::version_space::Refused;
use crate::motion::dynamics::Pose;
use crate::planner::{Motion, Plan, Planner, StopReason};
use crate::robot::hal::{Drive, LabelSensor};

/// What one step came to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// A motion was made.
    Step(Step),
    /// The planner has no further motion; nothing moved.
    Stopped(StopReason),
}

/// A motion that was made and what came of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Step {
    /// What was planned.
    pub motion: Motion,
    /// Where it ended.
    pub pose: Pose,
    /// What was sensed there, if a sample was taken.
    pub reading: Option<Reading>,
}

/// What ended a step early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AgentError<S, D> {
    /// The sensor failed, after the motion.
    Sensor(S),
    /// The drive failed.
    Drive(D),
    /// The planner did not take the sample.
    Refused(Refused),
}

impl<S: core::fmt::Debug, D: core::fmt::Debug> core::fmt::Display for AgentError<S, D> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Sensor(error) => write!(f, "the sensor failed: {error:?}"),
            Self::Drive(error) => write!(f, "the drive failed: {error:?}"),
            Self::Refused(refused) => refused.fmt(f),
        }
    }
}

impl<S: core::fmt::Debug, D: core::fmt::Debug> core::error::Error for AgentError<S, D> {}

/// A planner with a sensor and a drive, at a pose.
#[derive(Clone, Debug)]
pub struct Agent<P, S, D> {
    /// The planner.
    pub planner: P,
    sensor: S,
    drive: D,
    pose: Pose,
}

impl<P: Planner, S: LabelSensor, D: Drive> Agent<P, S, D> {
    /// An agent that starts at a pose.
    pub const fn new(planner: P, sensor: S, drive: D, pose: Pose) -> Self {
        Self { planner, sensor, drive, pose }
    }

    /// Where the agent is.
    pub const fn pose(&self) -> Pose {
        self.pose
    }

    /// Plans one motion, makes it, and senses at its end.
    ///
    /// # Errors
    /// [`AgentError`]. The pose is that of the last motion whose end is known.
    pub fn step(&mut self) -> Result<Event, AgentError<S::Error, D::Error>> {
        let motion = match self.planner.plan(self.pose) {
            Plan::Move(motion) => motion,
            Plan::Stop(reason) => return Ok(Event::Stopped(reason)),
        };
        let pose = self.drive.drive(&motion).map_err(AgentError::Drive)?;
        self.pose = pose;
        let reading = if motion.samples() {
            Some(self.sensor.read().map_err(AgentError::Sensor)?)
        } else {
            None
        };
        self.planner.observe(pose, reading).map_err(AgentError::Refused)?;
        Ok(Event::Step(Step { motion, pose, reading }))
    }
}
