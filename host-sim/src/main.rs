//! `host-sim`: the simulator's command line.

use std::env;
use std::ffi::OsString;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

use anyhow::{Context as _, Result};
use clap::Parser as _;
use host_sim::cli::arguments::Cli;
use host_sim::cli::done::REFUSED;
use host_sim::output::{interruption, notes, plain};

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(answer) => return tell_answer(&answer),
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

/// Prints help or a version, or what is wrong with the arguments.
fn tell_answer(answer: &clap::Error) -> ExitCode {
    // With its styles, clap would print what was given as it is.
    let is_tame = |it: OsString| it.to_str().is_some_and(|it| plain::message(it) == it);
    let told = if !answer.use_stderr() || env::args_os().all(is_tame) {
        print(|_| answer.print())
    } else {
        let words = plain::message(&answer.render().to_string());
        print(|_| write!(io::stderr(), "{words}"))
    };
    if answer.use_stderr() {
        // If standard error is closed, the exit status alone must report the failure.
        return ExitCode::from(REFUSED);
    }
    told.map_or_else(|error| fail(&error), |()| ExitCode::SUCCESS)
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
