//! `host-sim`: the simulator's command line.

use std::io::{ErrorKind, Write as _};
use std::process::ExitCode;

use clap::Parser as _;
use host_sim::cli::Cli;

fn main() -> ExitCode {
    let done = Cli::parse().execute().and_then(|text| {
        match std::io::stdout().lock().write_all(text.as_bytes()) {
            // Whoever reads may stop early.
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
            _ => Ok(()),
        }
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}
