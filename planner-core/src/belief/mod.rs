//! What is known of the line: either the lines that agree with all samples, or every separable label sequence with its
//! probability.
//!
//! | module | contains |
//! | --- | --- |
//! | [`sample`], [`weight`] | labels, readings and samples; weights as logarithms |
//! | [`noise`], [`reliability`], [`unknown_reliability`], [`trust`] | how reliable labels are: a number, a prior, either |
//! | [`bounds`] | what is known of the line beforehand, as given samples |
//! | [`tolerance`] | handles positions that err |
//! | [`deviation`] | how much tolerance a boundary needs that bends or moves |
//! | [`cells`] | the lines that agree with some labels, and what can be read off them |
//! | [`estimate`] | three estimates of the line |
//! | [`evidence`] | what speaks against a straight, still line |
//! | [`field`] | where a boundary of unknown shape may be, by a byte for each of some regions |
//! | [`lines`] | straight lines in a square, where labels may be wrong and nothing is given |
//! | [`goal`] | decides when the line is known well enough |
//! | [`true_labels`] | for labels that are true: the version space |
//! | [`doubtful_labels`] | for labels that may be wrong: a table of weighted cells, and its distribution |
//! | [`predictions`] | how much the next labels are expected to tell |
//! | [`observation_log`] | what must be kept of a belief over a sleep |
//!
//! Nothing here knows how the robot moves.

pub mod bounds;
pub(crate) mod cells;
pub(crate) mod curve;
pub(crate) mod deviation;
pub(crate) mod doubtful_labels;
pub mod estimate;
pub(crate) mod evidence;
pub(crate) mod field;
pub(crate) mod front;
pub(crate) mod goal;
pub(crate) mod lines;
pub(crate) mod list;
pub(crate) mod noise;
pub(crate) mod observation_log;
pub(crate) mod predictions;
pub(crate) mod reliability;
mod rows;
pub(crate) mod sample;
pub(crate) mod tolerance;
pub(crate) mod true_labels;
pub(crate) mod trust;
pub(crate) mod unknown_reliability;
pub(crate) mod weight;

use crate::belief::estimate::Estimates;
use crate::belief::goal::{Criterion, Goal};
use crate::belief::sample::{Label, Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::geometry::area::Area;
use crate::geometry::lattice::Site;
use crate::geometry::local_line::LocalLine;

/// What is known of the line: the questions that planners ask, and the results that are read out.
///
/// Every answer follows from the samples taken so far and from nothing else.
pub trait Belief {
    /// Whether another sample would be refused for want of room.
    fn is_full(&self) -> bool;

    /// Takes in what was read at a site on the way of a motion, and returns whether it was kept. It is left out where it
    /// tells nothing: where all lines left agree on the label. It is also left out where it would take the last
    /// room, as that is for the label at the motion's end. The site may be off by the [tolerance](Self::tolerance).
    ///
    /// Labels that may be wrong count as independent of each other. The errors of a real sensor at places close
    /// together often are not. So read them as far apart as its errors reach.
    ///
    /// # Errors
    /// As [`observe`](Self::observe). Without room it is no error.
    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError>;

    /// The configured tolerance: how far off a position may be at most.
    fn tolerance(&self) -> Tolerance;

    /// Takes in what was read at a site, which may be off by the [tolerance](Self::tolerance).
    ///
    /// # Errors
    /// [`ObservationError`] when the reading contradicts what is known or cannot be stored.
    fn observe(&mut self, site: Site, reading: Reading) -> Result<(), ObservationError> {
        self.observe_within(site, reading, self.tolerance())
    }

    /// Takes in a reading at a site that may be off by `tolerance`, at most by the configured one. The smaller the
    /// tolerance, the more the reading tells.
    ///
    /// # Errors
    /// As [`observe`](Self::observe), and [`ObservationError::Tolerance`].
    fn observe_within(
        &mut self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError>;

    /// The line as far as it is known: all three estimates.
    fn estimates(&self) -> Estimates;

    /// The first of the estimates, without the code and the time of the others: the mean of the lines left, or of their
    /// distribution.
    fn centre(&self) -> Option<LocalLine>;

    /// The information of the samples beyond those given at the start, bits. It is the divergence of the present
    /// distribution from the uniform one over the lines that the given samples leave.
    fn information(&self) -> f64;

    /// Whether the line is known well enough.
    fn meets<C: Criterion>(&self, goal: Goal<C>, area: Area) -> bool
    where
        Self: Sized;

    /// The chance that a label read at a site is +1, errors of the sensor included.
    fn chance(&self, site: Site) -> f64;

    /// The chance of a label read at a site whose position may be off by the tolerance, or more than that. Where positions
    /// are exact, it is exact to 10^-5. It is in single precision, and the same on every machine. More than 1 where a label is
    /// no evidence for or against the model.
    fn chance_of(&self, site: Site, label: Label) -> f32 {
        let above = self.chance(site) as f32;
        if label == Label::Positive { above } else { 1.0 - above }
    }
}

/// Why a sample was not taken. What is known is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ObservationError {
    /// The sample lies in the region of certainty of the other label: a label was wrong, or the
    /// boundary is not straight.
    Contradiction(Sample),
    /// The buffer is full.
    Full(Sample),
    /// The position may be off by so much, which is more than the tolerance that was configured.
    Tolerance(Tolerance),
    /// A label that may be wrong came with a reliability of its own, and positions err or nobody knows the reliability.
    /// Then every label is as reliable as the noise says.
    Reliability,
}

impl core::fmt::Display for ObservationError {
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
            Self::Reliability => f.write_str(
                "where positions err or the reliability is unknown, a label is as reliable as the noise says, and has no \
                 reliability of its own",
            ),
        }
    }
}

impl core::error::Error for ObservationError {}
