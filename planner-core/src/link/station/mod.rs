//! The chip's side of a mission: a mission comes over a link, is planned here, and is driven elsewhere.

mod flight;
mod planners;
mod seam;
mod terms;

pub use flight::{Flown, Station, Watch};
pub use planners::{AllLabels, CfcAlone, Mission, Planners, TrueLabels};
pub use seam::{Prepared, Restart};
pub use terms::{FromOutlines, Known, NoTerms, PlannerSetup};
