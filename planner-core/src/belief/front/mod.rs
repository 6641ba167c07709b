//! A front that bends and moves: a distribution over curves, in fixed memory.
//!
//! A version space holds every line that agrees with every label. That is exact, and it ends where the boundary bends
//! or moves: then no line agrees. A [`Tracker`] forgets. It is a grid of masses over directions, offsets and
//! curvatures about a pivot, a place that goes with the robot.
//!
//! - **Labels** multiply the masses on either side by `p` and `1 - p`. A cell is cut by a ramp as wide as the cell is
//!   seen from the label, and by the error of positions. `p` is 0.98 at most, so that one false label does not rule
//!   out the truth.
//! - **Laid by quantiles** (`laying.rs`). The grid spans the mass but for a thousandth on either side. It is laid
//!   anew once a motion. What lies beyond stays in the edge cells. So the cells shrink with what is known, from metres
//!   to millimetres.
//! - **Layers of curvature**: to the right, straight, to the left. In a unit of time a part of each passes to each
//!   neighbour, where the robot is. That is how a front bends: a curve that was known behind the robot is less so
//!   ahead. A layer stands for the curvatures near its own, so its curves also spread on the way (`drift.rs`).
//! - **Drift**: offsets diffuse by the front's speed, and directions by a radian for each 30 m.
//! - **No front at all**: two masses, everywhere +1 and everywhere -1.
//! - **A reliability that nobody knows**: two counters (`learnt.rs`).
//! - **Evidence**: each label is compared with its own prediction, see [`evidence`](crate::belief::evidence).
//!
//! All is in single precision, by `+ - * /` in a fixed order and the functions of `geometry/approximate.rs`. Distances
//! from the pivot are exact integers before they are rounded. So a tracker has the same bytes on every machine. Labels
//! cannot be replayed: a snapshot stores the masses.
//!
//! The tracker does not replace the exact beliefs. Of up to some 30 true labels of a straight line it loses up to a
//! fifth of the bits.

mod drift;
mod grid;
mod lay;
mod laying;
mod learnt;
mod memory;
mod mixing;
mod moments;
mod prior;
mod ramp;
mod settings;
mod stretch;
mod tracker;
mod waist;
mod walk;

pub(crate) use lay::{Unit, angle, limited, metres};
pub(crate) use learnt::Learnt;
pub use memory::FrontMemory;
pub use settings::{Front, FrontStretch};
pub use stretch::Beside;
pub(crate) use stretch::{ASKED, Spread};
pub use tracker::Tracker;
pub(crate) use waist::NINETY;
pub use waist::Waist;
