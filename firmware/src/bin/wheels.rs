#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Planner and drive on one chip: an STM32F405 on a robot with two wheels, without a link.
//!
//! The robot begins at (2, 1) m and faces along x, in a field of 20 m x 20 m. It knows four places and their labels, finds the
//! line to 0.5 degrees, writes it to the log and stands still.
//!
//! | pin | is |
//! | --- | --- |
//! | PA6, PA7 | TIM3, 20 kHz: the speed of the left motor and of the right one |
//! | PB6, PB7 | output: the left and the right motor turn forward |
//! | PA2 | USART2, transmit: the log, 115,200 baud, 8N1 |
//! | PB0 | output: drive enable, high during the mission; wants a pull-down on the board |
//! | PB1 | input with pull-down: the label |

#[cfg(target_os = "none")]
mod robot {
    use core::convert::Infallible;

    use board::clock::Clock;
    use board::log;
    use board::reset::Reset;
    use board::stop::Enable;
    use board::watchdog::Watchdog;
    use cortex_m_rt::entry;
    use planner_core::robot::{LabelSensor, Motor, TwoWheels, Wheels};
    use planner_core::{
        Agent, Area, Event, Goal, Heading, Label, Lookahead, Motion, PinSensor, Pose, Reading,
        Sample, Site, StopReason, Unicycle, Vehicle, VersionSpace,
    };
    use stm32f4xx_hal::gpio::GpioExt;
    use stm32f4xx_hal::hal::delay::DelayNs;
    use stm32f4xx_hal::hal::digital::OutputPin;
    use stm32f4xx_hal::hal::pwm::SetDutyCycle;
    use stm32f4xx_hal::pac;
    use stm32f4xx_hal::prelude::*;
    use stm32f4xx_hal::timer::SysDelay;

    /// What is known before, and where the robot begins: measure them in your field.
    const GIVEN: [Sample; 4] = [
        given([2_000, 1_000], Label::Negative),
        given([2_000, 8_000], Label::Positive),
        given([18_000, 16_000], Label::Positive),
        given([18_000, 5_000], Label::Negative),
    ];
    const START: Pose = Pose { site: GIVEN[0].site, heading: Heading(0) };

    const fn given([x, z]: [i32; 2], label: Label) -> Sample {
        Sample { site: place(x, z), label }
    }

    /// In millimetres.
    const fn place(x: i32, z: i32) -> Site {
        match Site::millimetres(x, z) {
            Ok(site) => site,
            Err(_) => panic!("outside the lattice"),
        }
    }

    #[entry]
    fn main() -> ! {
        let taken = (cortex_m::Peripherals::take(), pac::Peripherals::take());
        let (Some(core), Some(chip)) = taken else { unreachable!("the first to take them") };
        let watchdog = Watchdog::start(chip.IWDG, &chip.DBGMCU);
        let reset = Reset::take(&chip.RCC);
        let (_, mut rcc) = Clock::start(chip.RCC, reset);
        let gpioa = chip.GPIOA.split(&mut rcc);
        let gpiob = chip.GPIOB.split(&mut rcc);
        log::open(chip.USART2, gpioa.pa2, &chip.DBGMCU, &mut rcc);

        let (_, (left, right, ..)) = chip.TIM3.pwm_hz(20.kHz(), &mut rcc);
        let [mut left, mut right] = [left.with(gpioa.pa6).erase(), right.with(gpioa.pa7).erase()];
        left.enable();
        right.enable();
        let forward =
            [gpiob.pb6.into_push_pull_output().erase(), gpiob.pb7.into_push_pull_output().erase()];
        let [left_forward, right_forward] = forward;
        let motors = [Motor::new(left, left_forward), Motor::new(right, right_forward)];
        let sensor = PinSensor::new(gpiob.pb1.into_pull_down_input(), Label::Positive);
        let mut wait = Wait { timer: core.SYST.delay(&rcc.clocks), watchdog };

        let mut enable = Enable::new(gpiob.pb0);
        enable.on();
        let end = mission(motors, sensor, &mut wait);
        enable.off();
        match end {
            Ok(reason) => defmt::info!("stopped: {}", reason),
            Err(what) => defmt::error!("{=str}", what),
        }
        loop {
            log::flush();
            wait.delay_ms(100);
        }
    }

    /// Finds the line to half a degree.
    fn mission<P: SetDutyCycle, D: OutputPin>(
        motors: [Motor<P, D>; 2],
        sensor: impl LabelSensor,
        wait: &mut Wait,
    ) -> Result<StopReason, &'static str> {
        // At 60 % it drives 0.5 m/s, and turns 2 rad/s.
        let wheels = Wheels::new(60, 500, 2_000).map_err(|refused| refused.0)?;
        // Where your localisation says that the robot stands. Without one it is where the motion leads.
        let locate = |motion: &Motion| Ok::<_, Infallible>(motion.target);
        let drive = TwoWheels::new(motors, wheels, wait, locate);

        let area = Area::new(place(0, 0), place(20_000, 20_000)).map_err(|_| "the area is none")?;
        let known = VersionSpace::<32>::new(&GIVEN).map_err(|_| "the labels contradict")?;
        let goal = Goal::slope_within_degrees(0.5).map_err(|refused| refused.0)?;
        let planner = Lookahead::new(area, Unicycle::default(), known)
            .map_err(|_| "the planner refuses what it is given")?
            .until(goal.unaudited());
        let mut agent = Agent::new(planner, Vehicle { drive, sensor }, START);
        loop {
            match agent.step().map_err(|_| "the robot failed, or a label contradicts")? {
                Event::Step(step) => defmt::info!("read {}", step.reading.map(Reading::sign)),
                Event::Stopped(reason) => {
                    defmt::info!("the line: {}", agent.estimate());
                    return Ok(reason);
                }
            }
            log::drain();
        }
    }

    /// A timer that keeps the watchdog content while it waits. The timer's own long waits overflow.
    struct Wait {
        timer: SysDelay,
        watchdog: Watchdog,
    }

    impl DelayNs for Wait {
        fn delay_ns(&mut self, ns: u32) {
            self.watchdog.feed();
            self.timer.delay_ns(ns);
        }

        fn delay_ms(&mut self, ms: u32) {
            for _ in 0..ms {
                self.delay_ns(1_000_000);
            }
        }
    }
}

/// On a host there is nothing to run: the example `two_wheels` of `planner-core` is this with a simulated robot.
#[cfg(not(target_os = "none"))]
fn main() {}
