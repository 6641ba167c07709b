//! The command line.

pub mod arguments;
mod campaign;
mod compare;
mod completions;
mod figure;
mod help;
mod hil;
mod init;
pub mod paper;
mod replay;
mod run;
