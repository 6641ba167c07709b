//! Drivers that are awaited: a drive that waits for its motors by embedded-hal-async's delay, a threshold on what a
//! converter measures behind its I2C bus. Any executor runs it: here one that blocks, on a chip embassy's.
//!
//! `cargo run -p planner-core --example asynchronous`

mod field;

use std::convert::Infallible;

use embedded_hal_async::delay::DelayNs;
use embedded_hal_async::i2c::{ErrorType, I2c, Operation};
use field::{Result, World};
use planner_core::robot::asynchronous::Drive;
use planner_core::{
    Agent, Event, Label, Lookahead, Motion, Pose, ThresholdSensor, Unicycle, Vehicle, VersionSpace,
};

/// Your drive: generic over the delay, as drivers are over their peripherals.
struct Tracks<'a, D>(&'a World, D);

impl<D: DelayNs> Drive for Tracks<'_, D> {
    type Error = Infallible;

    async fn drive(&mut self, motion: &Motion) -> std::result::Result<Pose, Infallible> {
        self.0.go(motion.target); // starts the motors,
        self.1.delay_ms((motion.control.distance_m * 2_000.0) as u32).await; // which come half a metre a second
        Ok(self.0.pose())
    }
}

/// Your converter on an I2C bus: a concentration in its first register, parts per billion.
async fn measure(bus: &mut impl I2c<Error = Infallible>) -> std::result::Result<i32, Infallible> {
    let mut register = [0; 2];
    bus.write_read(0x48, &[0], &mut register).await?;
    Ok(u16::from_be_bytes(register).into())
}

fn main() -> Result {
    let world = World::new()?;
    let space = VersionSpace::<24>::new(&field::given()?)?;
    let planner = Lookahead::new(field::area()?, Unicycle::paper(), space)?;
    let mut bus = Bus(&world);
    let sensor = ThresholdSensor::new(async || measure(&mut bus).await, 500..=500, Label::Positive);
    let vehicle = Vehicle { drive: Tracks(&world, NoTime), sensor };
    let mut agent = Agent::new(planner, vehicle, field::start()?);
    pollster::block_on(async {
        while let Event::Step(step) = agent.step_async().await? {
            println!("{:?}", step.reading);
        }
        field::report(agent.estimate(), 0.05)
    })
}

/// A simulated delay.
struct NoTime;

impl DelayNs for NoTime {
    async fn delay_ns(&mut self, _: u32) {}
}

/// A simulated bus.
struct Bus<'a>(&'a World);

impl ErrorType for Bus<'_> {
    type Error = Infallible;
}

impl I2c for Bus<'_> {
    async fn transaction(
        &mut self,
        _: u8,
        operations: &mut [Operation<'_>],
    ) -> std::result::Result<(), Infallible> {
        let value = (500.0 + 100.0 * self.0.height()).max(0.0) as u16;
        for operation in operations {
            if let Operation::Read(bytes) = operation {
                bytes.copy_from_slice(&value.to_be_bytes());
            }
        }
        Ok(())
    }
}
