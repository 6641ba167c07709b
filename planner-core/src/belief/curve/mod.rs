//! What is known of a front beside a robot that goes along it, told nothing of how the front bends.
//!
//! - **Along an arc.** An arc goes with the robot. Against it the front has an offset, a turn and a curvature, and offsets at
//!   the last places that the robot has passed. Labels ahead narrow these too, for some reaches.
//! - **A sum of Gaussians** (`bank.rs`), three for each of five gaits: straight on, gentle and tight bends, corners. The
//!   mass passes from gait to gait on the way, so nobody has to know a radius. A steady motion shows as a turn.
//! - **A label asks the offset alone** (`gaussian.rs`). All else is stored as slopes on the offset, and what these leave
//!   open. So a label subtracts no covariances, and none becomes indefinite.
//! - **Widths** are quantiles of the sum, not multiples of its deviation.
//! - **At the start** (`start.rs`) the front lies between two samples that differ, in any direction that the others leave.
//!
//! Lengths are in *reaches*, the longest motion of the robot. All is in single precision, by `+ - * /` in a fixed order and
//! the functions of libm and `geometry/approximate.rs`: the same on every machine.

mod arc;
mod bank;
mod follower;
mod gaussian;
mod memory;
mod mixture;
mod normal;
mod readout;
mod start;

pub use follower::{Curve, MapPlace};
pub use memory::CurveMemory;
pub(crate) use start::nearest_pair;
