//! The command line.

pub mod arguments;
mod campaign;
mod compare;
mod figure;
mod hil;
pub mod paper;
mod replay;
mod run;
