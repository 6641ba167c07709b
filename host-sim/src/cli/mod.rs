//! The command line.

pub mod arguments;
mod campaign;
mod compare;
mod hil;
pub mod paper;
mod reference;
mod replay;
mod run;
