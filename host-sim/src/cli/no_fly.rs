//! `fly` where it is not built in.

use anyhow::{Result, bail};
use clap::Args;

use crate::cli::done::Done;

const HELP: &str = "\
Examples:
  host-sim fly mission.toml --mavlink udp:127.0.0.1:14550 --label WET

This host-sim is built without MAVLink. To have it:
  cargo build --release -p host-sim --features mavlink";

#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub(crate) struct FlyArgs {
    /// Whatever it would take
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _all: Vec<String>,
}

/// Says how to have it.
pub(crate) fn fly(_: &FlyArgs) -> Result<Done> {
    bail!(
        "fly: found a host-sim that is built without MAVLink, expected one built with: \
         cargo build --release -p host-sim --features mavlink"
    )
}
