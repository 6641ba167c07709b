//! What a planner moves: a body that makes motions and senses at their ends.

use crate::belief::sample::Reading;
use crate::geometry::lattice::Site;
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

    /// As [`perform`](Self::perform), for a body that also reads labels on the way. It passes each to `tell` at once, with
    /// the place where it was read.
    ///
    /// A body without this method reads none, which costs nothing.
    ///
    /// # Errors
    /// As `perform`.
    #[inline]
    fn perform_reading(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        _tell: &mut dyn FnMut(Site, Reading),
    ) -> Result<Option<Reading>, Self::Error> {
        self.perform(motion, pose)
    }
}

impl<T: Body + ?Sized> Body for &mut T {
    type Error = T::Error;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, T::Error> {
        T::perform(self, motion, pose)
    }

    #[inline]
    fn perform_reading(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        tell: &mut dyn FnMut(Site, Reading),
    ) -> Result<Option<Reading>, T::Error> {
        T::perform_reading(self, motion, pose, tell)
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
    /// The sensor failed, after the motion or on its way.
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
        self.read_at_end(motion)
    }

    /// Reads a label wherever the drive [reports](Drive::drive_reporting) that it is.
    #[inline]
    fn perform_reading(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        tell: &mut dyn FnMut(Site, Reading),
    ) -> Result<Option<Reading>, Self::Error> {
        let Self { drive, sensor } = self;
        let mut read = Ok(());
        let mut report = |site| {
            if read.is_ok() {
                read = sensor.read().map(|reading| tell(site, reading));
            }
        };
        *pose = drive.drive_reporting(motion, &mut report).map_err(VehicleError::Drive)?;
        read.map_err(VehicleError::Sensor)?;
        self.read_at_end(motion)
    }
}

impl<D: Drive, S: LabelSensor> Vehicle<D, S> {
    fn read_at_end(
        &mut self,
        motion: &Motion,
    ) -> Result<Option<Reading>, VehicleError<D::Error, S::Error>> {
        if !motion.wants_label {
            return Ok(None);
        }
        self.sensor.read().map(Some).map_err(VehicleError::Sensor)
    }
}
