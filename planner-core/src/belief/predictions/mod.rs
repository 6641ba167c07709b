//! How much the next labels are expected to tell. A version space predicts by itself, as a polygon of lines. A
//! [`NoisyBelief`] is a table of cells with columns, an approximate copy of its distribution.

mod column;
mod columns;
mod directions;
mod dual_polygon;
mod noisy_belief;
mod on_the_way;
mod predictor;
mod spread;
mod verdicts;

pub use dual_polygon::{DualPolygon, PolygonSpread};
pub(crate) use noisy_belief::information;
pub use noisy_belief::{
    NoisyBelief, TablePredictor, TablePredictorAfter, TableSpread, sequences_of,
};
pub(crate) use on_the_way::OnTheWay;
pub(crate) use predictor::entropy;
pub use predictor::{Prediction, PredictiveBelief, Predictor};
pub use spread::{Covariance, Spread, Stretch};
pub(crate) use verdicts::PLACES;
pub use verdicts::{AuditLabel, Decisive, Odds, Verdict, Verdicts};
