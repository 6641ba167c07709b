//! The seam to hardware: a sensor that reads labels and a drive that makes motions, in the shape of
//! embedded-hal 1.0: an associated `Error`, one required method, an impl for `&mut T`.

use core::convert::Infallible;

use embedded_hal::digital::InputPin;

use crate::belief::sample::{Label, Reading};
use crate::geometry::lattice::Site;
use crate::motion::dynamics::Pose;
use crate::planner::{Motion, Planner};
use crate::robot::agent::{Agent, AgentError, Event};
use crate::robot::drivers::{Vehicle, VehicleError, drivers};

drivers! {
    [] [] [dyn FnMut(Site)]
    /// Plans one motion, makes it, and takes in what was sensed on its way and at its end.
    ///
    /// # Errors
    /// [`AgentError`]. The pose is that of the last motion whose end is known. A reading on the way that the planner refuses
    /// is reported when the motion has ended, and what was sensed after it is not taken in.
    step
}

/// No sensor: a place for one that stays empty.
impl LabelSensor for Infallible {
    type Error = Self;

    fn read(&mut self) -> Result<Reading, Self> {
        match *self {}
    }
}

/// A drive that is a function: it makes a motion and returns where it ended.
///
/// ```
/// use planner_core::Motion;
/// use planner_core::robot::DriveFn;
///
/// # fn command(turn_rad: f32, distance_m: f32) -> Result<(), &'static str> { Ok(()) }
/// let drive = DriveFn(|motion: &Motion| {
///     command(motion.control.turn_rad, motion.control.distance_m)?; // your motors
///     Ok::<_, &'static str>(motion.target) // or where your localisation says that it ended
/// });
/// # let _: DriveFn<_> = drive;
/// ```
#[derive(Clone, Copy, Debug)]
pub struct DriveFn<F>(pub F);

impl<F: FnMut(&Motion) -> Result<Pose, E>, E: core::fmt::Debug> Drive for DriveFn<F> {
    type Error = E;

    fn drive(&mut self, motion: &Motion) -> Result<Pose, E> {
        (self.0)(motion)
    }
}

/// A label sensor that is a function: it returns a [`Label`], or a [`Reading`].
///
/// ```
/// use planner_core::Label;
/// use planner_core::robot::SensorFn;
///
/// # fn depth() -> Result<f32, &'static str> { Ok(1.2) }
/// let sensor = SensorFn(|| Ok::<_, &'static str>(if depth()? > 2.0 { Label::Positive } else { Label::Negative }));
/// ```
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
