//! Who plans in a campaign: in the standard fields, or with `--fronts` along fronts.

use anyhow::{Result, bail};
use clap::ValueEnum;
use clap::builder::PossibleValue;

use crate::campaign::fronts::who::Who;
use crate::mission::algorithm::Algorithm;

/// Who plans in a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CampaignPlanner {
    /// In the standard fields.
    Line(Algorithm),
    /// Along fronts.
    Front(Who),
}

impl From<Algorithm> for CampaignPlanner {
    fn from(algorithm: Algorithm) -> Self {
        Self::Line(algorithm)
    }
}

impl ValueEnum for CampaignPlanner {
    fn value_variants<'a>() -> &'a [Self] {
        &[
            Self::Line(Algorithm::Cfc),
            Self::Line(Algorithm::Scc),
            Self::Line(Algorithm::Lookahead),
            Self::Line(Algorithm::Chords),
            Self::Line(Algorithm::Margin),
            Self::Line(Algorithm::Random),
            Self::Line(Algorithm::Lawnmower),
            Self::Front(Who::Track),
            Self::Front(Who::Zigzag),
            Self::Front(Who::BangBang),
        ]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Self::Line(algorithm) => algorithm.to_possible_value(),
            Self::Front(who) => who.to_possible_value(),
        }
    }
}

/// The planners as those of the standard fields.
///
/// # Errors
/// Names the one that follows fronts, and the `flag` that has it.
pub(crate) fn of_lines(flag: &str, planners: &[CampaignPlanner]) -> Result<Vec<Algorithm>> {
    let of_line = |planner: &CampaignPlanner| match planner {
        CampaignPlanner::Line(algorithm) => Ok(*algorithm),
        CampaignPlanner::Front(who) => {
            bail!("{flag}: found {}, expected it with --fronts, as it follows fronts", who.name())
        }
    };
    planners.iter().map(of_line).collect()
}

/// The planners as those that follow fronts.
///
/// # Errors
/// Names the one that does not, and the `flag` that has it.
pub(crate) fn of_fronts(flag: &str, planners: &[CampaignPlanner]) -> Result<Vec<Who>> {
    let of_front = |planner: &CampaignPlanner| match planner {
        CampaignPlanner::Front(who) => Ok(*who),
        CampaignPlanner::Line(algorithm) => bail!(
            "{flag}: found {} with --fronts, expected track, zigzag or bang-bang, which follow fronts",
            algorithm.name()
        ),
    };
    planners.iter().map(of_front).collect()
}
