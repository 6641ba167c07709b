//! An upper bound on the mass that a full table of hypotheses dropped, in single precision and rounded up.

use crate::belief::reliability::Reliability;
use crate::belief::weight::LogWeight;
use crate::belief::weight::Prior;

/// Upper bounds on the mass dropped, by both priors, on the scale of the weights in the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PrunedMass {
    area: f32,
    sequences: f32,
}

impl PrunedMass {
    pub(crate) const NOTHING: Self = Self { area: 0.0, sequences: 0.0 };

    pub(crate) fn mass(self, prior: Prior) -> f32 {
        match prior {
            Prior::Area => self.area,
            Prior::Sequences => self.sequences,
        }
    }

    pub(crate) fn add(&mut self, by_area: LogWeight, by_sequences: LogWeight) {
        self.area = up(self.area + by_area.exp_bound());
        self.sequences = up(self.sequences + by_sequences.exp_bound());
    }

    /// Updates the bound after a label of some reliability. Relative to its likelier side, a label only reduces the
    /// pruned mass. But by the paper's prior a sequence that the label split counts twice, once for each side.
    pub(crate) fn split(&mut self, reliability: Reliability) {
        if let (Some(agree), Some(disagree)) = (reliability.agree(), reliability.disagree()) {
            self.sequences = up(self.sequences * (1.0 + agree.min(disagree).exp_bound()));
        }
    }

    /// Multiplies the bound by the area prior by the largest chance that a lost hypothesis can give to a label.
    pub(crate) fn weigh_area(&mut self, most: LogWeight) {
        self.area = up(self.area * most.exp_bound());
    }

    /// Divides the bound by `unit`, the new unit of all weights.
    pub(crate) fn rescale(&mut self, unit: LogWeight) {
        if self.area > 0.0 {
            let scale = (LogWeight::ZERO - unit).exp_bound();
            self.area = up(self.area * scale);
            self.sequences = up(self.sequences * scale);
        }
    }
}

/// An upper bound on the exact value of a rounded sum or product.
fn up(mass: f32) -> f32 {
    let mass = mass * (1.0 + 4.0 * f32::EPSILON);
    if mass < f32::MAX { mass } else { f32::MAX }
}
