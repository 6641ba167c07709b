#![no_std]
#![forbid(unsafe_code)]
//! draft
pub mod action;
pub mod agent;
pub mod cell;
pub mod cfc;
pub mod direction;
pub mod dynamics;
pub mod estimate;
pub mod hal;
pub mod lattice;
pub mod line;
pub mod planner;
pub mod problem;
mod recovery;
pub mod sample;
pub mod version_space;
