//! The command line.

pub mod arguments;
mod campaign;
mod campaign_flags;
mod campaign_record;
mod hil;
mod merge;
pub mod paper;
mod passage;
mod replay;
mod run;
mod told;
