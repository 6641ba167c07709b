//! Checks that a vehicle's positions move as its velocity says.
//!
//! A glitch of the receiver, a correction of the estimator or a new origin moves the positions without the vehicle, at
//! once or over seconds. The samples taken before then have wrong positions, and no label shows that.
//!
//! From one position to the next the vehicle moves by the mean of both velocities, give or take their difference over
//! that time. Where positions were lost it may have moved and stopped between. What is left over is summed. Within a
//! window of ten seconds it may be as much as the tolerance.

use std::collections::VecDeque;

use crate::fly::vehicle::Fix;

/// Positions within this time are compared, milliseconds of the vehicle's clock.
const WINDOW_MS: u32 = 10_000;

/// The least limit, metres: estimators shift positions by as much all the time.
const LEAST: f64 = 0.25;

/// If two positions are this many seconds apart, one between them was lost.
const GAP: f64 = 0.25;

/// Twice the largest acceleration of a vehicle between positions of which one was lost, m/s^2.
const UNSEEN: f64 = 5.0;

/// Sums up to a position, in metres.
#[derive(Clone, Copy, Debug)]
struct Sum {
    fix: Fix,
    /// What its speed does not explain, to the north and to the east.
    left: [f64; 2],
    /// What may be left over, as it sped up or slowed down.
    slack: f64,
}

/// The positions of the last seconds.
#[derive(Clone, Debug, Default)]
pub struct Slide {
    sums: VecDeque<Sum>,
}

impl Slide {
    /// Takes in a position. Returns how far positions moved without the vehicle, if beyond `tolerance`; both in metres.
    pub fn take(&mut self, fix: Fix, tolerance: f64) -> Option<f64> {
        let next = self.sums.back().map_or(Sum { fix, left: [0.0; 2], slack: 0.0 }, |last| {
            let seconds = f64::from(fix.at_ms.saturating_sub(last.fix.at_ms)) / 1e3;
            let moved = [fix.at.north - last.fix.at.north, fix.at.east - last.fix.at.east];
            let mut left = last.left;
            for axis in 0..2 {
                let mean = f64::midpoint(fix.velocity[axis], last.fix.velocity[axis]);
                left[axis] += f64::from(moved[axis]) - mean * seconds;
            }
            let [a, b] = [0, 1].map(|axis| fix.velocity[axis] - last.fix.velocity[axis]);
            let unseen = if seconds > GAP { UNSEEN * seconds * seconds } else { 0.0 };
            Sum { fix, left, slack: last.slack + libm::hypot(a, b) * seconds + unseen }
        });
        while self.sums.front().is_some_and(|it| it.fix.at_ms + WINDOW_MS < fix.at_ms) {
            self.sums.pop_front();
        }
        let beyond = |sum: &Sum| {
            let off = libm::hypot(next.left[0] - sum.left[0], next.left[1] - sum.left[1]);
            (off - (next.slack - sum.slack) > tolerance.max(LEAST)).then_some(off)
        };
        let worst = self
            .sums
            .iter()
            .filter_map(beyond)
            .fold(None, |worst: Option<f64>, it| Some(worst.map_or(it, |worst| worst.max(it))));
        self.sums.push_back(next);
        worst
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fly::frame::Ned;

    /// Drives to the north with a tenth of a second between positions, and is moved to the east besides.
    fn first(speed: impl Fn(f64) -> f64, east: impl Fn(f64) -> f64) -> Option<f64> {
        let (mut slide, mut north) = (Slide::default(), 0.0);
        for tenth in 0_u32..300 {
            let time = f64::from(tenth) / 10.0;
            let now = speed(time);
            north += now * 0.1;
            let at = Ned { north: north as f32, east: east(time) as f32 };
            let velocity = [now, 0.0];
            let fix = Fix { at_ms: tenth * 100, at, down: 0.0, velocity };
            if slide.take(fix, 1.0).is_some() {
                return Some(time);
            }
        }
        None
    }

    #[test]
    fn what_the_speed_explains_is_no_slide() {
        let stop_and_go = |time: f64| if time % 3.0 < 1.0 { 0.0 } else { 2.0 };
        assert_eq!(first(stop_and_go, |_| 0.0), None);
        assert_eq!(first(|time| 2.0 * libm::sin(time), |_| 0.0), None);
        // A walk of half the tolerance in ten seconds is within what positions may err.
        assert_eq!(first(|_| 1.0, |time| 0.05 * time), None);
    }

    /// It went 0.8 m and stopped again while two messages were lost.
    #[test]
    fn a_way_that_nobody_saw_is_no_slide() {
        let mut slide = Slide::default();
        for (at_ms, north) in [(0, 0.0), (100, 0.0), (600, 0.8), (700, 0.8)] {
            let at = Ned { north, east: 0.0 };
            let fix = Fix { at_ms, at, down: 0.0, velocity: [0.0; 2] };
            assert_eq!(slide.take(fix, 0.02), None, "{at_ms}");
        }
    }

    #[test]
    fn a_jump_and_a_slide_are_found() {
        assert_eq!(first(|_| 1.0, |time| if time < 15.0 { 0.0 } else { 6.0 }), Some(15.0));
        // As was seen: 3.3 m over two seconds.
        let found = first(|_| 1.25, |time| 3.3 * ((time - 15.0) / 2.0).clamp(0.0, 1.0));
        assert!(found.is_some_and(|it| (15.5..16.0).contains(&it)), "{found:?}");
    }
}
