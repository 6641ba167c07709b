//! The seam to hardware: a sensor that reads labels and a drive that makes motions, in the shape of
//! embedded-hal 1.0: an associated `Error`, one required method, an impl for `&mut T`.

use core::convert::Infallible;

use embedded_hal::digital::InputPin;

use crate::belief::sample::{Label, Reading};
use crate::geometry::lattice::Site;
use crate::motion::dynamics::Pose;
use crate::planner::Motion;

/// Senses on which side of the boundary the vehicle stands.
pub trait LabelSensor {
    /// What can go wrong.
    type Error: core::fmt::Debug;

    /// The reading at the present position.
    ///
    /// # Errors
    /// The sensor's own.
    fn read(&mut self) -> Result<Reading, Self::Error>;
}

impl<T: LabelSensor + ?Sized> LabelSensor for &mut T {
    type Error = T::Error;

    fn read(&mut self) -> Result<Reading, Self::Error> {
        T::read(self)
    }
}

/// No sensor: a place for one that stays empty.
impl LabelSensor for Infallible {
    type Error = Self;

    fn read(&mut self) -> Result<Reading, Self> {
        match *self {}
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
    fn drive(&mut self, motion: &Motion) -> Result<Pose, Self::Error>;

    /// As [`drive`](Self::drive), for a vehicle whose labels are to be read on the way as well. It calls `report` at each
    /// place where a label is to be read, and the label is read before `report` returns. Places spread evenly tell the
    /// most. The motion's end is none of them.
    ///
    /// A drive without this method reports none, which costs nothing.
    ///
    /// # Errors
    /// As `drive`.
    #[inline]
    fn drive_reporting(
        &mut self,
        motion: &Motion,
        _report: &mut dyn FnMut(Site),
    ) -> Result<Pose, Self::Error> {
        self.drive(motion)
    }
}

impl<T: Drive + ?Sized> Drive for &mut T {
    type Error = T::Error;

    fn drive(&mut self, motion: &Motion) -> Result<Pose, Self::Error> {
        T::drive(self, motion)
    }

    #[inline]
    fn drive_reporting(
        &mut self,
        motion: &Motion,
        report: &mut dyn FnMut(Site),
    ) -> Result<Pose, Self::Error> {
        T::drive_reporting(self, motion, report)
    }
}

/// A drive that is a function: it makes a motion and returns where it ended.
#[derive(Clone, Copy, Debug)]
pub struct DriveFn<F>(pub F);

impl<F: FnMut(&Motion) -> Result<Pose, E>, E: core::fmt::Debug> Drive for DriveFn<F> {
    type Error = E;

    fn drive(&mut self, motion: &Motion) -> Result<Pose, E> {
        (self.0)(motion)
    }
}

/// A label sensor that is a function.
#[derive(Clone, Copy, Debug)]
pub struct SensorFn<F>(pub F);

impl<F: FnMut() -> Result<R, E>, R: Into<Reading>, E: core::fmt::Debug> LabelSensor
    for SensorFn<F>
{
    type Error = E;

    fn read(&mut self) -> Result<Reading, E> {
        (self.0)().map(Into::into)
    }
}

/// A label sensor on a digital pin, such as a comparator behind a photodiode or a float switch. It serves [drivers that
/// are awaited](crate::robot::asynchronous) as well.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PinSensor<P> {
    pin: P,
    high: Label,
}

impl<P: InputPin> PinSensor<P> {
    /// A sensor that reads the label `high` while the pin is high, and the other while it is low.
    pub const fn new(pin: P, high: Label) -> Self {
        Self { pin, high }
    }

    /// Gives the pin back.
    pub fn release(self) -> P {
        self.pin
    }
}

impl<P: InputPin> LabelSensor for PinSensor<P> {
    type Error = P::Error;

    fn read(&mut self) -> Result<Reading, Self::Error> {
        let label = if self.pin.is_high()? { self.high } else { -self.high };
        Ok(label.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Wire(Result<bool, ()>);

    #[derive(Debug)]
    struct Broken;

    impl embedded_hal::digital::Error for Broken {
        fn kind(&self) -> embedded_hal::digital::ErrorKind {
            embedded_hal::digital::ErrorKind::Other
        }
    }

    impl embedded_hal::digital::ErrorType for Wire {
        type Error = Broken;
    }

    impl InputPin for Wire {
        fn is_high(&mut self) -> Result<bool, Broken> {
            self.0.map_err(|()| Broken)
        }

        fn is_low(&mut self) -> Result<bool, Broken> {
            self.is_high().map(|high| !high)
        }
    }

    #[test]
    fn a_pin_reads_as_a_label_either_way_round() {
        for (level, high, label) in [
            (true, Label::Positive, Label::Positive),
            (false, Label::Positive, Label::Negative),
            (true, Label::Negative, Label::Negative),
            (false, Label::Negative, Label::Positive),
        ] {
            let mut sensor = PinSensor::new(Wire(Ok(level)), high);
            let read = |mut sensor: &mut PinSensor<Wire>| LabelSensor::read(&mut sensor);
            assert_eq!(read(&mut sensor).unwrap(), Reading::Side(label));
        }
        assert!(PinSensor::new(Wire(Err(())), Label::Positive).read().is_err());
    }
}
