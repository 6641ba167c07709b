//! The stages of a flight. [`pilot`](crate::fly::pilot) draws what leads from one to the next.

use std::time::Duration;

use planner_core::Label;

use crate::fly::frame::Ned;
use crate::fly::label::Told;
use crate::fly::limits::{RESIGNED_MS, SLOW};
use crate::fly::orders::Order;
use crate::fly::vehicle::Fix;

/// A motion's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Where it is.
    pub fix: Fix,
    /// Which way it faces.
    pub yaw: f32,
    /// What it sensed.
    pub label: Option<Label>,
    /// Whether it rests near where it was sent, not there.
    pub is_short: bool,
}

/// A motion that is to be made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub order: Order,
    pub wants_label: bool,
    /// Where the vehicle was when it was ordered.
    pub from: Ned,
    pub began: Duration,
    pub sent: Option<Sent>,
}

/// When a setpoint was sent, and when the vehicle last stirred since, and how it was then.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sent {
    pub at: Duration,
    pub stirred: Duration,
    pub place: Ned,
    pub yaw: f32,
}

/// The place for a vehicle to stay at, if velocities of zero do not stop it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hold {
    pub at: Ned,
    pub yaw: f32,
}

/// How a vehicle rests where it was sent, or near that. Times are by its clock, milliseconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rest {
    /// It has stayed there since then.
    pub since: u32,
    /// Where it was then.
    pub place: Ned,
    /// It has been slow since then.
    pub slow: Option<u32>,
}

impl Rest {
    /// How it rests by another position, if it may move by this much and still stay where it is.
    pub(crate) fn by(before: Option<Self>, fix: Fix, most: f64) -> Self {
        let (since, place) = (fix.at_ms, fix.at);
        let mut rest = before.unwrap_or(Self { since, place, slow: None });
        if place.distance(rest.place) > most {
            rest = Self { since, place, ..rest };
        }
        rest.slow = rest.slow.or(Some(since)).filter(|_| fix.speed() <= SLOW);
        rest
    }

    /// Whether it has been slow for this long, milliseconds.
    pub(crate) fn is_calm(&self, fix: Fix, settles: u32) -> bool {
        self.slow.is_some_and(|slow| fix.at_ms - slow >= settles)
    }

    /// Whether it has stayed for so long that it counts as at rest, though it never is.
    pub(crate) const fn is_long(&self, fix: Fix) -> bool {
        fix.at_ms - self.since >= RESIGNED_MS
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Stage {
    /// Since when it waits, and since when all is there.
    Preparing {
        since: Option<Duration>,
        complete: Option<Duration>,
    },
    Ready,
    Moving {
        motion: Motion,
        rest: Option<Rest>,
    },
    Sensing {
        motion: Motion,
        arrived: Fix,
        /// Whether it came to rest, rather than wobbles.
        is_calm: bool,
        since: Duration,
        told: Option<Told>,
    },
    There(Arrival),
    Stopping {
        began: Duration,
        hold: Option<Hold>,
        sent: Option<Duration>,
        rests: Option<u32>,
    },
    /// Someone else drives it: it is listened to, and sent nothing.
    Listening {
        until: Duration,
    },
    Over,
}
