//! The names of choices in scenario files and flags.

use planner_core::motion::unicycle::Grid;
use planner_core::{Crossing, Following, Policy, Prior};
use serde::{Deserialize, Serialize};

/// How finely the unicycle turns, by name.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum FanName {
    /// Rays 10 mrad apart
    Paper,
    /// Rays 1 urad apart
    Fine,
}

impl From<FanName> for Grid {
    fn from(name: FanName) -> Self {
        match name {
            FanName::Paper => Self::Paper,
            FanName::Fine => Self::Fine,
        }
    }
}

/// How P1 looks for the opposite label, by name.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum CrossingName {
    /// In any direction in which the boundary cannot run: P1 as printed
    #[default]
    Anyhow,
    /// Along the direction from the first oracle point to the second
    AlongOracle,
    /// At right angles to the bisector of the slope arc
    AcrossBisector,
}

impl From<CrossingName> for Crossing {
    fn from(name: CrossingName) -> Self {
        match name {
            CrossingName::Anyhow => Self::Unrestricted,
            CrossingName::AlongOracle => Self::AlongOracle,
            CrossingName::AcrossBisector => Self::AcrossBisector,
        }
    }
}

/// How P2 follows the boundary, by name.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum FollowingName {
    /// In any direction in which the boundary can run: P2 as printed
    Anyhow,
    /// Along the bisector of the slope arc
    AlongBisector,
}

impl From<FollowingName> for Following {
    fn from(name: FollowingName) -> Self {
        match name {
            FollowingName::Anyhow => Self::Unrestricted,
            FollowingName::AlongBisector => Self::AlongBisector,
        }
    }
}

/// How hypotheses choose an action together, by name.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum PolicyName {
    /// P3 and P4 over all hypotheses at once
    Joint,
    /// A vote, each held to the starting regions of certainty
    MixtureOfStart,
    /// A vote, each held to its own regions of certainty
    #[default]
    MixtureOfOwn,
}

impl From<PolicyName> for Policy {
    fn from(name: PolicyName) -> Self {
        match name {
            PolicyName::Joint => Self::Joint,
            PolicyName::MixtureOfStart => Self::MixtureOfStart,
            PolicyName::MixtureOfOwn => Self::MixtureOfOwn,
        }
    }
}

/// How hypotheses are weighed beforehand, by name.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum PriorName {
    /// By the measure of their lines
    #[default]
    Area,
    /// All alike, as the paper has it
    Sequences,
}

impl From<PriorName> for Prior {
    fn from(name: PriorName) -> Self {
        match name {
            PriorName::Area => Self::Area,
            PriorName::Sequences => Self::Sequences,
        }
    }
}
