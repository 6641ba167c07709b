//! What a planner moves: a drive and a sensor, or a body that makes motions and senses at their ends.

/// The traits of drivers, a [`Vehicle`] of these as a body, and an agent's step with a body. The arguments are what differs
/// for drivers that are awaited: `async`, `.await`, and what is called where a label is to be read.
macro_rules! drivers {
    ([$($async:tt)?] [$($await:tt)*] [$($report:tt)*] $(#[$about:meta])* $step:ident) => {
        /// Senses on which side of the boundary the vehicle stands.
        pub trait LabelSensor {
            /// What can go wrong.
            type Error: core::fmt::Debug;

            /// The reading at the present position.
            ///
            /// # Errors
            /// The sensor's own.
            $($async)? fn read(&mut self) -> Result<Reading, Self::Error>;
        }

        impl<T: LabelSensor + ?Sized> LabelSensor for &mut T {
            type Error = T::Error;

            $($async)? fn read(&mut self) -> Result<Reading, Self::Error> {
                T::read(self)$($await)*
            }
        }

        /// Moves the vehicle.
        pub trait Drive {
            /// What can go wrong.
            type Error: core::fmt::Debug;

            /// Makes a motion and returns the pose that was reached: the motion's target for an ideal
            /// vehicle, what localisation says for a real one.
            ///
            /// # Errors
            /// The drive's own.
            $($async)? fn drive(&mut self, motion: &Motion) -> Result<Pose, Self::Error>;

            /// As [`drive`](Self::drive), for a vehicle whose labels are to be read on the way as well. It calls `report` at
            /// each place where a label is to be read, and the label is read before that ends. Places spread evenly tell the
            /// most. The motion's end is none of them.
            ///
            /// A drive without this method reports none, which costs nothing.
            ///
            /// # Errors
            /// As `drive`.
            #[inline]
            $($async)? fn drive_reporting(
                &mut self,
                motion: &Motion,
                _report: &mut $($report)*,
            ) -> Result<Pose, Self::Error> {
                self.drive(motion)$($await)*
            }
        }

        impl<T: Drive + ?Sized> Drive for &mut T {
            type Error = T::Error;

            $($async)? fn drive(&mut self, motion: &Motion) -> Result<Pose, Self::Error> {
                T::drive(self, motion)$($await)*
            }

            #[inline]
            $($async)? fn drive_reporting(
                &mut self,
                motion: &Motion,
                report: &mut $($report)*,
            ) -> Result<Pose, Self::Error> {
                T::drive_reporting(self, motion, report)$($await)*
            }
        }

        /// Makes motions, and senses where they end.
        ///
        /// A [`Vehicle`] is one, of a [`Drive`] and a [`LabelSensor`].
        pub trait Body {
            /// What can go wrong.
            type Error;

            /// Makes a motion from `pose`, which becomes where it ended, and returns what was sensed there if
            /// the motion wants a label.
            ///
            /// # Errors
            /// The body's own; `pose` is then where it is as far as it is known.
            $($async)? fn perform(
                &mut self,
                motion: &Motion,
                pose: &mut Pose,
            ) -> Result<Option<Reading>, Self::Error>;

            /// As [`perform`](Self::perform), for a body that also reads labels on the way. It passes each to `tell` at
            /// once, with the place where it was read.
            ///
            /// A body without this method reads none, which costs nothing.
            ///
            /// # Errors
            /// As `perform`.
            #[inline]
            $($async)? fn perform_reading(
                &mut self,
                motion: &Motion,
                pose: &mut Pose,
                _tell: &mut dyn FnMut(Site, Reading),
            ) -> Result<Option<Reading>, Self::Error> {
                self.perform(motion, pose)$($await)*
            }
        }

        impl<T: Body + ?Sized> Body for &mut T {
            type Error = T::Error;

            $($async)? fn perform(
                &mut self,
                motion: &Motion,
                pose: &mut Pose,
            ) -> Result<Option<Reading>, T::Error> {
                T::perform(self, motion, pose)$($await)*
            }

            #[inline]
            $($async)? fn perform_reading(
                &mut self,
                motion: &Motion,
                pose: &mut Pose,
                tell: &mut dyn FnMut(Site, Reading),
            ) -> Result<Option<Reading>, T::Error> {
                T::perform_reading(self, motion, pose, tell)$($await)*
            }
        }

        impl<D: Drive, S: LabelSensor> Body for Vehicle<D, S> {
            type Error = VehicleError<D::Error, S::Error>;

            $($async)? fn perform(
                &mut self,
                motion: &Motion,
                pose: &mut Pose,
            ) -> Result<Option<Reading>, Self::Error> {
                *pose = self.drive.drive(motion)$($await)*.map_err(VehicleError::Drive)?;
                read_at_end(&mut self.sensor, motion)$($await)*.map_err(VehicleError::Sensor)
            }

            /// Reads a label wherever the drive [reports](Drive::drive_reporting) that it is.
            #[inline]
            $($async)? fn perform_reading(
                &mut self,
                motion: &Motion,
                pose: &mut Pose,
                tell: &mut dyn FnMut(Site, Reading),
            ) -> Result<Option<Reading>, Self::Error> {
                let Self { drive, sensor } = self;
                let mut read = Ok(());
                let mut report = $($async)? |site| {
                    if read.is_ok() {
                        read = sensor.read()$($await)*.map(|reading| tell(site, reading));
                    }
                };
                let end = drive.drive_reporting(motion, &mut report)$($await)*;
                *pose = end.map_err(VehicleError::Drive)?;
                read.map_err(VehicleError::Sensor)?;
                read_at_end(sensor, motion)$($await)*.map_err(VehicleError::Sensor)
            }
        }

        $($async)? fn read_at_end<S: LabelSensor>(
            sensor: &mut S,
            motion: &Motion,
        ) -> Result<Option<Reading>, S::Error> {
            if motion.wants_label { sensor.read()$($await)*.map(Some) } else { Ok(None) }
        }

        impl<P: Planner, B: Body> Agent<P, B> {
            $(#[$about])*
            pub $($async)? fn $step(&mut self) -> Result<Event, AgentError<B::Error>> {
                let motion = match self.next_motion() {
                    Ok(motion) => motion,
                    Err(reason) => return Ok(Event::Stopped(reason)),
                };
                let before = self.planner.alarm();
                let (mut hear, body, pose) = self.parts();
                let mut tell = |site, reading| hear.hear(site, reading);
                let reading = body.perform_reading(&motion, pose, &mut tell)$($await)*;
                let reading = reading.map_err(AgentError::Body)?;
                hear.refused.map_or(Ok(()), Err).map_err(AgentError::Observation)?;
                self.take_in(motion, reading, before)
            }
        }
    };
}

pub(super) use drivers;

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
