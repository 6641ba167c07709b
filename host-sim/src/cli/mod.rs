//! The command line.

pub mod arguments;
mod campaign;
mod campaign_flags;
mod campaign_planner;
mod completions;
pub mod done;
mod figure;
#[cfg(feature = "mavlink")]
mod fly;
#[cfg(not(feature = "mavlink"))]
#[path = "no_fly.rs"]
mod fly;
mod format;
mod fronts;
mod help;
mod hil;
mod init;
mod join;
mod next;
pub mod paper;
mod patches;
mod reference;
mod replay;
mod run;
mod size;
mod told;
pub mod wrong_flag;
