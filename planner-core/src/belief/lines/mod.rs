//! Straight lines in a square, where labels may be wrong: a distribution over them, in fixed memory.
//!
//! A version space holds every line that agrees with every label. That needs true labels of both kinds. [`Lines`] needs
//! neither. It is a grid of masses over directions and offsets (`grid.rs`).
//!
//! - **Labels** multiply the masses on either side by `p` and `1 - p`. A cell is cut by a ramp as wide as the cell is
//!   seen from the label, and by the error of positions. `p` is 0.98 at most, so that one false label does not rule
//!   out the truth.
//! - **No line at all**: two masses, everywhere +1 and everywhere -1.
//! - **A reliability that nobody knows**: two counters (`learnt.rs`).
//! - **Evidence**: each label is compared with its own prediction, see [`evidence`](crate::belief::evidence).
//!
//! All is in single precision, by `+ - * /` in a fixed order and the functions of `geometry/approximate.rs`. So it has the
//! same bytes on every machine. Labels cannot be replayed: a snapshot stores the masses.

mod grid;
mod known;
mod memory;

pub use known::Lines;
pub use memory::LinesMemory;
