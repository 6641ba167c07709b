//! The slopes of the lines `z = rho x + c` that have every sample a metre above or below, on the side of its label.
//!
//! An intercept fits if it is at most each upper sample's `z - rho x - 1` and at least each lower one's
//! `z - rho x + 1`. So a slope has an intercept exactly if any upper and any lower sample satisfy
//! `rho (x - x') <= z - z' - 2`. Each such pair bounds the slope from one side, by a fraction of integers.

use std::cmp::Ordering;

use planner_core::lattice::UNITS_PER_METRE;
use planner_core::{Label, Sample};

/// A fraction whose denominator is positive. Both are below 2^31 in size, as they come from differences of sites.
#[derive(Clone, Copy, Debug)]
struct Fraction {
    rise: i64,
    run: i64,
}

impl Fraction {
    fn cmp(self, other: Self) -> Ordering {
        (self.rise * other.run).cmp(&(other.rise * self.run))
    }

    fn value(self) -> f64 {
        self.rise as f64 / self.run as f64
    }
}

/// The slopes that samples leave, from and to.
#[derive(Clone, Copy, Debug)]
pub struct Slopes {
    /// The label above the line.
    above: Label,
    low: Option<Fraction>,
    high: Option<Fraction>,
}

impl Slopes {
    /// All of them, for lines with this label above.
    pub const fn all(above: Label) -> Self {
        Self { above, low: None, high: None }
    }

    /// Those that are left with another sample beside earlier ones; `None` if there is none.
    #[must_use]
    pub fn with(mut self, earlier: &[Sample], sample: Sample) -> Option<Self> {
        for other in earlier.iter().filter(|other| other.label != sample.label) {
            self = if sample.label == self.above {
                self.between(sample, *other)?
            } else {
                self.between(*other, sample)?
            };
        }
        Some(self)
    }

    /// The slopes that have these two samples on either side.
    fn between(mut self, above: Sample, below: Sample) -> Option<Self> {
        let way = above.site - below.site;
        let (run, rise) = (i64::from(way.x()), i64::from(way.z()) - 2 * i64::from(UNITS_PER_METRE));
        match run.cmp(&0) {
            Ordering::Greater => {
                let bound = Fraction { rise, run };
                if self.high.is_none_or(|high| bound.cmp(high).is_lt()) {
                    self.high = Some(bound);
                }
            }
            Ordering::Less => {
                let bound = Fraction { rise: -rise, run: -run };
                if self.low.is_none_or(|low| bound.cmp(low).is_gt()) {
                    self.low = Some(bound);
                }
            }
            Ordering::Equal if rise < 0 => return None,
            Ordering::Equal => {}
        }
        match (self.low, self.high) {
            (Some(low), Some(high)) if low.cmp(high).is_gt() => None,
            _ => Some(self),
        }
    }

    /// The one nearest to 0.
    pub fn least(self) -> f64 {
        match (self.low, self.high) {
            (Some(low), _) if low.rise > 0 => low.value(),
            (_, Some(high)) if high.rise < 0 => high.value(),
            _ => 0.0,
        }
    }
}
