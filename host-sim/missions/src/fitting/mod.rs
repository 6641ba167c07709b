//! The lines that agree with recorded labels, however many they are, and whether a straight line explains them.
//!
//! | module | contains |
//! | --- | --- |
//! | [`separation`] | true labels: the version space, by convex hulls, also where positions err |
//! | [`doubt`], [`line_posterior`] | labels that may be wrong: the distribution over lines, and what it says of places |
//! | [`outlier`] | the rows without which a line separates the rest |
//! | [`fewest`] | the line that the fewest labels disagree with |
//! | [`explanation`] | whether a straight, still line explains the labels, and what does if not |

mod chances;
pub mod doubt;
pub mod explanation;
pub mod facing;
pub mod fewest;
mod halving;
pub mod hull;
pub mod line_posterior;
pub mod line_set;
pub mod outlier;
pub mod patch;
pub mod separation;
