//! The chip's side of a mission: a mission comes over a link, is planned here, and is driven elsewhere.

mod flight;
mod planners;
mod seam;
mod terms;

pub use flight::{Flown, Station, Watch};
pub use planners::{AllLabels, CfcAlone, Guards, Mission, NoOthers, Planners, Tracks, TrueLabels};
pub use seam::Prepared;
#[cfg(feature = "charts")]
pub use terms::Charts;
pub use terms::{FromOutlines, KnownDynamics, NoTerms, PlannerSetup};

pub use crate::planner::setup::Restart;
