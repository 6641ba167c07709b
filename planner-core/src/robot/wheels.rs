//! A robot on two wheels, each with a motor: a [`Drive`] by embedded-hal's PWM, pins and delay.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;

use crate::geometry::value::ValueError;
use crate::motion::dynamics::Pose;
use crate::planner::Motion;
use crate::robot::hal::Drive;

/// A motor behind a bridge with one input for the speed and one for the direction.
///
/// A bridge such as the L298N has two inputs for the direction. Give an [`OutputPin`] that sets one high and the other low.
#[derive(Clone, Debug)]
pub struct Motor<P, D> {
    speed: P,
    forward: D,
}

impl<P: SetDutyCycle, D: OutputPin> Motor<P, D> {
    /// A motor of a PWM channel, and of a pin that is high while it turns forward.
    pub const fn new(speed: P, forward: D) -> Self {
        Self { speed, forward }
    }

    /// Gives the channel and the pin back.
    pub fn release(self) -> (P, D) {
        (self.speed, self.forward)
    }

    fn face<E>(&mut self, forward: bool) -> Result<(), WheelsError<E>> {
        self.forward.set_state(forward.into()).map_err(|_| WheelsError::Pin)
    }

    fn run<E>(&mut self, percent: u8) -> Result<(), WheelsError<E>> {
        self.speed.set_duty_cycle_percent(percent).map_err(|_| WheelsError::Pwm)
    }
}

/// How fast a robot on two wheels goes. Measure both speeds on the ground, at the duty cycle that you choose.
///
/// ```
/// use planner_core::robot::Wheels;
///
/// // At 60 % it goes 2.5 m in 10 s, and turns round once in 4 s.
/// let wheels = Wheels::new(60, 250, 1_571)?;
/// # Ok::<(), planner_core::error::ValueError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Wheels {
    percent: u8,
    mm_per_s: u32,
    mrad_per_s: u32,
}

impl Wheels {
    /// `percent` is the duty cycle while the motors run, 1 to 100. `mm_per_s` is the speed straight on, and `mrad_per_s` that of
    /// a turn on the spot, with the wheels against each other.
    ///
    /// # Errors
    /// [`ValueError`] if `percent` is above 100, or any of the three is zero.
    pub const fn new(percent: u8, mm_per_s: u32, mrad_per_s: u32) -> Result<Self, ValueError> {
        if percent == 0 || percent > 100 {
            return Err(ValueError("a duty cycle is 1 to 100 percent"));
        }
        if mm_per_s == 0 || mrad_per_s == 0 {
            return Err(ValueError("the speeds of a robot on wheels are above zero"));
        }
        Ok(Self { percent, mm_per_s, mrad_per_s })
    }
}

/// A drive of two wheels, for the motions of a [`Unicycle`](crate::Unicycle): it turns on the spot, then drives straight.
///
/// Each motion is timed by the measured [speeds](Wheels), and `drive` waits until the motors have stopped. So feed a watchdog
/// in the delay. Then `locate` says where the robot stands. Without localisation return the target: `|motion| Ok::<_,
/// Infallible>(motion.target)`. The error then grows with each motion. Set the belief's tolerance to the error at the end.
///
/// After an error both motors are told to stop. `examples/two_wheels.rs` is a whole program.
#[derive(Clone, Debug)]
pub struct TwoWheels<P, D, T, F> {
    /// The left one, then the right one.
    motors: [Motor<P, D>; 2],
    wheels: Wheels,
    delay: T,
    locate: F,
}

/// What went wrong with a drive of two wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WheelsError<E> {
    /// A motor's PWM channel failed.
    Pwm,
    /// A motor's pin failed.
    Pin,
    /// What locates the robot failed.
    Locate(E),
}

impl<P, D, T, F> TwoWheels<P, D, T, F> {
    /// A drive of the left motor and the right one. Both are of one type: if their channels or pins differ in type, erase them,
    /// or pass `&mut dyn SetDutyCycle<Error = E>`.
    pub const fn new(motors: [Motor<P, D>; 2], wheels: Wheels, delay: T, locate: F) -> Self {
        Self { motors, wheels, delay, locate }
    }

    /// Gives the motors back, the left one first, the delay, and what locates.
    pub fn release(self) -> ([Motor<P, D>; 2], T, F) {
        (self.motors, self.delay, self.locate)
    }
}

impl<P, D, T, F, E> TwoWheels<P, D, T, F>
where
    P: SetDutyCycle,
    D: OutputPin,
    T: DelayNs,
    F: FnMut(&Motion) -> Result<Pose, E>,
{
    /// Runs the motors, each forward or backward.
    fn run(&mut self, forward: [bool; 2], ms: f32) -> Result<(), WheelsError<E>> {
        for (motor, forward) in self.motors.iter_mut().zip(forward) {
            motor.face(forward)?;
        }
        for motor in &mut self.motors {
            motor.run(self.wheels.percent)?;
        }
        // At most the 3 km of a motion at a millimetre a second, which 32 bits hold.
        let whole = ms as u32;
        self.delay.delay_ms(whole);
        self.delay.delay_us(((ms - whole as f32) * 1e3) as u32);
        self.stop()
    }

    /// Stops both, the second one too if the first does not listen.
    fn stop(&mut self) -> Result<(), WheelsError<E>> {
        let [left, right] = &mut self.motors;
        let left = left.run(0);
        right.run(0).and(left)
    }

    fn go(&mut self, motion: &Motion) -> Result<Pose, WheelsError<E>> {
        let control = motion.control;
        let [mm, mrad] = [self.wheels.mm_per_s, self.wheels.mrad_per_s].map(|speed| speed as f32);
        let to_the_left = control.turn_rad > 0.0;
        let turn = if to_the_left { control.turn_rad } else { -control.turn_rad };
        if turn > 0.0 {
            self.run([!to_the_left, to_the_left], turn * 1e6 / mrad)?;
        }
        if control.distance_m > 0.0 {
            self.run([true; 2], control.distance_m * 1e6 / mm)?;
        }
        (self.locate)(motion).map_err(WheelsError::Locate)
    }
}

impl<P, D, T, F, E> Drive for TwoWheels<P, D, T, F>
where
    P: SetDutyCycle,
    D: OutputPin,
    T: DelayNs,
    F: FnMut(&Motion) -> Result<Pose, E>,
    E: core::fmt::Debug,
{
    type Error = WheelsError<E>;

    fn drive(&mut self, motion: &Motion) -> Result<Pose, Self::Error> {
        let end = self.go(motion);
        if end.is_err() {
            // It did not listen before, so whether it does now changes nothing that the caller is told.
            let _ = self.stop();
        }
        end
    }
}

impl<E: core::fmt::Debug> core::fmt::Display for WheelsError<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Pwm => f.write_str("a motor's PWM channel failed"),
            Self::Pin => f.write_str("a motor's pin failed"),
            Self::Locate(error) => write!(f, "the robot was not located: {error:?}"),
        }
    }
}

impl<E: core::fmt::Debug> core::error::Error for WheelsError<E> {}

#[cfg(test)]
mod tests {
    use core::cell::RefCell;
    use core::fmt::Write as _;

    use embedded_hal::{digital, pwm};

    use super::*;
    use crate::geometry::heading::Heading;
    use crate::geometry::lattice::Site;
    use crate::motion::action::{Action, Control};

    /// What motors and timer were told, in the order of it; from some word on nothing listens.
    struct Told(RefCell<Text>, usize);

    type Text = heapless::String<128>;

    impl Told {
        fn word(&self, word: core::fmt::Arguments<'_>) -> Result<(), Deaf> {
            let mut told = self.0.borrow_mut();
            write!(told, "{word} ").unwrap();
            if told.split_whitespace().count() > self.1 { Err(Deaf) } else { Ok(()) }
        }
    }

    #[derive(Debug)]
    struct Deaf;

    impl digital::Error for Deaf {
        fn kind(&self) -> digital::ErrorKind {
            digital::ErrorKind::Other
        }
    }

    impl pwm::Error for Deaf {
        fn kind(&self) -> pwm::ErrorKind {
            pwm::ErrorKind::Other
        }
    }

    struct Part<'a>(&'a Told, char);

    impl digital::ErrorType for Part<'_> {
        type Error = Deaf;
    }

    impl pwm::ErrorType for Part<'_> {
        type Error = Deaf;
    }

    impl OutputPin for Part<'_> {
        fn set_low(&mut self) -> Result<(), Deaf> {
            self.0.word(format_args!("{}-", self.1))
        }

        fn set_high(&mut self) -> Result<(), Deaf> {
            self.0.word(format_args!("{}+", self.1))
        }
    }

    impl SetDutyCycle for Part<'_> {
        fn max_duty_cycle(&self) -> u16 {
            200
        }

        fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Deaf> {
            self.0.word(format_args!("{}{duty}", self.1))
        }
    }

    impl DelayNs for Part<'_> {
        fn delay_ns(&mut self, _: u32) {
            unreachable!("longer units");
        }

        fn delay_us(&mut self, us: u32) {
            let _ = self.0.word(format_args!("{us}us"));
        }

        fn delay_ms(&mut self, ms: u32) {
            let _ = self.0.word(format_args!("{ms}ms"));
        }
    }

    /// What is told in a motion if so many words are listened to, and whether it ended well.
    fn told(turn_rad: f32, distance_m: f32, words: usize) -> (Text, Result<(), WheelsError<()>>) {
        let told = Told(RefCell::default(), words);
        let motor = |name| Motor::new(Part(&told, name), Part(&told, name));
        let wheels = Wheels::new(60, 250, 1_000).unwrap();
        let locate = |motion: &Motion| Ok::<_, ()>(motion.target);
        let mut drive = TwoWheels::new([motor('L'), motor('R')], wheels, Part(&told, 't'), locate);
        let motion = Motion {
            stage: None,
            recovery: None,
            action: Action(0),
            control: Control { distance_m, turn_rad },
            target: Pose { site: Site::new(1, 2).unwrap(), heading: Heading(3) },
            wants_label: true,
            examined: 0,
            proven: true,
        };
        let end = drive.drive(&motion).map(|pose| assert_eq!(pose, motion.target));
        let words = told.0.borrow().clone();
        (words, end)
    }

    #[test]
    fn it_turns_on_the_spot_and_then_drives_straight() {
        let straight = "L+ R+ L120 R120 2002ms 0us L0 R0 ";
        let is = |(words, end): (Text, _), expected| {
            assert_eq!((words.as_str(), end), (expected, Ok(())));
        };
        is(told(0.0, 0.5005, 99), straight);
        let both = told(0.2505, 0.5005, 99);
        let left = both.0.strip_suffix(straight).unwrap().len();
        assert_eq!(&both.0[..left], "L- R+ L120 R120 250ms 500us L0 R0 ");
        is(told(-1.0, 0.0, 99), "L+ R- L120 R120 1000ms 0us L0 R0 ");
        is(told(0.0, 0.0, 99), "");
        // The longest motion there is: 3 km at 250 mm/s.
        is(told(0.0, 3_000.0, 99), "L+ R+ L120 R120 12000000ms 0us L0 R0 ");
    }

    #[test]
    fn both_motors_are_told_to_stop_after_an_error() {
        for words in 0..8 {
            let (words_told, end) = told(0.0, 0.5, words);
            let expected = if words < 2 { WheelsError::Pin } else { WheelsError::Pwm };
            assert_eq!(end, Err(expected), "{words}: {words_told}");
            assert!(words_told.ends_with("L0 R0 "), "{words}: {words_told}");
        }
    }

    #[test]
    fn what_never_arrives_is_refused() {
        for [percent, mm, mrad] in [[0, 1, 1], [101, 1, 1], [60, 0, 1], [60, 1, 0]] {
            assert!(Wheels::new(percent as u8, mm, mrad).is_err(), "{percent} {mm} {mrad}");
        }
        assert!(Wheels::new(100, u32::MAX, u32::MAX).is_ok());
    }
}
