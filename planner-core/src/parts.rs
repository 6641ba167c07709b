//! What signatures name and programs seldom do: parts of beliefs, of searches and of snapshots, and how much a
//! plan does at most.
//!
//! A program that is generic over beliefs, or that keeps such a part in a structure of its own, finds its type here.

pub use crate::belief::cells::Constraint;
pub use crate::belief::cells::{Cut, CutError, DualCell};
pub use crate::belief::doubtful_labels::Hypothesis;
pub use crate::belief::doubtful_labels::{Credible, MostLikely};
pub use crate::belief::field::FieldMemory;
pub use crate::belief::goal::Bounds;
pub use crate::belief::predictions::{AuditLabel, Decisive, Odds, Verdict, Verdicts};
pub use crate::belief::predictions::{Covariance, Spread, Stretch};
pub use crate::belief::predictions::{DualPolygon, PolygonSpread};
pub use crate::belief::predictions::{Prediction, Predictor};
pub use crate::belief::predictions::{TablePredictor, TablePredictorAfter, TableSpread};
pub use crate::belief::trust::{Count, Mean, Tallies, Tally};
pub use crate::belief::weight::LogWeight;
pub use crate::geometry::heading::SinCos;
pub use crate::geometry::line::Bound;
pub use crate::geometry::mark::Mark;
pub use crate::planner::cfc::Phase;
pub use crate::planner::decision::Decision;
pub use crate::planner::far::Journey;
pub use crate::planner::lap::Lap;
pub use crate::planner::lookahead::EVALUATIONS;
pub use crate::planner::quest::QuestMemory;
pub use crate::planner::scout::LOOKED_AT;
pub use crate::planner::seek::SeekMemory;
pub use crate::planner::silence::Silence;
pub use crate::planner::track::TrackMemory;
pub use crate::search::direction_rule::{ArcRule, DirectionRule};
pub use crate::search::lookout::Lookout;
pub use crate::search::objective::{Choice, LOOKS};
pub use crate::search::problem::{Problem, Solution};
pub use crate::search::route::Route;
