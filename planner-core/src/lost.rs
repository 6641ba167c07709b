//! What a full table of hypotheses gave up: a bound, in single precision and rounded up.

use crate::hypotheses::{Hypothesis, Prior};
use crate::weight::LogWeight;

/// Mass given up, at most, by both priors, on the scale of the weights held.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lost {
    area: f32,
    sequences: f32,
}

impl Lost {
    pub(crate) const NOTHING: Self = Self { area: 0.0, sequences: 0.0 };

    /// More than a step can round away.
    const UP: f32 = 1.0 + 8.0 * f32::EPSILON;

    pub(crate) fn mass(self, prior: Prior) -> f32 {
        match prior {
            Prior::Area => self.area,
            Prior::Sequences => self.sequences,
        }
    }

    pub(crate) fn add<const E: usize>(&mut self, gone: &Hypothesis<E>) {
        self.area = (self.area + gone.weight(Prior::Area).exp_single()) * Self::UP;
        self.sequences = (self.sequences + gone.weight(Prior::Sequences).exp_single()) * Self::UP;
    }

    /// After a label, and with `best` as the new unit of weights. What was given up can at most have
    /// been weighed by `most`; by the paper's prior its parts may both have counted, and `p` and
    /// `1 - p` make 1.
    pub(crate) fn rescale(&mut self, most: LogWeight, best: LogWeight) {
        let scaled = |mass: f32, by: LogWeight| {
            let mass = mass * by.relative_to(best).exp_single() * Self::UP;
            if mass < f32::MAX { mass } else { f32::MAX }
        };
        if self.area > 0.0 {
            self.area = scaled(self.area, most);
            self.sequences = scaled(self.sequences, LogWeight::ZERO);
        }
    }
}
