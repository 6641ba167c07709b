//! Simulated worlds for `planner-core`: missions, campaigns over the standard fields, traces and
//! figures. The command line is in [`cli`].

#![forbid(unsafe_code)]

pub mod cable;
pub mod campaign;
pub mod cli;
pub mod commands;
pub mod emulator;
mod facing;
pub mod faults;
pub mod field;
pub mod figure;
pub mod hil;
mod hull;
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
mod sample_file;
pub mod scenario;
mod separation;
mod shortest_pairs;
mod strict;
pub mod trace;
pub mod world;
