//! How far and how long: what may be told, and what is the same for all vehicles.

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

/// How long it may not say where it is.
pub(crate) const LOST: Duration = Duration::from_secs(2);

/// How long a vehicle that someone else drives is listened to: why comes after its mode.
pub(crate) const LISTEN: Duration = Duration::from_secs(1);

/// How long before a failure a text may tell of it.
pub(crate) const TOLD_BEFORE: Duration = Duration::from_secs(2);

/// How long all must be there before a flight begins: a heartbeat that is late may say that it was otherwise before.
pub(crate) const STEADY: Duration = Duration::from_secs(1);

/// Metres a second below which it is at rest.
pub(crate) const SLOW: f64 = 0.15;

/// How long it must have been at rest, by its own clock.
pub(crate) const SETTLED_MS: u32 = 500;

/// How long it must have been at rest near where it was sent to have ended its motion there, by its own clock. So long it
/// must have stayed, too, where it never rests: in a current or in waves.
pub(crate) const RESIGNED_MS: u32 = 5000;

/// How far from a place near its target a vehicle may be that stays there though it never rests, metres.
pub(crate) const WOBBLES: f64 = 0.5;

/// How far from where it was sent that is at most, metres.
pub(crate) const NEAR: f64 = 3.0;

/// How far it must have come then, metres, or half its way: one that never moved is stuck.
pub(crate) const LEAST_WAY: f64 = 0.5;

/// How far and how long.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// How far from where it was sent it may come to rest, metres.
    pub acceptance: f64,
    /// How far its local position may be off, metres.
    pub tolerance: f64,
    /// How long it may not be ready.
    pub ready: Duration,
    /// How long a motion may take.
    pub motion: Duration,
    /// How long a label may take.
    pub label: Duration,
}
