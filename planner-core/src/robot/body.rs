//! What a planner moves: a body that makes motions and senses at their ends.

use crate::belief::sample::Reading;
use crate::motion::dynamics::Pose;
use crate::planner::Motion;
use crate::robot::hal::{Drive, LabelSensor};

/// Makes motions, and senses where they end.
///
/// A [`Vehicle`] is one, of a [`Drive`] and a [`LabelSensor`]; the vehicle at the other end of a link is
/// another.
pub trait Body {
    /// What can go wrong.
    type Error;

    /// Makes a motion from `pose`, which becomes where it ended, and returns what was sensed there if
    /// the motion wants a label.
    ///
    /// # Errors
    /// The body's own; `pose` is then where it is as far as it is known.
    fn perform(&mut self, motion: &Motion, pose: &mut Pose)
    -> Result<Option<Reading>, Self::Error>;
}

impl<T: Body + ?Sized> Body for &mut T {
    type Error = T::Error;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, T::Error> {
        T::perform(self, motion, pose)
    }
}

/// A drive with a label sensor.
#[derive(Clone, Debug)]
pub struct Vehicle<D, S> {
    /// What moves it.
    pub drive: D,
    /// What it senses with.
    pub sensor: S,
}

/// What went wrong with a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum VehicleError<D, S> {
    /// The drive failed.
    Drive(D),
    /// The sensor failed, after the motion.
    Sensor(S),
}

impl<D: core::fmt::Debug, S: core::fmt::Debug> core::fmt::Display for VehicleError<D, S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Drive(error) => write!(f, "the drive failed: {error:?}"),
            Self::Sensor(error) => write!(f, "the sensor failed: {error:?}"),
        }
    }
}

impl<D: core::fmt::Debug, S: core::fmt::Debug> core::error::Error for VehicleError<D, S> {}

impl<D: Drive, S: LabelSensor> Body for Vehicle<D, S> {
    type Error = VehicleError<D::Error, S::Error>;

    fn perform(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
    ) -> Result<Option<Reading>, Self::Error> {
        *pose = self.drive.drive(motion).map_err(VehicleError::Drive)?;
        if !motion.wants_label {
            return Ok(None);
        }
        self.sensor.read().map(Some).map_err(VehicleError::Sensor)
    }
}
