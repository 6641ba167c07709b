//! What the paper leaves open in Algorithms 1 and 2: what motion costs, and which directions are allowed.

use crate::belief::sample::Sample;
use crate::geometry::arc::SlopeArc;
use crate::geometry::lattice::Vector;
use crate::search::direction_rule::ArcRule;
use crate::search::objective::EffortWeight;

/// How P1 looks for the opposite label (Section III-A).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Crossing {
    /// In any direction in which the boundary cannot run: P1 as printed.
    #[default]
    Unrestricted,
    /// Of these, only along the direction from the first given sample (the paper's oracle point) to the second.
    AlongOracle,
    /// Of these, only at right angles to the bisector of the slope arc.
    AcrossBisector,
}

/// How P2 follows the boundary.
///
/// It has no default, as the algorithms need different ones. Along the bisector Algorithm 1 learns the most. The same
/// costs Algorithm 2 a tenth of a bit in thirty labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Following {
    /// In any direction in which the boundary can run: P2 as printed. It takes the smallest turn into the slope arc, so
    /// it skims ground that is all but certain. In Algorithm 1 such a label tells next to nothing.
    Unrestricted,
    /// Of these, only along the bisector of the slope arc, as Section III-A proposes for P1.
    AlongBisector,
}

/// What the paper leaves open in Algorithms 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Options {
    /// The weight of the control in the objective.
    pub weight: EffortWeight,
    /// How P1 looks for the opposite label.
    pub crossing: Crossing,
    /// How P2 follows the boundary.
    pub following: Following,
}

impl Options {
    /// With these Algorithm 1 learns the most.
    pub const CFC: Self = Self {
        weight: EffortWeight::PAPER,
        crossing: Crossing::Unrestricted,
        following: Following::AlongBisector,
    };

    /// With these Algorithm 2 learns the most.
    pub const SCC: Self = Self { following: Following::Unrestricted, ..Self::CFC };

    /// The directions in which P1, or P3, looks for the opposite label when the boundary's slopes lie
    /// in an arc; `oracle` is the direction from the first oracle point to the second.
    pub(crate) fn crossing_rule(self, slopes: SlopeArc, oracle: Option<Vector>) -> ArcRule {
        let inside = match self.crossing {
            Crossing::Unrestricted => None,
            Crossing::AlongOracle => oracle.map(SlopeArc::tracking),
            Crossing::AcrossBisector => Some(SlopeArc::tracking(slopes.bisector().left())),
        };
        ArcRule { inside, outside: Some(slopes) }
    }

    /// The directions in which P2, or P4, follows a boundary whose slopes lie in an arc.
    pub(crate) fn following_rule(self, slopes: SlopeArc) -> ArcRule {
        let inside = match self.following {
            Following::Unrestricted => slopes,
            Following::AlongBisector => slopes.middle(),
        };
        ArcRule { inside: Some(inside), outside: None }
    }
}

/// The direction from the first of these samples to the second.
pub(crate) fn first_to_second(samples: &[Sample]) -> Option<Vector> {
    match samples {
        [p1, p2, ..] => Some(p2.site - p1.site),
        _ => None,
    }
}
