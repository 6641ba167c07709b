//! What is known where labels may be wrong: a table of weighted cells, and the distribution that it stands for.

mod blur;
mod cell_posterior;
mod posterior_view;
mod pruned;

pub use cell_posterior::{CellPosterior, Hypothesis};
pub use posterior_view::{Credible, MostLikely, PosteriorView, ReliabilityEstimate};
