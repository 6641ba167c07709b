//! The names of choices in scenario files and flags.

use planner_core::{AnyVehicle, Crossing, Following, Policy, Prior, Unicycle};
use serde::{Deserialize, Serialize};

/// The names of a choice of the planner: each with what it chooses.
macro_rules! names {
    ($(#[$about:meta])* $name:ident of $choice:ident {
        $($(#[$help:meta])* $entry:ident = $chosen:ident,)*
    }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Serialize, Deserialize, clap::ValueEnum)]
        #[serde(rename_all = "kebab-case")]
        pub enum $name {
            $($(#[$help])* $entry,)*
        }

        impl From<$name> for $choice {
            fn from(name: $name) -> Self {
                match name {
                    $($name::$entry => Self::$chosen,)*
                }
            }
        }
    };
}

/// How finely the unicycle turns, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum FanName {
    /// Rays 10 mrad apart
    Paper,
    /// Rays 1 urad apart
    Fine,
}

impl From<FanName> for Unicycle {
    fn from(fan: FanName) -> Self {
        match fan {
            FanName::Paper => Self::paper(),
            FanName::Fine => Self::fine(),
        }
    }
}

impl From<FanName> for AnyVehicle {
    fn from(fan: FanName) -> Self {
        Self::Unicycle(fan.into())
    }
}

names! {
    /// How P1 looks for the opposite label, by name.
    #[derive(Default)]
    CrossingName of Crossing {
        /// In any direction in which the boundary cannot run: P1 as printed
        #[default]
        Anyhow = Unrestricted,
        /// Along the direction from the first oracle point to the second
        AlongOracle = AlongOracle,
        /// At right angles to the bisector of the slope arc
        AcrossBisector = AcrossBisector,
    }
}

names! {
    /// How P2 follows the boundary, by name.
    FollowingName of Following {
        /// In any direction in which the boundary can run: P2 as printed
        Anyhow = Unrestricted,
        /// Along the bisector of the slope arc
        AlongBisector = AlongBisector,
    }
}

names! {
    /// How hypotheses choose an action together, by name.
    #[derive(Default)]
    PolicyName of Policy {
        /// P3 and P4 over all hypotheses at once
        Joint = Joint,
        /// A vote, each held to the starting regions of certainty
        MixtureOfStart = MixtureOfStart,
        /// A vote, each held to its own regions of certainty
        #[default]
        MixtureOfOwn = MixtureOfOwn,
    }
}

names! {
    /// How hypotheses are weighed beforehand, by name.
    #[derive(Default)]
    PriorName of Prior {
        /// By the measure of their lines
        #[default]
        Area = Area,
        /// All alike, as the paper has it
        Sequences = Sequences,
    }
}
