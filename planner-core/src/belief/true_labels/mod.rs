//! What is known where labels are true: the one cell that they leave.

mod given;
mod room;
mod version_space;

pub use given::GivenError;
pub use version_space::VersionSpace;
