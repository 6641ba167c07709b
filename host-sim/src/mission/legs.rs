//! How a real vehicle made its motions: when, and how far from where it was sent it came to rest.

use serde::Serialize;

/// A motion of a real vehicle.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Leg {
    /// When it was asked for, seconds since the flight began.
    pub began: f64,
    /// When it had ended, and its label was there.
    pub ended: f64,
    /// How far from where it was sent the vehicle came to rest, metres.
    pub off: f64,
}

/// The motions of a flight.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Legs {
    /// How many there were.
    pub motions: usize,
    /// What one took, its median, seconds.
    pub seconds: f64,
    /// How far from where it was sent the vehicle came to rest, the median, metres.
    pub off: f64,
    /// The furthest.
    pub off_most: f64,
    /// The least tolerance, in tenths of a metre, that covers that.
    pub tolerance: f64,
}

impl Legs {
    /// What motions come to; `None` of none.
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
