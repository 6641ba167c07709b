//! The planners that the simulator knows, by name.

use planner_core::planner::config::Following;
use planner_core::planner::{cfc, scc};
use serde::{Deserialize, Serialize};

/// Who plans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Algorithm {
    /// Algorithm 1, noiseless labels.
    Cfc,
    /// Algorithm 2, noisy labels.
    Scc,
    /// A random walk, for scale.
    Random,
}

impl Algorithm {
    /// What tables call it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Cfc => "Algorithm 1 (cfc)",
            Self::Scc => "Algorithm 2 (scc)",
            Self::Random => "random walk",
        }
    }

    /// How P2 follows the boundary unless one says: in the way that learns the most.
    pub fn following(self) -> Following {
        match self {
            Self::Cfc | Self::Random => cfc::FOLLOWING,
            Self::Scc => scc::FOLLOWING,
        }
    }

    /// Whether what it knows of labels is a distribution over hypotheses.
    pub fn weighs(self, labels_err: bool) -> bool {
        match self {
            Self::Cfc => false,
            Self::Scc => true,
            Self::Random => labels_err,
        }
    }
}
