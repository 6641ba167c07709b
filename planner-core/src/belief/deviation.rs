//! How far from its straight line a label may be read, by cause, and the tolerance that covers the sum.
//!
//! **The rule.** The tolerance is the sum of four distances, in metres:
//!
//! ```text
//!   tolerance = position + lag + bend + drift
//! ```
//!
//! - `position`: how far a reported position may be off.
//! - `lag`: how far the robot drives while a label is late: the sensor's delay in seconds times the speed.
//! - `bend`: half the width of the narrowest straight strip that contains the boundary within the field, at each time.
//!   An arc whose height over its chord is `h` has a bend of `h / 2`, a wave of amplitude `h` a bend of `h`.
//! - `drift`: how far the strip's middle line moves during the mission. This is the most by which the distance of a place
//!   of the field from that line changes between any two times.
//!
//! **What is promised, where labels are true.** Take the middle line at any one time `s` of the mission: the first, the
//! last or another. No label refuses it or cuts it off, so it is among the lines left. No audit fails.
//!
//! *Proof.* Let `d_t(q)` be the signed distance of the place `q` from the middle line at the time `t`, positive on its
//! +1 side. A label +1 was true at the time `t` at a place `q`. So `q` is in the strip or on its +1 side, and
//! `d_t(q) >= -bend`. From `t` to `s` no distance changes by more than `drift`, so `d_s(q) >= -(bend + drift)`. The
//! position `r` that was reported with the label is within `lag + position` of `q`. A distance from a line changes by no
//! more than the way does, so `d_s(r) >= -(bend + drift + lag + position)`. With the sum as the tolerance, this is the
//! premise from which [`tolerance`](crate::belief::tolerance) shows that the label is true of that line at the place where
//! it is inserted. A label -1 is the same with the sides exchanged.
//!
//! *Given samples* are inserted where they are. They must have the label of each of these lines. This holds if they are
//! further than `bend + drift` from the boundary at the start. Otherwise use
//! [`VersionSpace::of_uncertain`](crate::VersionSpace::of_uncertain).
//!
//! *Half of the drift* is enough if the boundary moves straight along its normal, for one line alone: the one half-way.
//! From there no distance changes by more than half. The line at the end is then not promised. In general no straight
//! line is half-way from all that the boundary has been, so the rule takes the whole drift.
//!
//! **Where labels may be wrong**, a tolerance is three standard deviations of a position's error, and nothing is
//! excluded. A bend is no independent error of each position, so the stated probabilities are not exact. Labels within
//! the sum of the line count for little, those beyond it for as much as without a tolerance.

use crate::belief::tolerance::Tolerance;
use crate::geometry::value::ValueError;

/// How far from its straight line a label may be read, by cause. [`tolerance`](Self::tolerance) is what a belief must be
/// told, so that a boundary that bends and moves contradicts nothing.
///
/// A belief takes it in the place of a tolerance:
///
/// ```
/// # use planner_core::{Deviation, Label, Sample, VersionSpace};
/// # let given = [
/// #     Sample::at([2.0, 1.0], Label::Negative)?,
/// #     Sample::at([2.0, 8.0], Label::Positive)?,
/// #     Sample::at([18.0, 16.0], Label::Positive)?,
/// #     Sample::at([18.0, 5.0], Label::Negative)?,
/// # ];
/// // Positions err by 5 cm, a label is 0.2 s late at 0.5 m/s, and the boundary bends by 25 cm.
/// let deviation =
///     Deviation { position_m: 0.05, lag_m: 0.2 * 0.5, bend_m: 0.25, ..Deviation::NONE };
/// let belief = VersionSpace::<32>::new(&given)?.with_tolerance(deviation)?;
/// assert!((belief.tolerance().metres() - 0.4).abs() < 1e-4);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
///
/// A motion keeps the whole tolerance from the border and from keep-outs, also the part for bend and drift.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Deviation {
    /// How far a reported position may be off, metres.
    pub position_m: f64,
    /// How far the robot drives while a label is late: the delay times the speed, metres.
    pub lag_m: f64,
    /// How far the boundary may be from a straight line: half the width of the narrowest straight strip that contains it
    /// within the field, metres.
    pub bend_m: f64,
    /// How far that line may move during the mission, from any time to any other, metres.
    pub drift_m: f64,
}

impl Deviation {
    /// Positions are exact, and the boundary is a straight, still line.
    pub const NONE: Self = Self { position_m: 0.0, lag_m: 0.0, bend_m: 0.0, drift_m: 0.0 };

    /// The sum of all parts as a tolerance, rounded up to lattice units.
    ///
    /// # Errors
    /// [`ValueError`] unless each part is at least 0 and the sum is at most 1,024 m.
    pub fn tolerance(self) -> Result<Tolerance, ValueError> {
        let Self { position_m, lag_m, bend_m, drift_m } = self;
        let parts = [position_m, lag_m, bend_m, drift_m];
        if !parts.iter().all(|part| *part >= 0.0) {
            return Err(ValueError("each part of a deviation is 0 m or more"));
        }
        Tolerance::new(parts.iter().sum())
    }
}

/// As [`Deviation::tolerance`].
impl TryFrom<Deviation> for Tolerance {
    type Error = ValueError;

    fn try_from(deviation: Deviation) -> Result<Self, ValueError> {
        deviation.tolerance()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deviation_is_the_sum_of_its_parts() {
        let all = Deviation { position_m: 0.25, lag_m: 0.125, bend_m: 0.5, drift_m: 1.0 };
        assert_eq!(all.tolerance(), Tolerance::new(1.875));
        assert_eq!(Deviation::NONE.tolerance(), Ok(Tolerance::NONE));
        let parts: [fn(f64) -> Deviation; 4] = [
            |it| Deviation { position_m: it, ..Deviation::NONE },
            |it| Deviation { lag_m: it, ..Deviation::NONE },
            |it| Deviation { bend_m: it, ..Deviation::NONE },
            |it| Deviation { drift_m: it, ..Deviation::NONE },
        ];
        for part in parts {
            assert_eq!(part(0.75).tolerance(), Tolerance::new(0.75));
            for wrong in [-0.1, f64::NAN, f64::NEG_INFINITY, f64::INFINITY, 1024.5] {
                assert!(part(wrong).tolerance().is_err(), "{wrong}");
            }
        }
        // A negative part is not made up for by another.
        let mixed = Deviation { position_m: 1.0, bend_m: -0.5, ..Deviation::NONE };
        assert!(mixed.tolerance().is_err());
    }
}
