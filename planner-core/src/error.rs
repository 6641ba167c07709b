//! What can go wrong. Each error says what was refused and what is expected instead.

pub use crate::belief::ObservationError;
pub use crate::belief::observation_log::ReplayError;
pub use crate::belief::true_labels::GivenError;
pub use crate::geometry::chart::ChartError;
pub use crate::geometry::hull::HullError;
pub use crate::geometry::lattice::LatticeError;
pub use crate::geometry::polygon_area::PolygonAreaError;
pub use crate::geometry::value::ValueError;
pub use crate::motion::action::GridError;
pub use crate::motion::any_vehicle::ShapeError;
pub use crate::motion::contract::ContractError;
pub use crate::motion::dynamics::RoomError;
pub use crate::planner::setup::SetupError;
pub use crate::planner::snapshot::RestoreError;
pub use crate::robot::{AgentError, VehicleError, WheelsError};
