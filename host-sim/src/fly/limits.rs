//! How far and how long: what may be told, and what is the same for all vehicles.

use std::time::Duration;

/// From one of our heartbeats to the next.
pub(crate) const HEARTBEAT: Duration = Duration::from_secs(1);

/// From one setpoint to the next, until it is there: one may be lost, and `ArduPilot` begins a leg anew with each.
pub(crate) const SETPOINT: Duration = Duration::from_secs(1);

/// From one stop to the next.
pub(crate) const STOP: Duration = Duration::from_millis(200);

/// How long stops are sent at least: longer than a message may be under way.
pub(crate) const LEAST_STOP: Duration = Duration::from_secs(2);

/// How long they are sent to a vehicle that does not say that it is at rest.
pub(crate) const MOST_STOP: Duration = Duration::from_secs(5);

/// How long a vehicle may be silent: `ArduPilot`'s heart beats once a second.
pub(crate) const SILENCE: Duration = Duration::from_secs(5);

/// How long it may not say where it is.
pub(crate) const LOST: Duration = Duration::from_secs(2);

/// How long all must be there before a flight begins: a heartbeat that is late may say that it was otherwise before.
pub(crate) const STEADY: Duration = Duration::from_secs(1);

/// Metres a second below which it is at rest.
pub(crate) const SLOW: f64 = 0.15;

/// How long it must have been at rest, by its own clock.
pub(crate) const SETTLED_MS: u32 = 500;

/// How far and how long.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// How far from where it was sent it may come to rest, metres.
    pub acceptance: f64,
    /// How long it may not be ready.
    pub ready: Duration,
    /// How long a motion may take.
    pub motion: Duration,
    /// How long a label may take.
    pub label: Duration,
}
