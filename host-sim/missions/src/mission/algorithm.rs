//! The planners that the simulator knows, by name.

use crate::mission::names::FanName;
use clap::ValueEnum as _;
use planner_core::{DrivingPrice, EffortWeight, Following, Options};
use serde::{Deserialize, Serialize};

/// Who plans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Algorithm {
    /// Algorithm 1, noiseless labels.
    #[default]
    Cfc,
    /// Algorithm 2, noisy labels.
    Scc,
    /// Two labels ahead.
    Lookahead,
    /// Two bisected chords.
    Chords,
    /// Margin sampling, the usual rule of active learning.
    Margin,
    /// A random walk, for scale.
    Random,
    /// Parallel tracks over all of the area.
    Lawnmower,
    /// Finds a front that bends and moves, and goes along it.
    Track,
}

impl Algorithm {
    /// What tables call it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Cfc => "Algorithm 1 (cfc)",
            Self::Scc => "Algorithm 2 (scc)",
            Self::Lookahead => "look-ahead",
            Self::Chords => "two chords",
            Self::Margin => "margin sampling",
            Self::Random => "random walk",
            Self::Lawnmower => "lawnmower",
            Self::Track => "front tracking",
        }
    }

    /// The default direction of P2: the one from which the algorithm learns the most.
    pub fn following(self) -> Following {
        match self {
            Self::Scc => Options::SCC.following,
            _ => Options::CFC.following,
        }
    }

    /// The default weight of the control, for look-ahead its price of driving.
    pub fn weight(self) -> EffortWeight {
        match self {
            Self::Lookahead => DrivingPrice::USUAL.into(),
            _ => EffortWeight::PAPER,
        }
    }

    /// The default fan of the unicycle: the fine one where more rays cost no more looks.
    pub fn grid(self) -> FanName {
        match self {
            Self::Lookahead | Self::Track | Self::Chords => FanName::Fine,
            _ => FanName::Paper,
        }
    }

    /// Whether it can fly with a fan. Margin sampling cannot fly with the fine one, because it tries every action.
    pub fn copes_with(self, grid: FanName) -> bool {
        self != Self::Margin || grid == FanName::Paper
    }

    /// Whether its belief is a distribution over hypotheses. If not, it is a version space.
    pub fn weighs(self, labels_err: bool) -> bool {
        match self {
            Self::Cfc | Self::Track => false,
            Self::Scc => true,
            Self::Lookahead | Self::Chords | Self::Margin | Self::Random | Self::Lawnmower => {
                labels_err
            }
        }
    }

    /// Whether it poses the paper's one-step problems. If not, options for P1 and P2 have no effect.
    pub fn poses_problems(self) -> bool {
        matches!(self, Self::Cfc | Self::Scc)
    }

    /// Whether it takes the boundary to be a straight, still line. If not, it maps a front.
    pub fn seeks_line(self) -> bool {
        self != Self::Track
    }

    /// What flags and files call it.
    ///
    /// # Panics
    /// Never: each has a name.
    pub fn name(self) -> String {
        self.to_possible_value().expect("none is hidden").get_name().to_owned()
    }
}
