//! Simulated worlds for `planner-core`: missions, campaigns over the standard fields, traces and
//! figures. The command line is in [`cli`].

#![forbid(unsafe_code)]

pub use host_missions::{campaign, fitting, mission, output, reference, world};

pub mod cli;
#[cfg(feature = "mavlink")]
pub mod fly;
pub mod hil;
pub mod replay;
pub mod report;
pub mod size;
