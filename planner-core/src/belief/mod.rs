//! What is known of the line: the lines that agree with the samples so far, or all separable label
//! sequences with their probabilities.
//!
//! The lines that agree with some labels are a convex *cell*, held as a cyclic list of sample indices
//! ([`cell`]). For labels that are true there is one cell, the [`version_space`]; for labels that may be
//! wrong there is a table of weighed cells ([`hypotheses`]), read as a distribution ([`posterior`]).
//! What the next labels are expected to tell is an [`outlook`]: a [`picture`] of the one cell, or [`columns`] beside the
//! table in a [`forecast`]. When that is enough says a [`goal`], and what
//! a position that errs is good for a [`tolerance`]. What has to be kept of a belief over a sleep is what it was [`told`].
//! Nothing here knows how the robot moves.

pub(crate) mod blur;
pub mod cell;
pub(crate) mod column;
pub mod columns;
pub mod consistent_lines;
pub(crate) mod directions;
pub mod edge;
pub mod estimate;
pub mod forecast;
pub mod goal;
pub mod hypotheses;
pub(crate) mod list;
pub(crate) mod moments;
pub mod noise;
pub mod outlook;
pub mod picture;
pub mod posterior;
pub(crate) mod pruned;
pub mod sample;
pub mod told;
pub mod tolerance;
pub(crate) mod trapezoids;
pub mod version_space;
pub mod weight;

use crate::belief::estimate::Estimates;
use crate::belief::goal::Goal;
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::geometry::area::Area;
use crate::geometry::lattice::Site;

/// What is known of the line: what planners ask, and what is read out.
///
/// Every answer follows from the samples taken so far and from nothing else.
pub trait Belief {
    /// Whether another sample would be refused for want of room.
    fn is_full(&self) -> bool;

    /// How far off a position may be at most, as it was configured.
    fn tolerance(&self) -> Tolerance;

    /// Takes in what was read at a site, which may be off by the [tolerance](Self::tolerance).
    ///
    /// # Errors
    /// [`Refused`] when the reading contradicts what is known or cannot be stored.
    fn observe(&mut self, site: Site, reading: Reading) -> Result<(), Refused> {
        self.observe_within(site, reading, self.tolerance())
    }

    /// Takes in what was read at a site that may be off by so much, at most by the tolerance. The less it may be off, the
    /// more the reading tells.
    ///
    /// # Errors
    /// As [`observe`](Self::observe), and [`Refused::Tolerance`].
    fn observe_within(
        &mut self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Result<(), Refused>;

    /// The line as far as it is known.
    fn estimates(&self) -> Estimates;

    /// What the samples told of the line beyond those given at the start, bits: the divergence of what
    /// is known from the uniform distribution over the lines that the given samples leave.
    fn information(&self) -> f64;

    /// Whether the line is known well enough.
    fn meets(&self, goal: Goal, area: Area) -> bool;

    /// The chance that a label read at a site is +1, errors of the sensor included.
    fn chance(&self, site: Site) -> f64;
}

/// Why a sample was not taken. What is known is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Refused {
    /// The sample lies in the region of certainty of the other label: a label was wrong, or the
    /// boundary is not straight.
    Contradiction(Sample),
    /// The buffer is full.
    Full(Sample),
    /// The position may be off by so much, which is more than the tolerance that was configured.
    Tolerance(Tolerance),
}

impl core::fmt::Display for Refused {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Contradiction(s) => write!(
                f,
                "label {} at lattice site ({}, {}) contradicts the region of certainty it lies in",
                s.label.sign(),
                s.site.x(),
                s.site.z()
            ),
            Self::Full(_) => f.write_str("the sample buffer is full"),
            Self::Tolerance(tolerance) => write!(
                f,
                "a position that may be off by {} m is beyond the tolerance that was configured",
                tolerance.metres()
            ),
        }
    }
}

impl core::error::Error for Refused {}
