//! Where a flight stands. What leads from one stage to the next is drawn in [`pilot`](crate::fly::pilot).

use std::time::Duration;

use planner_core::belief::sample::Label;

use crate::fly::label::Told;
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
}

/// A motion that is to be made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub order: Order,
    pub wants_label: bool,
    pub began: Duration,
    pub sent: Option<Duration>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Stage {
    /// Since when it waits, and since when all is there.
    Preparing {
        since: Option<Duration>,
        complete: Option<Duration>,
    },
    Ready,
    /// At rest there since that, by its clock.
    Moving {
        motion: Motion,
        rests: Option<u32>,
    },
    Sensing {
        motion: Motion,
        arrived_ms: u32,
        since: Duration,
        told: Option<Told>,
    },
    There(Arrival),
    Stopping {
        began: Duration,
        sent: Option<Duration>,
        rests: Option<u32>,
    },
    Over,
}
