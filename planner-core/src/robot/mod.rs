//! The robot itself: what you implement, and the loop that joins it to a planner.
//!
//! Implement [`Drive`] and [`LabelSensor`] and put them into a [`Vehicle`]. Functions can serve as both ([`DriveFn`],
//! [`SensorFn`]), and [`TwoWheels`] drives two motors by embedded-hal. Or implement [`Body`] as a whole. An [`Agent`] joins the body to a planner. [`asynchronous`] is the
//! same for drivers that are awaited.

mod agent;
pub mod asynchronous;
mod drivers;
mod hal;
mod threshold;
mod wheels;

#[cfg(feature = "link")]
pub(crate) use agent::Hearing;
pub use agent::{Agent, AgentError, Event, Step};
pub use drivers::{Vehicle, VehicleError};
pub use hal::{Body, Drive, DriveFn, LabelSensor, PinSensor, SensorFn};
pub use threshold::ThresholdSensor;
pub use wheels::{Motor, TwoWheels, Wheels, WheelsError};
