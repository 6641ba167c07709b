//! The motions of a real vehicle: when each began and ended, and how far from its target the vehicle came to rest.

use serde::{Deserialize, Serialize};

/// A motion of a real vehicle.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Leg {
    /// When it was asked for, seconds since the flight began.
    pub began: f64,
    /// When it had ended and its label had arrived, seconds.
    pub ended: f64,
    /// How far from the motion's target the vehicle came to rest, metres.
    pub off: f64,
}

/// The motions of a flight.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Legs {
    /// How many there were.
    pub motions: usize,
    /// Median duration of a motion, seconds.
    pub seconds: f64,
    /// Median of the distance from the target, metres.
    pub off: f64,
    /// The largest, metres.
    pub off_most: f64,
    /// The least tolerance that covers `off_most`, in whole tenths of a metre.
    pub tolerance: f64,
}

impl Legs {
    /// The summary of some motions; `None` if there are none.
    pub fn of(legs: &[Leg]) -> Option<Self> {
        let sorted = |of: fn(&Leg) -> f64| {
            let mut all: Vec<_> = legs.iter().map(of).collect();
            all.sort_by(f64::total_cmp);
            all
        };
        let off = sorted(|leg| leg.off);
        let seconds = sorted(|leg| leg.ended - leg.began);
        let off_most = *off.last()?;
        Some(Self {
            motions: legs.len(),
            seconds: *seconds.get(legs.len() / 2)?,
            off: *off.get(legs.len() / 2)?,
            off_most,
            tolerance: (off_most * 10.0).ceil().max(1.0) / 10.0,
        })
    }
}
