//! The same seam for drivers that are asynchronous: a robot that awaits its motors and its sensor, so that whatever
//! else runs on the chip runs meanwhile.
//!
//! Planning does no input or output, so there is one planner for both. The traits are those of [`hal`](super::hal)
//! and [`body`](super::body) with `async` before each method, as those of embedded-hal-async are to those of
//! embedded-hal. No executor is asked for; futures are not required to be `Send`, so it takes one that stays on
//! its thread, such as embassy's.
//!
//! A step that is dropped before its end leaves the planner as it was and the robot wherever it has come: stop it,
//! and tell the agent where it is ([`relocate`](Agent::relocate)).

#![expect(async_fn_in_trait, reason = "executors on chips run futures where they are made")]

use core::fmt::Debug;

use crate::belief::sample::Reading;
use crate::motion::dynamics::Pose;
use crate::planner::{Motion, Planner};
use crate::robot::agent::{Agent, AgentError, Event};
use crate::robot::body::{Vehicle, VehicleError};

/// Senses on which side of the boundary the vehicle stands.
pub trait LabelSensor {
    /// What can go wrong.
    type Error: Debug;

    /// The reading at the present position.
    ///
    /// # Errors
    /// The sensor's own.
    async fn read(&mut self) -> Result<Reading, Self::Error>;
}

impl<T: LabelSensor + ?Sized> LabelSensor for &mut T {
    type Error = T::Error;

    async fn read(&mut self) -> Result<Reading, Self::Error> {
        T::read(self).await
    }
}

/// Moves the vehicle.
pub trait Drive {
    /// What can go wrong.
    type Error: Debug;

    /// Makes a motion and returns the pose that was reached.
    ///
    /// # Errors
    /// The drive's own.
    async fn drive(&mut self, motion: &Motion) -> Result<Pose, Self::Error>;
}

impl<T: Drive + ?Sized> Drive for &mut T {
    type Error = T::Error;

    async fn drive(&mut self, motion: &Motion) -> Result<Pose, Self::Error> {
        T::drive(self, motion).await
    }
}

/// Makes motions, and senses where they end.
pub trait Body {
    /// What can go wrong.
    type Error;

    /// Makes a motion from `pose`, which becomes where it ended, and returns what was sensed there if
    /// the motion wants a label.
    ///
    /// # Errors
    /// The body's own; `pose` is then where it is as far as it is known.
    async fn perform(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
    ) -> Result<Option<Reading>, Self::Error>;
}

impl<T: Body + ?Sized> Body for &mut T {
    type Error = T::Error;

    async fn perform(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
    ) -> Result<Option<Reading>, T::Error> {
        T::perform(self, motion, pose).await
    }
}

impl<D: Drive, S: LabelSensor> Body for Vehicle<D, S> {
    type Error = VehicleError<D::Error, S::Error>;

    async fn perform(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
    ) -> Result<Option<Reading>, Self::Error> {
        *pose = self.drive.drive(motion).await.map_err(VehicleError::Drive)?;
        if !motion.wants_label {
            return Ok(None);
        }
        self.sensor.read().await.map(Some).map_err(VehicleError::Sensor)
    }
}

impl<P: Planner, B: Body> Agent<P, B> {
    /// As [`step`](Agent::step), with a body that is awaited.
    ///
    /// # Errors
    /// As there.
    pub async fn step_async(&mut self) -> Result<Event, AgentError<B::Error>> {
        let motion = match self.next_motion() {
            Ok(motion) => motion,
            Err(reason) => return Ok(Event::Stopped(reason)),
        };
        let (body, pose) = self.body_and_pose();
        let reading = body.perform(&motion, pose).await.map_err(AgentError::Body)?;
        self.take_in(motion, reading)
    }
}
