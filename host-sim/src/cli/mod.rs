//! The command line.

pub mod arguments;
mod campaign;
mod campaign_flags;
mod campaign_record;
mod completions;
mod figure;
mod format;
mod help;
mod hil;
mod init;
mod merge;
pub mod paper;
mod passage;
mod reference;
mod replay;
mod run;
mod told;
