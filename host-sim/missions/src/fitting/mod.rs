//! The lines that agree with recorded labels, however many they are, and whether a straight line explains them.
//!
//! | module | contains |
//! | --- | --- |
//! | [`separation`] | true labels: the exact version space, by convex hulls |
//! | [`tolerant`] | true labels at positions that err |
//! | [`doubt`], [`line_posterior`] | labels that may be wrong: the distribution over lines |
//! | [`outlier`] | the rows without which a line separates the rest |
//! | [`fit`] | whether any straight, still line explains the labels |
//! | [`fewest`] | the line that the fewest labels of a mission disagree with |
//! | [`explanation`] | what explains labels of a mission that no line explains |

pub mod doubt;
pub mod explanation;
pub mod facing;
pub mod fewest;
pub mod fit;
mod halving;
pub mod hull;
pub mod line_posterior;
pub mod line_set;
pub mod outlier;
pub mod patch;
pub mod separation;
pub mod shortest_pairs;
pub mod tolerant;
