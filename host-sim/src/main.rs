//! `host-sim`: the simulator's command line.

use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

use anyhow::{Context as _, Result};
use host_sim::cli::arguments::Cli;
use host_sim::cli::done::REFUSED;
use host_sim::cli::wrong_flag;
use host_sim::output::{interruption, notes};

fn main() -> ExitCode {
    let cli = match Cli::read() {
        Ok(cli) => cli,
        Err(answer) if answer.use_stderr() => return fail(&wrong_flag::in_one_line(&answer)),
        // Help, or a version.
        Err(answer) => match print(|_| answer.print()) {
            Ok(()) => return ExitCode::SUCCESS,
            Err(error) => return fail(&error),
        },
    };
    let done = interruption::watch()
        .context("signals cannot be watched")
        .and_then(|()| cli.execute())
        .and_then(|done| print(|stdout| write!(stdout, "{}", done.text)).map(|()| done.failure));
    match done {
        Ok(None) => ExitCode::SUCCESS,
        Ok(Some((why, status))) => {
            notes::error(&why);
            ExitCode::from(status)
        }
        Err(error) => fail(&error),
    }
}

/// Prints to standard output. A reader of a pipe may stop early.
fn print(write: impl FnOnce(&mut io::Stdout) -> io::Result<()>) -> Result<()> {
    let mut stdout = io::stdout();
    match write(&mut stdout).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("standard output: expected to be written")
        }
        _ => Ok(()),
    }
}

fn fail(error: &anyhow::Error) -> ExitCode {
    notes::error(error);
    ExitCode::from(REFUSED)
}
