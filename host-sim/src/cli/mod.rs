//! The command line.

pub mod arguments;
pub mod commands;
mod compare;
pub mod paper;
