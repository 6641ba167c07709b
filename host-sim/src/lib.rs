//! Simulated worlds for `planner-core`: missions, campaigns over the standard fields, traces and
//! figures. The command line is in [`cli`].
//!
//! A browser has no files, lines or vehicles: of this crate it has the reports.

#![forbid(unsafe_code)]
#![cfg_attr(target_family = "wasm", allow(dead_code, reason = "commands use it"))]

pub use host_missions::{campaign, fitting, mission, output, reference, world};

#[cfg(not(target_family = "wasm"))]
pub mod cli;
#[cfg(feature = "mavlink")]
pub mod fly;
#[cfg(not(target_family = "wasm"))]
pub mod hil;
#[cfg(not(target_family = "wasm"))]
pub mod replay;
pub mod report;
#[cfg(not(target_family = "wasm"))]
pub mod size;
