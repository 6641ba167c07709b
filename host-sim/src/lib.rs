//! Simulated worlds for `planner-core`: missions, campaigns over the standard fields, traces and
//! figures. The command line is in [`cli`].

#![forbid(unsafe_code)]

pub mod campaign;
pub mod cli;
#[cfg(feature = "mavlink")]
pub mod fly;
pub mod hil;
pub mod mission;
pub mod output;
pub mod reference;
pub mod replay;
pub mod report;
pub mod size;
pub mod world;
