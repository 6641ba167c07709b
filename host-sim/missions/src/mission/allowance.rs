//! What a planner allows for beside positions that err: a boundary that bends and moves a little, and late labels.
//!
//! [`planner_core::Deviation`] has the rule by which they enter the tolerance, and what is promised then.

use std::iter;

use anyhow::Result;
use planner_core::{Deviation, Tolerance};
use serde::{Deserialize, Serialize};

use crate::mission::strict::beyond;

/// The most of each, metres, as of a tolerance.
const MOST: f64 = 1024.0;

/// `allow` of a scenario file, metres. Each part is 0 unless the file says otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Allowance {
    /// How far the boundary may be from a straight line within the area.
    pub bend: f64,
    /// How far that line may move during the mission.
    pub drift: f64,
    /// How far the robot drives while a label is late.
    pub lag: f64,
}

impl Allowance {
    /// The boundary is a straight, still line, and labels are in time.
    pub const NONE: Self = Self { bend: 0.0, drift: 0.0, lag: 0.0 };

    /// The parts by their names.
    pub const fn parts(&self) -> [(&'static str, f64); 3] {
        [("bend", self.bend), ("drift", self.drift), ("lag", self.lag)]
    }

    /// Whether these are distances.
    ///
    /// # Errors
    /// Names the part, after `prefix`, and the number.
    pub fn check(&self, prefix: &str) -> Result<()> {
        for (name, metres) in self.parts() {
            if !(0.0..=MOST).contains(&metres) {
                return beyond(&format!("{prefix}{name}"), metres);
            }
        }
        Ok(())
    }

    /// The tolerance of a planner whose positions are off by so many metres at most.
    ///
    /// # Errors
    /// Names `field` and the sum, if that is too much.
    pub fn tolerance(&self, field: &str, position_m: f64) -> Result<Tolerance> {
        let &Self { bend, drift, lag } = self;
        let all = Deviation { position_m, bend_m: bend, drift_m: drift, lag_m: lag };
        all.tolerance().or_else(|_| beyond(field, sum(position_m, self)))
    }

    /// How far given samples must be from the boundary at the start, metres, so that they are true of its straight line
    /// at any time.
    pub const fn of_given(&self) -> f64 {
        self.bend + self.drift
    }
}

/// A position's part of a tolerance and an allowance in words: the sum, and its parts if there are any.
pub fn sum(position_m: f64, allowance: &Allowance) -> String {
    let all = position_m + allowance.parts().iter().map(|(_, metres)| metres).sum::<f64>();
    if *allowance == Allowance::NONE {
        return format!("{all} m");
    }
    let all = tidy(all);
    let parts = allowance.parts();
    let parts = parts.iter().filter(|(_, metres)| *metres > 0.0);
    let parts = parts.map(|(name, metres)| format!("{metres} {name}"));
    let parts = iter::once(format!("{position_m} position")).chain(parts).collect::<Vec<_>>();
    format!("{all} m ({})", parts.join(" + "))
}

/// The tolerance of a planner and its parts, metres, for the trace.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToleranceRecord {
    /// The sum.
    pub sum: f64,
    /// How far positions may be off.
    pub position: f64,
    /// How far the boundary may be from a straight line.
    pub bend: f64,
    /// How far that line may move.
    pub drift: f64,
    /// How far the robot drives while a label is late.
    pub lag: f64,
}

impl ToleranceRecord {
    /// Of a position's part and an allowance.
    pub fn of(position: f64, allowance: &Allowance) -> Self {
        let &Allowance { bend, drift, lag } = allowance;
        Self { sum: tidy(position + bend + drift + lag), position, bend, drift, lag }
    }

    /// The sum and its parts in words.
    pub fn words(&self) -> String {
        let &Self { position, bend, drift, lag, .. } = self;
        sum(position, &Allowance { bend, drift, lag })
    }
}

/// Whole tenths of a millimetre, so that 0.1 + 0.2 is 0.3.
pub fn tidy(metres: f64) -> f64 {
    (metres * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_named_and_added() {
        let some = Allowance { bend: 0.2, drift: 0.5, lag: 0.0 };
        assert_eq!(sum(0.15, &some), "0.85 m (0.15 position + 0.2 bend + 0.5 drift)");
        assert_eq!(sum(0.15, &Allowance::NONE), "0.15 m");
        let tolerance = some.tolerance("tolerance", 0.15).unwrap().metres();
        assert!((0.85..0.85 + 1e-4).contains(&tolerance), "{tolerance}");
        let error = some.tolerance("tolerance", 1024.0).unwrap_err().to_string();
        assert!(error.starts_with("tolerance: found 1024.7 m (1024 position + 0.2"), "{error}");
    }
}
