//! A robot on two wheels: two motors by PWM and a pin each, a label on a pin, and a localisation. On a chip its HAL gives
//! these; here a simulated robot does, whose left wheel is 3 % slower than it should be.
//!
//! `cargo run -p planner-core --example two_wheels`

mod field;

use std::cell::Cell;
use std::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{self, InputPin, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use field::{Result, World};
use planner_core::nalgebra::Point2;
use planner_core::robot::{Motor, PinSensor, TwoWheels, Wheels};
use planner_core::{
    Agent, Event, Goal, Heading, Label, Lookahead, Motion, Pose, Unicycle, Vehicle, VersionSpace,
};

fn main() -> Result {
    let robot = Robot::new()?;
    let motor = |side| Motor::new(Channel(&robot, side), Direction(&robot, side));
    // At 60 % it drives 0.5 m/s, and turns 2 rad/s.
    let wheels = Wheels::new(60, 500, 2_000)?;
    let locate = |_: &Motion| Ok::<_, Infallible>(robot.world.pose()); // what your localisation says
    let drive = TwoWheels::new([motor(0), motor(1)], wheels, Time(&robot), locate);
    let sensor = PinSensor::new(FloatSwitch(&robot.world), Label::Positive);

    let belief = VersionSpace::<32>::new(&field::given()?)?;
    let planner = Lookahead::new(field::area()?, Unicycle::default(), belief)?
        .until(Goal::slope_within_degrees(0.2)?);
    let mut agent = Agent::new(planner, Vehicle { drive, sensor }, field::start()?);
    while let Event::Step(step) = agent.step()? {
        println!("  read {:?}", step.reading);
    }
    field::report(agent.estimate(), 0.05)
}

/// A simulated robot: the speed that each motor is set to, from -1 to 1, and the way that it faces.
struct Robot {
    world: World,
    duty: [Cell<f64>; 2],
    forward: [Cell<bool>; 2],
}

impl Robot {
    fn new() -> Result<Self> {
        Ok(Self { world: World::new()?, duty: Default::default(), forward: Default::default() })
    }

    /// Goes on for some seconds: 0.5 m/s and 2 rad/s at a duty cycle of 60 %.
    fn go_on(&self, seconds: f64) {
        let speed = |side: usize, full: f64| {
            let way = if self.forward[side].get() { full } else { -full };
            way * self.duty[side].get() / 0.6
        };
        let [left, right] = [speed(0, 0.5 * 0.97), speed(1, 0.5)];
        let Pose { site, heading } = self.world.pose();
        let at = Point2::<f64>::from(site);
        let middle = heading.radians() + (right - left) / 0.5 * seconds / 2.0;
        let ahead = f64::midpoint(left, right) * seconds;
        let end = [at.x + ahead * middle.cos(), at.y + ahead * middle.sin()];
        let turned = heading.radians() + (right - left) / 0.5 * seconds;
        let heading = Heading::from_radians(turned).expect("an angle");
        self.world.go(Pose::at(end, heading).expect("inside the lattice"));
    }
}

/// A simulated timer: the robot moves while the program waits.
struct Time<'a>(&'a Robot);

impl DelayNs for Time<'_> {
    fn delay_ns(&mut self, ns: u32) {
        self.0.go_on(f64::from(ns) * 1e-9);
    }
}

/// A simulated PWM channel.
struct Channel<'a>(&'a Robot, usize);

impl pwm::ErrorType for Channel<'_> {
    type Error = Infallible;
}

impl SetDutyCycle for Channel<'_> {
    fn max_duty_cycle(&self) -> u16 {
        1_000
    }

    fn set_duty_cycle(&mut self, duty: u16) -> std::result::Result<(), Infallible> {
        self.0.duty[self.1].set(f64::from(duty) / 1_000.0);
        Ok(())
    }
}

/// A simulated pin of a motor's direction.
struct Direction<'a>(&'a Robot, usize);

impl digital::ErrorType for Direction<'_> {
    type Error = Infallible;
}

impl OutputPin for Direction<'_> {
    fn set_low(&mut self) -> std::result::Result<(), Infallible> {
        self.0.forward[self.1].set(false);
        Ok(())
    }

    fn set_high(&mut self) -> std::result::Result<(), Infallible> {
        self.0.forward[self.1].set(true);
        Ok(())
    }
}

/// A simulated pin of a sensor, high above the line.
struct FloatSwitch<'a>(&'a World);

impl digital::ErrorType for FloatSwitch<'_> {
    type Error = Infallible;
}

impl InputPin for FloatSwitch<'_> {
    fn is_high(&mut self) -> std::result::Result<bool, Infallible> {
        Ok(self.0.label() == Label::Positive)
    }

    fn is_low(&mut self) -> std::result::Result<bool, Infallible> {
        Ok(self.0.label() == Label::Negative)
    }
}
