//! What is known of the line: the lines that agree with the samples so far, or all separable label
//! sequences with their probabilities.
//!
//! The lines that agree with some labels are a convex *cell*, held as a cyclic list of sample indices
//! ([`cell`]). For labels that are true there is one cell, the [`version_space`]; for labels that may be
//! wrong there is a table of weighed cells ([`hypotheses`]), read as a distribution ([`posterior`]).
//! Nothing here knows how the robot moves.

pub mod candidates;
pub mod cell;
pub(crate) mod cell_measure;
pub mod estimate;
pub mod hypotheses;
pub(crate) mod list;
pub mod posterior;
pub(crate) mod pruned;
pub mod sample;
pub mod version_space;
pub mod weight;
