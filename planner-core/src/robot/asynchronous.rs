//! Traits for asynchronous drivers. The robot awaits its motors and its sensor, so other tasks can run on the chip
//! meanwhile.
//!
//! Planning does no input or output, so there is one planner for both kinds of drivers. The traits are those of
//! [`robot`](super) with `async` before each method, as embedded-hal-async has the traits of embedded-hal. The crate
//! needs no particular executor. The futures need not be `Send`, so use an executor that stays on its thread, such as
//! embassy's.
//!
//! [`ThresholdSensor`] and [`PinSensor`] are sensors here as well. A threshold then measures by an `async` closure:
//!
//! ```
//! use planner_core::robot::asynchronous::LabelSensor as _;
//! use planner_core::{Label, Reading, ThresholdSensor};
//!
//! # struct Converter;
//! # impl Converter {
//! #     async fn convert(&mut self) -> Result<u16, &'static str> { Ok(530) }
//! # }
//! # let mut converter = Converter;
//! # pollster::block_on(async {
//! let measure = async || converter.convert().await.map(i32::from);
//! let mut sensor = ThresholdSensor::new(measure, 450..=520, Label::Positive);
//! assert_eq!(sensor.read().await?, Reading::Side(Label::Positive));
//! # Ok::<(), &str>(())
//! # })?;
//! # Ok::<(), &str>(())
//! ```
//!
//! A step that is dropped before its end leaves the planner as it was, but for labels on the way that it has already
//! taken in. It leaves the robot wherever it has come: stop it,
//! and tell the agent where it is ([`relocate`](Agent::relocate)).

#![expect(async_fn_in_trait, reason = "executors on chips run futures where they are made")]

use core::fmt::Debug;

use embedded_hal::digital::InputPin;

use crate::belief::sample::Reading;
use crate::geometry::lattice::Site;
use crate::motion::dynamics::Pose;
use crate::planner::{Motion, Planner};
use crate::robot::agent::{Agent, AgentError, Event};
use crate::robot::drivers::{Vehicle, VehicleError, drivers};
use crate::robot::hal::{self, PinSensor};
use crate::robot::threshold::ThresholdSensor;

drivers! {
    [async] [.await] [impl AsyncFnMut(Site)]
    /// As [`step`](Agent::step), with a body that is awaited.
    ///
    /// # Errors
    /// As there.
    step_async
}

/// The level of a pin is there at once, so nothing is awaited.
impl<P: InputPin> LabelSensor for PinSensor<P> {
    type Error = P::Error;

    async fn read(&mut self) -> Result<Reading, P::Error> {
        hal::LabelSensor::read(self)
    }
}

/// A read that is dropped before its end leaves the label that was read last.
impl<F: AsyncFnMut() -> Result<i32, E>, E: Debug> LabelSensor for ThresholdSensor<F> {
    type Error = E;

    async fn read(&mut self) -> Result<Reading, E> {
        let value = (self.measure)().await?;
        Ok(self.judge(value).into())
    }
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;
    use core::convert::Infallible;
    use core::future;
    use core::pin::pin;
    use core::task::{Context, Poll, Waker};

    use nalgebra::Point2;

    use super::*;
    use crate::belief::Belief as _;
    use crate::belief::sample::{Label, Sample};
    use crate::belief::true_labels::VersionSpace;
    use crate::geometry::area::Area;
    use crate::geometry::heading::Heading;
    use crate::motion::unicycle::Unicycle;
    use crate::planner::cfc::Cfc;
    use crate::planner::lookahead::Lookahead;
    use crate::planner::watched::Watched;

    const STEPS: usize = 24;

    fn label(site: Site) -> Label {
        let at = Point2::<f64>::from(site);
        if at.y > 0.41 * at.x + 3.5 { Label::Positive } else { Label::Negative }
    }

    fn start() -> Pose {
        Pose::at([2.0, 1.0], Heading(0)).unwrap()
    }

    fn area() -> Area {
        Area::metres([0.0, 0.0], [20.0, 20.0]).unwrap()
    }

    fn known() -> VersionSpace<32> {
        let given = [[2.0, 1.0], [2.0, 8.0], [18.0, 16.0], [18.0, 5.0]];
        let given = given.map(|place| Site::metres(place).unwrap());
        VersionSpace::new(&given.map(|site| Sample { site, label: label(site) })).unwrap()
    }

    /// A robot with drivers of either kind; while it is stuck, those that are awaited never end.
    #[derive(Clone, Copy)]
    struct Robot<'a> {
        at: &'a Cell<Pose>,
        stuck: &'a Cell<Option<Driver>>,
        senses: fn(Site) -> Label,
    }

    #[derive(Clone, Copy, PartialEq)]
    enum Driver {
        Drive,
        Sensor,
    }

    impl hal::Drive for Robot<'_> {
        type Error = Infallible;

        fn drive(&mut self, motion: &Motion) -> Result<Pose, Infallible> {
            self.at.set(motion.target);
            Ok(motion.target)
        }
    }

    impl hal::LabelSensor for Robot<'_> {
        type Error = Infallible;

        fn read(&mut self) -> Result<Reading, Infallible> {
            Ok((self.senses)(self.at.get().site).into())
        }
    }

    impl Robot<'_> {
        /// Ends when it is asked for the second time.
        async fn wait_for(self, driver: Driver) {
            if self.stuck.get() == Some(driver) {
                future::pending::<()>().await;
            }
            let mut is_asked_again = false;
            future::poll_fn(|context| {
                if core::mem::replace(&mut is_asked_again, true) {
                    return Poll::Ready(());
                }
                context.waker().wake_by_ref();
                Poll::Pending
            })
            .await;
        }
    }

    impl Drive for Robot<'_> {
        type Error = Infallible;

        async fn drive(&mut self, motion: &Motion) -> Result<Pose, Infallible> {
            self.wait_for(Driver::Drive).await;
            hal::Drive::drive(self, motion)
        }
    }

    impl LabelSensor for Robot<'_> {
        type Error = Infallible;

        async fn read(&mut self) -> Result<Reading, Infallible> {
            self.wait_for(Driver::Sensor).await;
            hal::LabelSensor::read(self)
        }
    }

    /// What a future comes to that is asked so many times at most, and then dropped.
    fn asked<F: Future>(times: usize, future: F) -> Option<F::Output> {
        let mut future = pin!(future);
        let mut context = Context::from_waker(Waker::noop());
        (0..times).find_map(|_| match future.as_mut().poll(&mut context) {
            Poll::Ready(end) => Some(end),
            Poll::Pending => None,
        })
    }

    /// A step that is asked three times, which is enough for one whose drivers end.
    fn step(agent: &mut Agent<impl Planner, impl Body<Error: Debug>>) -> Option<Event> {
        asked(3, agent.step_async()).map(Result::unwrap)
    }

    /// Called and awaited drivers make the same motions and readings. So they do if two of three steps were dropped
    /// before, on the way or while they sensed.
    ///
    /// How many of its steps tell of an alarm.
    fn missions_are_the_same(planner: impl Planner + Clone, senses: fn(Site) -> Label) -> usize {
        let [here, there] = [Cell::new(start()), Cell::new(start())];
        let (stuck, free) = (Cell::new(None), Cell::new(None));
        let robot = |at, stuck| {
            let robot = Robot { at, stuck, senses };
            Vehicle { drive: robot, sensor: robot }
        };
        let mut called = Agent::new(planner.clone(), robot(&here, &free), start());
        let mut awaited = Agent::new(planner, robot(&there, &stuck), start());
        let mut alarms = 0;
        for number in 0..STEPS {
            let before = awaited.pose();
            let sticks = [None, Some(Driver::Drive), Some(Driver::Sensor)][number % 3];
            stuck.set(sticks);
            let cut = step(&mut awaited);
            let is_cut = cut.is_none();
            let event = cut.or_else(|| {
                let has_come = if sticks == Some(Driver::Drive) { before } else { there.get() };
                assert_eq!(awaited.pose(), has_come);
                awaited.relocate(before);
                stuck.set(None);
                step(&mut awaited)
            });
            let [expected, event] = [called.step().ok(), event].map(|event| match event {
                Some(Event::Step(it)) => (it.motion.target, it.pose, it.reading, it.alarm),
                other => panic!("step {number}: {other:?}"),
            });
            assert_eq!(event, expected, "step {number}");
            // Where no label is wanted none is read.
            let wants = [false, true, event.2.is_some()];
            assert_eq!(is_cut, wants[number % 3], "step {number}");
            alarms += usize::from(event.3.is_some());
        }
        alarms
    }

    /// A robot whose drivers of either kind report two places on the way of each motion.
    #[derive(Clone, Copy)]
    struct Reporting<'a>(Robot<'a>);

    impl Reporting<'_> {
        fn places(self, motion: &Motion) -> [Site; 2] {
            let from = self.0.at.get().site;
            let way = motion.target.site - from;
            [3, 2].map(|part| {
                let by = crate::geometry::lattice::Vector { x: way.x / part, z: way.z / part };
                from.step(by).unwrap()
            })
        }

        fn go(self, site: Site) {
            self.0.at.set(Pose { site, ..self.0.at.get() });
        }
    }

    impl hal::Drive for Reporting<'_> {
        type Error = Infallible;

        fn drive(&mut self, motion: &Motion) -> Result<Pose, Infallible> {
            hal::Drive::drive(&mut self.0, motion)
        }

        fn drive_reporting(
            &mut self,
            motion: &Motion,
            report: &mut dyn FnMut(Site),
        ) -> Result<Pose, Infallible> {
            for site in self.places(motion) {
                self.go(site);
                report(site);
            }
            hal::Drive::drive(&mut self.0, motion)
        }
    }

    impl Drive for Reporting<'_> {
        type Error = Infallible;

        async fn drive(&mut self, motion: &Motion) -> Result<Pose, Infallible> {
            Drive::drive(&mut self.0, motion).await
        }

        async fn drive_reporting(
            &mut self,
            motion: &Motion,
            report: &mut impl AsyncFnMut(Site),
        ) -> Result<Pose, Infallible> {
            for site in self.places(motion) {
                self.go(site);
                report(site).await;
            }
            Drive::drive(&mut self.0, motion).await
        }
    }

    #[test]
    fn readings_on_the_way_are_taken_in_whether_they_are_called_or_awaited() {
        let [here, there, other] = [Cell::new(start()), Cell::new(start()), Cell::new(start())];
        let free = Cell::new(None);
        let robot = |at| Robot { at, stuck: &free, senses: label };
        let reporting = |at| Vehicle { drive: Reporting(robot(at)), sensor: robot(at) };
        let silent = Vehicle { drive: robot(&other), sensor: robot(&other) };
        let planner = Lookahead::new(area(), Unicycle::paper(), known()).unwrap();
        let mut called = Agent::new(planner.clone(), reporting(&here), start());
        let mut awaited = Agent::new(planner.clone(), reporting(&there), start());
        let mut without = Agent::new(planner, silent, start());
        for _ in 0..8 {
            let event = called.step().unwrap();
            assert_eq!(asked(20, awaited.step_async()), Some(Ok(event)));
            without.step().unwrap();
        }
        let samples = |it: &Lookahead<Unicycle, VersionSpace<32>>| it.belief().samples().to_vec();
        assert_eq!(samples(&called.planner), samples(&awaited.planner));
        let [more, fewer] = [&called.planner, &without.planner].map(|it| it.belief().information());
        assert!(more > 1.2 * fewer, "{more} bits, {fewer} without");
    }

    #[test]
    fn a_reading_on_the_way_that_is_refused_is_reported_after_the_motion() {
        let [at, free] = [Cell::new(start()), Cell::new(start())];
        let (stuck, senses) = (Cell::new(None), |_| Label::Positive);
        let robot = |at| Robot { at, stuck: &stuck, senses };
        let vehicle = |at| Vehicle { drive: Reporting(robot(at)), sensor: robot(at) };
        // Below the line all is certain, as it was there.
        let given = [
            Sample::at([0.0, 9.0], Label::Negative).unwrap(),
            Sample::at([20.0, 9.0], Label::Negative).unwrap(),
            Sample::at([10.0, 20.0], Label::Positive).unwrap(),
        ];
        let planner = || {
            let space = VersionSpace::<32>::new(&given).unwrap();
            Cfc::new(area(), Unicycle::paper(), space).unwrap()
        };
        let mut called = Agent::new(planner(), vehicle(&at), start());
        let refused = called.step();
        assert!(matches!(refused, Err(AgentError::Observation(_))), "{refused:?}");
        assert_eq!(called.pose(), at.get());
        assert_ne!(called.pose(), start());
        let mut awaited = Agent::new(planner(), vehicle(&free), start());
        assert_eq!(asked(20, awaited.step_async()), Some(refused));
    }

    #[test]
    fn a_threshold_reads_the_same_whether_it_is_called_or_awaited() {
        let (at, stuck) = (Cell::new(start()), Cell::new(None));
        let robot = Robot { at: &at, stuck: &stuck, senses: label };
        let values = [9, 15, 10, 20, 21, 15, i32::MIN, 15, i32::MAX];
        for above in [Label::Positive, Label::Negative] {
            for first in 0..values.len() {
                let (mut one, mut other) = (values[first..].iter(), values[first..].iter());
                let measure = || one.next().copied().ok_or("no conversion");
                let mut called = ThresholdSensor::new(measure, 10..=20, above);
                let measure = async || {
                    robot.wait_for(Driver::Sensor).await;
                    other.next().copied().ok_or("no conversion")
                };
                let mut sensor = ThresholdSensor::new(measure, 10..=20, above);
                for _ in 0..=values.len() {
                    // One that is dropped before its end measures nothing, and leaves the label as it was.
                    stuck.set(Some(Driver::Sensor));
                    assert_eq!(asked(3, sensor.read()), None);
                    stuck.set(None);
                    assert_eq!(asked(3, sensor.read()), Some(hal::LabelSensor::read(&mut called)));
                }
            }
        }
    }

    #[test]
    fn a_mission_is_the_same_with_drivers_that_are_awaited() {
        let planner = Lookahead::new(area(), Unicycle::paper(), known()).unwrap();
        assert_eq!(missions_are_the_same(planner, label), 0);
        let planner = Cfc::new(area(), Unicycle::paper(), known()).unwrap();
        assert_eq!(missions_are_the_same(planner.clone(), label), 0);
        // A sensor that is stuck: nobody is told of it who does not watch, and whoever does is told.
        let stuck = |_| Label::Positive;
        assert_eq!(missions_are_the_same(planner.clone(), stuck), 0);
        assert_eq!(missions_are_the_same(Watched::new(planner), stuck), 1);
    }
}
