//! Who follows fronts, by name.

use clap::ValueEnum as _;
use serde::{Deserialize, Serialize};

use crate::campaign::fronts::following::REACH;

/// Who follows fronts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Who {
    /// Finds a front that bends and moves, and goes along it.
    Track,
    /// Turns by 45 degrees when the label changes, for comparison.
    Zigzag,
    /// Goes in circles towards the front, for comparison.
    BangBang,
}

impl Who {
    /// What tables call it.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Track => "front tracking",
            Self::Zigzag => "zigzag",
            Self::BangBang => "bang-bang",
        }
    }

    /// Whether it is told how fast a front moves.
    pub const fn is_told_speed(self) -> bool {
        matches!(self, Self::Track)
    }

    /// Its longest motion if nobody says, metres.
    pub const fn usual_reach(self) -> f64 {
        match self {
            Self::Track => REACH,
            Self::Zigzag | Self::BangBang => 1.0,
        }
    }

    /// What flags and records call it.
    ///
    /// # Panics
    /// Never: each has a name.
    pub fn name(self) -> String {
        self.to_possible_value().expect("none is hidden").get_name().to_owned()
    }
}
