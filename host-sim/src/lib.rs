//! Simulated worlds for `planner-core`: missions, campaigns over the standard fields, traces and
//! figures. The command line is in [`cli`].

#![forbid(unsafe_code)]

pub mod cable;
pub mod campaign;
pub mod cli;
pub mod commands;
pub mod emulator;
pub mod faults;
pub mod field;
pub mod figure;
pub mod hil;
pub mod interruption;
mod legend;
pub mod mission;
pub mod names;
pub mod noisy_campaign;
pub mod output;
mod place;
pub mod player;
pub mod polygon;
pub mod random_walk;
pub mod recording;
pub mod replay;
pub mod report;
pub mod scenario;
pub mod trace;
pub mod world;
