//! The command line in the test's own process.

use clap::Parser as _;
use host_sim::cli::arguments::Cli;
use serde_json::Value;

/// What a command prints.
///
/// # Panics
/// When it is refused.
pub fn told(line: &str) -> String {
    let cli = Cli::try_parse_from(line.split_whitespace()).expect(line);
    cli.execute().expect(line).text
}

/// What it prints for programs.
///
/// # Panics
/// When it is refused, or prints no JSON.
pub fn record(line: &str) -> Value {
    serde_json::from_str(&told(&format!("{line} --format json"))).expect(line)
}
