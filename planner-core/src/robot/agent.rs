//! The loop that joins a planner to a body.

use crate::belief::ObservationError;
use crate::belief::evidence::Alarm;
use crate::belief::sample::Reading;
use crate::geometry::lattice::Site;
use crate::geometry::line::Line;
use crate::motion::dynamics::Pose;
use crate::planner::{Motion, Plan, Planner, StopReason};

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
    /// What has begun to speak against the model. It is there on the step that brings the evidence to a warning or to an
    /// alarm, and on no other. A follower of fronts and a [`Watched`](crate::watch::Watched) planner count evidence.
    pub alarm: Option<Alarm>,
}

/// What ended a step early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AgentError<B> {
    /// The body failed.
    Body(B),
    /// The planner did not take the sample.
    Observation(ObservationError),
}

impl<B: core::fmt::Display> core::fmt::Display for AgentError<B> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Body(error) => error.fmt(f),
            Self::Observation(refused) => refused.fmt(f),
        }
    }
}

impl<B: core::error::Error> core::error::Error for AgentError<B> {}

/// A planner with a body, at a pose.
#[derive(Clone, Debug)]
pub struct Agent<P, B> {
    /// The planner.
    pub planner: P,
    body: B,
    pose: Pose,
}

impl<P, B> Agent<P, B> {
    /// An agent that starts at a pose.
    pub const fn new(planner: P, body: B, pose: Pose) -> Self {
        Self { planner, body, pose }
    }

    /// Where the agent is.
    pub const fn pose(&self) -> Pose {
        self.pose
    }

    /// Its body.
    pub const fn body(&self) -> &B {
        &self.body
    }

    /// Its body, for work on it between two steps.
    pub const fn body_mut(&mut self) -> &mut B {
        &mut self.body
    }

    /// Takes it apart: its planner, its body, and where it is. [`new`](Self::new) puts it together again.
    pub fn into_parts(self) -> (P, B, Pose) {
        (self.planner, self.body, self.pose)
    }

    /// Says where the agent is, as after a drive that failed: the mission goes on from there.
    pub const fn relocate(&mut self, pose: Pose) {
        self.pose = pose;
    }
}

impl<P: Planner, B> Agent<P, B> {
    /// The best estimate of the line so far, see [`Planner::estimate`].
    pub fn estimate(&self) -> Option<Line> {
        self.planner.estimate()
    }

    /// What speaks against the model, if it is much, of a planner that [keeps watch](Planner::alarm). A label that was
    /// refused counts too, of which there is no [`Step`].
    pub fn alarm(&self) -> Option<Alarm> {
        self.planner.alarm()
    }
}

/// A planner that hears labels on the way, until it refuses one.
pub(crate) struct Hearing<'a, P> {
    planner: &'a mut P,
    pub(crate) refused: Option<ObservationError>,
}

impl<'a, P: Planner> Hearing<'a, P> {
    pub(crate) const fn of(planner: &'a mut P) -> Self {
        Self { planner, refused: None }
    }

    pub(crate) fn hear(&mut self, site: Site, reading: Reading) {
        if self.refused.is_none() {
            self.refused = self.planner.observe_on_the_way(site, reading).err();
        }
    }
}

/// The parts of a step, for bodies of either kind.
impl<P: Planner, B> Agent<P, B> {
    pub(super) fn next_motion(&mut self) -> Result<Motion, StopReason> {
        match self.planner.plan(self.pose) {
            Plan::Move(motion) => Ok(motion),
            Plan::Stop(reason) => Err(reason),
        }
    }

    pub(super) const fn parts(&mut self) -> (Hearing<'_, P>, &mut B, &mut Pose) {
        let Self { planner, body, pose } = self;
        (Hearing::of(planner), body, pose)
    }

    pub(super) fn take_in<E>(
        &mut self,
        motion: Motion,
        reading: Option<Reading>,
        before: Option<Alarm>,
    ) -> Result<Event, AgentError<E>> {
        self.planner.observe(self.pose, reading).map_err(AgentError::Observation)?;
        let alarm = Alarm::risen(before, self.planner.alarm());
        Ok(Event::Step(Step { motion, pose: self.pose, reading, alarm }))
    }
}
