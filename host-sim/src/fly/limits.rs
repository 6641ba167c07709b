//! Distances and times: those that flags set, and those that are the same for all vehicles.

use std::time::Duration;

/// From one of our heartbeats to the next.
pub(crate) const HEARTBEAT: Duration = Duration::from_secs(1);

/// From one setpoint to the next, to a vehicle that does not stir: one may be lost.
pub(crate) const SETPOINT: Duration = Duration::from_secs(1);

/// From one setpoint to the next, to a vehicle that moves: `ArduPilot` begins a leg anew with each.
pub(crate) const AGAIN: Duration = Duration::from_secs(10);

/// Metres within which a vehicle does not stir.
pub(crate) const STIRS: f64 = 0.1;

/// From one stop that names a place to the next.
pub(crate) const HOLD: Duration = Duration::from_millis(500);

/// From one stop to the next.
pub(crate) const STOP: Duration = Duration::from_millis(200);

/// How long stops are sent at least: longer than a message may be under way.
pub(crate) const LEAST_STOP: Duration = Duration::from_secs(2);

/// How long they are sent to a vehicle that does not say that it is at rest.
pub(crate) const MOST_STOP: Duration = Duration::from_secs(5);

/// How long a vehicle may be silent: `ArduPilot`'s heart beats once a second.
pub(crate) const SILENCE: Duration = Duration::from_secs(5);

/// How long it may send no position.
pub(crate) const LOST: Duration = Duration::from_secs(2);

/// How long a vehicle is listened to after someone else has taken it over. The reason arrives after the mode.
pub(crate) const LISTEN: Duration = Duration::from_secs(1);

/// How long before a failure a warning may still belong to it.
pub(crate) const TOLD_BEFORE: Duration = Duration::from_secs(2);

/// How long all must be ready before a flight begins. A late heartbeat may show that it was not.
pub(crate) const STEADY: Duration = Duration::from_secs(1);

/// Metres a second below which it is at rest.
pub(crate) const SLOW: f64 = 0.15;

/// How long it must have been at rest, by its own clock.
pub(crate) const SETTLED_MS: u32 = 500;

/// How long it must have been at rest near its target to have ended its motion there, by its own clock. In a current or
/// in waves it never rests; then it must have stayed for as long.
pub(crate) const RESIGNED_MS: u32 = 5000;

/// How far a vehicle that never rests may move and still count as staying at a place, metres.
pub(crate) const WOBBLES: f64 = 0.5;

/// How far from its target such a place may be, metres.
pub(crate) const NEAR: f64 = 3.0;

/// How far it must have moved by then, metres, or half its way. A vehicle that never moved is stuck.
pub(crate) const LEAST_WAY: f64 = 0.5;

/// The distances and times of a flight, from its flags and its scenario.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// How far from its target the vehicle may come to rest, metres.
    pub acceptance: f64,
    /// How far its local position may be off, metres.
    pub tolerance: f64,
    /// How long to wait until it is ready.
    pub ready: Duration,
    /// How long a motion may take.
    pub motion: Duration,
    /// How long a label may take.
    pub label: Duration,
}
